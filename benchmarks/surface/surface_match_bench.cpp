// A round of association of 1e5 points with the surface of an arm, and an evaluation of them; one thread.
//
// The arm has seven links of 10 000 triangles each; points lie on it with 3 mm of noise.  Control: the same search on one
// link without a tree's bounds, for a hundredth of the points.
#include <benchmark/benchmark.h>

#include <map>
#include <random>
#include <string>

#include "kinecal/evaluation/any_evaluator.hpp"
#include "kinecal/files/urdf/read_urdf.hpp"
#include "kinecal/surface/surface_match.hpp"
#include "support/shapes.hpp"

namespace kinecal {
namespace {

constexpr int kLinks = 7, kSamples = 10, kPoints = 10000;  // points of a sample

std::string urdf() {
  std::string text = "<robot name=\"arm\"><link name=\"l0\"/>";
  for (int i = 1; i <= kLinks; ++i) {
    const std::string link = "l" + std::to_string(i), before = "l" + std::to_string(i - 1);
    text += "<link name=\"" + link + "\"/><joint name=\"j" + std::to_string(i) +
            "\" type=\"continuous\"><parent link=\"" + before + "\"/><child link=\"" + link +
            "\"/><origin xyz=\"0 0 0.2\"/><axis xyz=\"" + (i % 2 == 0 ? "0 1 0" : "0 0 1") +
            "\"/></joint>";
  }
  return text +
         "<link name=\"camera\"/><joint name=\"mount\" type=\"fixed\"><parent link=\"l0\"/><child "
         "link=\"camera\"/><origin xyz=\"0 0 -3\"/></joint></robot>";
}

/// The arm, its camera, clouds.
struct Scene {
  Scene() {
    const test::Shape shape = test::ball({0.0, 0.0, 0.1}, 0.11, 50, 0.1);
    std::vector<SurfaceLink> links;
    Mount mount{"surface", "l0", "", {}};
    for (int i = 1; i <= kLinks; ++i) {
      const std::string name = "l" + std::to_string(i);
      links.push_back({name, TriangleTree(shape.vertices, shape.triangles)});
      mount.links.push_back(name);
    }
    surface = RobotSurface(std::move(links));
    ParameterTable table;
    for (int i = 1; i <= kLinks; ++i) table.add({.name = "j" + std::to_string(i)});
    for (const auto axis : kFrameAxes) table.add({.name = parameter_name("mount", axis)});
    problem = make_problem(parse_urdf(urdf(), "arm.urdf"), "l0", table, {"mount"});
    problem->add_built_in(DepthCamera{}, {"camera", "camera"});
    problem->add_built_in(ChainPoint{}, mount);
    problem->add_built_in("surface", PointToMesh{}, {"camera", "surface"}, {});
    values = table.values();
    std::mt19937 engine(1);
    std::uniform_real_distribution<double> turn(-1.5, 1.5);
    std::normal_distribution<double> noise(0.0, 0.003);
    const Vector3<double> eye(0.0, 0.0, -3.0);  // below: all points are in front of it
    for (int s = 0; s < kSamples; ++s) {
      Sample& sample = samples.emplace_back();
      for (int i = 1; i <= kLinks; ++i) {
        sample.joint_names.push_back("j" + std::to_string(i));
        sample.joint_positions.push_back(turn(engine));
      }
      const auto poses = link_poses(surface, {"camera", "surface"}, *problem, at(), sample);
      Observation seen{.sensor = "camera", .features = {}, .camera = CameraInfo{}};
      seen.camera->p = {500.0, 0.0, 320.0, 0.0, 0.0, 500.0, 240.0, 0.0, 0.0, 0.0, 1.0, 0.0};
      for (int p = 0; p < kPoints; ++p) {
        const auto link = static_cast<std::size_t>(p % kLinks);
        const auto& corner =
            shape.vertices[static_cast<std::size_t>(engine()) % shape.vertices.size()];
        Vector3<double> point = poses[link] * corner - eye;
        for (double& x : point) x += noise(engine);
        seen.features.push_back({.frame = "camera", .point = point});
      }
      sample.observations.push_back(std::move(seen));
    }
  }
  [[nodiscard]] ParameterValues at() const {
    return {values.data(), static_cast<std::size_t>(values.size())};
  }

  RobotSurface surface;
  std::unique_ptr<AnyProblem> problem;
  Eigen::VectorXd values;
  std::vector<Sample> samples;
  SurfacePair pair{"camera", "surface"};
};

const Scene& scene() {
  static const Scene one;
  return one;
}

void BM_Associate_AllPoints(benchmark::State& state) {
  const Scene& of = scene();
  SurfaceHits hits;
  associate(of.surface, of.pair, *of.problem, of.at(), of.samples, 0.1, 1, hits);
  double sum = 0.0;
  for (const auto& sample : hits) {
    for (const SurfaceHit& hit : sample) sum += hit.distance;
  }
  if (!(sum > 0.0 && sum < 0.003 * kSamples * kPoints)) return state.SkipWithError("far off");
  for (auto unused : state) {
    SurfaceHits fresh;
    associate(of.surface, of.pair, *of.problem, of.at(), of.samples, 0.1, 1, fresh);
    benchmark::DoNotOptimize(fresh.data());
  }
  state.SetItemsProcessed(state.iterations() * kSamples * kPoints);
}
BENCHMARK(BM_Associate_AllPoints)->Unit(benchmark::kMillisecond);

void BM_Associate_Again(benchmark::State& state) {
  const Scene& of = scene();
  SurfaceHits hits;
  associate(of.surface, of.pair, *of.problem, of.at(), of.samples, 0.1, 1, hits);
  for (auto unused : state) {
    associate(of.surface, of.pair, *of.problem, of.at(), of.samples, 0.1, 1, hits);
    benchmark::DoNotOptimize(hits.data());
  }
}
BENCHMARK(BM_Associate_Again)->Unit(benchmark::kMillisecond);

/// Control: all triangles of one link, for one point.
void BM_Associate_WithoutTree(benchmark::State& state) {
  const TriangleTree& tree = scene().surface.links().front().tree;
  const Vector3<double> p(0.15, 0.05, 0.1);
  for (auto unused : state) {
    double least = 1e9;
    for (int t = 0; t < tree.count(); ++t) least = std::min(least, tree.on_triangle(p, t).distance);
    benchmark::DoNotOptimize(least);
  }
}
BENCHMARK(BM_Associate_WithoutTree);

void BM_Evaluate_Associated(benchmark::State& state) {
  const Scene& of = scene();
  SurfaceHits hits;
  associate(of.surface, of.pair, *of.problem, of.at(), of.samples, 0.1, 1, hits);
  const std::unique_ptr<AnyProblem> problem = of.problem->without_samples();
  for (const Sample& sample : with_surface(of.surface, of.pair, of.samples, hits, 0.1)) {
    problem->add_sample(sample);
  }
  const FreeSet free(problem->touched_parameters(), problem->table().size());
  const auto evaluator = problem->evaluator(free, 1);
  if (!(evaluator->normal_equations(of.at()).cost > 0.0)) return state.SkipWithError("no cost");
  for (auto unused : state) {
    const NormalEquations sums = evaluator->normal_equations(of.at());
    benchmark::DoNotOptimize(sums.cost);
  }
}
BENCHMARK(BM_Evaluate_Associated)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace kinecal

BENCHMARK_MAIN();
