// Definitions of surface_match.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/surface/surface_match.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <stdexcept>
#include <utility>

#include "kinecal/evaluation/parallel.hpp"
#include "kinecal/text/frame_name.hpp"
#include "kinecal/trust/uncertainty/feature_places.hpp"

namespace kinecal {

namespace detail {
namespace {

[[nodiscard]] int sensor_number(const AnyProblem& problem, const std::string& name) {
  const std::vector<MountedSensor>& all = problem.sensors();
  const auto found = std::find_if(all.begin(), all.end(), [&](const MountedSensor& sensor) {
    return sensor.mount().name == name;
  });
  if (found == all.end()) throw std::invalid_argument("no sensor '" + name + "' in the problem");
  return static_cast<int>(found - all.begin());
}

/// The chains to the links of a surface, posed by the parameters.
class PosedLinks {
 public:
  PosedLinks(const RobotSurface& surface, const MountedSensor& robot, ParameterValues values) {
    for (const SurfaceLink& link : surface.links()) {
      const auto& chains = robot.chains();
      const auto chain = std::find_if(chains.begin(), chains.end(), [&](const SampledChain& one) {
        return same_frame(one.chain().tip, link.name);
      });
      if (chain == chains.end()) {
        throw std::invalid_argument("sensor '" + robot.mount().name + "' has no link '" +
                                    link.name + "'");
      }
      chains_.push_back({&*chain, corrections_for(chain->parameters(), values)});
    }
  }
  [[nodiscard]] std::vector<Pose<double>> in(const Sample& sample) const {
    std::vector<Pose<double>> poses;
    for (const auto& [chain, corrections] : chains_) {
      poses.push_back(chain->tip(sample, corrections));
    }
    return poses;
  }

 private:
  std::vector<std::pair<const SampledChain*, Corrections<double>>> chains_;
};

/// The points that are seen, in an order in which neighbours follow each other, so that memory of a tree is read once:
/// by the triangles that were found before, else by cells of space.
[[nodiscard]] std::vector<std::size_t> by_place(const std::vector<PlacedFeature>& points,
                                                const std::vector<SurfaceHit>& before) {
  constexpr double kPlace = 0.03;  // metres
  std::vector<std::pair<std::uint64_t, std::size_t>> keys;
  keys.reserve(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!points[i].seen) continue;
    std::uint64_t key = 0;
    if (before[i].link >= 0) {
      key = (static_cast<std::uint64_t>(before[i].link) << 32) |
            static_cast<std::uint64_t>(before[i].triangle);
    } else {
      for (Eigen::Index k = 0; k < 3; ++k) {
        const double cell = std::clamp(points[i].point[k] / kPlace + 1000.0, 0.0, 65535.0);
        key = (key << 16) | static_cast<std::uint64_t>(cell);
      }
      key |= std::uint64_t{1} << 63;
    }
    keys.emplace_back(key, i);
  }
  std::sort(keys.begin(), keys.end());
  std::vector<std::size_t> order;
  order.reserve(keys.size());
  for (const auto& [key, i] : keys) order.push_back(i);
  return order;
}

}  // namespace
}  // namespace detail

std::vector<Pose<double>> link_poses(const RobotSurface& surface, const SurfacePair& pair,
                                     const AnyProblem& problem, ParameterValues values,
                                     const Sample& sample) {
  const int robot = detail::sensor_number(problem, pair.robot);
  return detail::PosedLinks(surface, problem.sensors()[static_cast<std::size_t>(robot)], values)
      .in(sample);
}

