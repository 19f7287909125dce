// Residuals, Jacobians and normal equations of a problem.  Controls: jets through everything, and
// the plain sum of dense Jacobians.  Items per second are samples.
// SPDX-License-Identifier: Apache-2.0
#include <benchmark/benchmark.h>
#include <ceres/jet.h>

#include "kinecal/errors.hpp"
#include "kinecal/solve.hpp"
#include "support/scene.hpp"

namespace kinecal {
namespace {

constexpr int kParameters = 41;
using Wide = ceres::Jet<double, kParameters>;

struct Work {
  Problem problem = test::scene_problem();
  std::vector<Sample> samples;
  FreeSet free{{}, kParameters};
  std::vector<double> values;

  explicit Work(int count) {
    problem.add_block("hand_eye", PointToPoint{}, {"camera", "arm"}, {});
    values = test::random_values(problem.table(), 0.02, 3);
    samples = test::exact_samples(problem, values, count);
    for (const Sample& sample : samples) problem.add_sample(sample);
    std::vector<int> all;
    for (int i = 0; i < problem.table().size(); ++i) all.push_back(i);
    free = FreeSet(all, problem.table().size());
  }
};

double largest_residual(const Work& work) {
  double largest = 0.0;
  (void)kinecal::evaluate(work.problem, work.values, nullptr,
                          [&](int, int, const TermResiduals& out) {
                            largest = std::max(largest, out.residual.cwiseAbs().maxCoeff());
                          });
  return largest;
}

void time_evaluation(benchmark::State& state, bool derivatives) {
  const Work work(static_cast<int>(state.range(0)));
  if (largest_residual(work) > 1e-12) state.SkipWithError("residuals are not zero at the truth");
  for (auto _ : state) {
    double sum = 0.0;
    (void)kinecal::evaluate(work.problem, work.values, derivatives ? &work.free : nullptr,
                            [&](int, int, const TermResiduals& out) {
                              sum += out.residual.sum();
                              benchmark::DoNotOptimize(out.jacobian.data());
                            });
    benchmark::DoNotOptimize(sum);
  }
  state.SetItemsProcessed(state.iterations() * state.range(0));
}

void BM_residuals(benchmark::State& state) {
  time_evaluation(state, false);
}
BENCHMARK(BM_residuals)->Arg(100);

void BM_residuals_and_jacobian(benchmark::State& state) {
  time_evaluation(state, true);
}
BENCHMARK(BM_residuals_and_jacobian)->Arg(100);

/// The pose of a sensor's frame in the base, walked in jets.
Pose<Wide> walked(const MountedSensor& model, const Sample& sample, std::span<const Wide> jets) {
  return forward_kinematics(
      model.chains()[0].chain(), [&](const std::string& joint) { return *sample.position(joint); },
      corrections_for(model.chains()[0].parameters(), jets));
}

/// Camera against arm, all of it in jets.
std::vector<Vector3<Wide>> wide_residuals(const Problem& problem, const Sample& sample,
                                          std::span<const Wide> jets) {
  const MountedSensor &arm = problem.sensors()[0], &camera = problem.sensors()[1];
  const Observation &seen_by_arm = sample.observations[0], &seen = sample.observations[1];
  const Pose<Wide> base_T_arm = walked(arm, sample, jets),
                   base_T_camera = walked(camera, sample, jets);
  Measurement<DepthCamera, double> m{.settings = DepthCamera::settings(seen)};
  std::array<Wide, 6> settings;
  for (std::size_t k = 0; k < 6; ++k) {
    settings[k] = jets[static_cast<std::size_t>(camera.parameters()[k])];
  }
  std::vector<Vector3<Wide>> residuals;
  for (std::size_t i = 0; i < seen.features.size(); ++i) {
    m.point = DepthCamera::measurement(seen.features[i].point, m.settings);
    const Vector3<Wide> p_camera = DepthCamera{}.place(m, settings);
    residuals.push_back(PointToPoint{}(Vector3<Wide>(base_T_camera * p_camera),
                                       Vector3<Wide>(base_T_arm * seen_by_arm.features[i].point)));
  }
  return residuals;
}

/// Largest difference of a derivative by wide jets from the problem's own.
double largest_difference(const Work& work, std::span<const Wide> jets) {
  double largest = 0.0;
  (void)kinecal::evaluate(
      work.problem, work.values, &work.free, [&](int, int sample, const TermResiduals& out) {
        const auto wide =
            wide_residuals(work.problem, work.samples[static_cast<std::size_t>(sample)], jets);
        for (Eigen::Index row = 0; row < out.residual.size(); ++row) {
          const Wide& jet = wide[static_cast<std::size_t>(row / 3)](row % 3);
          const double off = (jet.v.transpose() - out.jacobian.row(row)).cwiseAbs().maxCoeff();
          largest = std::max(largest, off);
        }
      });
  return largest;
}

/// The control: the same residuals, differentiated by one wide jet through the whole walk.
void BM_residuals_and_jacobian_wide_jets(benchmark::State& state) {
  const Work work(static_cast<int>(state.range(0)));
  std::vector<Wide> jets;
  for (int i = 0; i < kParameters; ++i)
    jets.emplace_back(work.values.at(static_cast<std::size_t>(i)), i);
  if (work.free.size() != kParameters || largest_difference(work, jets) > 1e-11) {
    state.SkipWithError("the control differs");
  }
  for (auto _ : state) {
    for (const Sample& sample : work.samples) {
      auto residuals = wide_residuals(work.problem, sample, jets);
      benchmark::DoNotOptimize(residuals.data());
    }
  }
  state.SetItemsProcessed(state.iterations() * state.range(0));
}
BENCHMARK(BM_residuals_and_jacobian_wide_jets)->Arg(100);

void BM_normal_equations(benchmark::State& state) {
  const Work work(static_cast<int>(state.range(0)));
  Eigen::MatrixXd hessian = Eigen::MatrixXd::Zero(kParameters, kParameters);
  (void)kinecal::evaluate(work.problem, work.values, &work.free,
                          [&](int, int, const TermResiduals& out) {
                            hessian += out.jacobian.transpose() * out.jacobian;
                          });
  if (!normal_equations(work.problem, work.values, &work.free).hessian.isApprox(hessian, 1e-12)) {
    state.SkipWithError("the sum differs from that of dense Jacobians");
  }
  for (auto _ : state) {
    NormalEquations sum = normal_equations(work.problem, work.values, &work.free);
    benchmark::DoNotOptimize(sum.hessian.data());
  }
  state.SetItemsProcessed(state.iterations() * state.range(0));
}
BENCHMARK(BM_normal_equations)->Arg(100)->Arg(1000);

}  // namespace
}  // namespace kinecal

BENCHMARK_MAIN();