void associate(const RobotSurface& surface, const SurfacePair& pair, const AnyProblem& problem,
               ParameterValues values, std::span<const Sample> samples, double bound, int threads,
               SurfaceHits& hits) {
  const int camera = detail::sensor_number(problem, pair.camera);
  const detail::PosedLinks links(
      surface,
      problem.sensors()[static_cast<std::size_t>(detail::sensor_number(problem, pair.robot))],
      values);
  const FeaturePlaces places(problem, values);
  hits.resize(samples.size());
  const auto match = [&](int s, int) {
    const Sample& sample = samples[static_cast<std::size_t>(s)];
    std::vector<SurfaceHit>& of_sample = hits[static_cast<std::size_t>(s)];
    const Observation* seen = sample.observation(pair.camera);
    if (seen == nullptr || seen->features.empty()) return of_sample.clear();
    const std::vector<Pose<double>> base_T_links = links.in(sample);
    const std::vector<PlacedFeature> points = places.placed(camera, *seen, sample);
    of_sample.resize(points.size());
    const PosedSurface posed(surface, base_T_links);
    SurfaceHit near;  // what was found for the point before: they are neighbours
    for (const std::size_t i : detail::by_place(points, of_sample)) {
      if (of_sample[i].link < 0) of_sample[i] = near;
      of_sample[i] = posed.closest(points[i].point, bound, of_sample[i]);
      if (of_sample[i].link < 0) continue;
      of_sample[i].facing =
          of_sample[i].face.dot((points[i].origin - points[i].point).normalized());
      near = of_sample[i];
    }
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (!points[i].seen) of_sample[i] = {};
    }
  };
  detail::for_each_piece(static_cast<int>(samples.size()), detail::number_of_threads(threads),
                         match);
}

void set_matched(const RobotSurface& surface, const SurfacePair& pair,
                 std::vector<SurfaceFeature> features, Sample& sample) {
  std::vector<Observation>& all = sample.observations;
  std::erase_if(all, [&](const Observation& one) { return one.sensor == pair.robot; });
  const auto seen = std::find_if(all.begin(), all.end(),
                                 [&](const Observation& one) { return one.sensor == pair.camera; });
  if (seen == all.end()) return;
  std::vector<std::size_t> order(features.size());  // by link: chains change seldom
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t one, std::size_t other) {
    return features[one].link < features[other].link;
  });
  Observation of_robot{.sensor = pair.robot, .features = {}};
  of_robot.features.reserve(features.size());
  seen->features.clear();
  for (const std::size_t i : order) {
    SurfaceFeature& feature = features[i];
    feature.on_link.frame = surface.links()[static_cast<std::size_t>(feature.link)].name;
    seen->features.push_back(std::move(feature.seen));
    of_robot.features.push_back(std::move(feature.on_link));
  }
  all.push_back(std::move(of_robot));
}

std::vector<Sample> with_surface(const RobotSurface& surface, const SurfacePair& pair,
                                 std::vector<Sample> samples, const SurfaceHits& hits,
                                 double gate) {
  for (std::size_t s = 0; s < samples.size(); ++s) {
    std::vector<SurfaceFeature> features;
    features.reserve(hits[s].size());
    for (Observation& seen : samples[s].observations) {
      if (seen.sensor != pair.camera) continue;
      for (std::size_t i = 0; i < hits[s].size(); ++i) {
        const SurfaceHit& hit = hits[s][i];
        if (hit.link < 0 || hit.distance > gate) continue;
        Feature on_link{.frame = {}, .point = hit.point, .id = seen.features[i].id};
        on_link.conditions = {
            {"nx", hit.normal.x()}, {"ny", hit.normal.y()}, {"nz", hit.normal.z()}};
        features.push_back({hit.link, std::move(seen.features[i]), std::move(on_link)});
      }
    }
    set_matched(surface, pair, std::move(features), samples[s]);
  }
  return samples;
}

std::vector<Sample> with_fewer_points(std::span<const Sample> samples, const std::string& sensor,
                                      int points) {
  std::vector<Sample> fewer;
  for (const Sample& sample : samples) {
    Sample& some = fewer.emplace_back(sample);
    for (Observation& seen : some.observations) {
      const std::size_t all = seen.features.size(), most = static_cast<std::size_t>(points);
      if (seen.sensor != sensor || all <= most) continue;
      std::vector<Feature> kept;
      for (std::size_t i = 0; i < most; ++i) kept.push_back(seen.features[i * all / most]);
      seen.features = std::move(kept);
    }
  }
  return fewer;
}

}  // namespace kinecal
