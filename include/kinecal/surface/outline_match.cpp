// Definitions of outline_match.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/surface/outline_match.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "kinecal/evaluation/parallel.hpp"

namespace kinecal {

namespace detail {
namespace {

/// Edges of a mask as a camera observed them.
[[nodiscard]] std::vector<MaskEdge> edges_of(const Observation& seen) {
  std::vector<MaskEdge> edges;
  for (const Feature& feature : seen.features) {
    const auto u = feature.conditions.find("nu"), v = feature.conditions.find("nv");
    const bool is_known = u != feature.conditions.end() && v != feature.conditions.end();
    edges.push_back({feature.point.head<2>(), is_known ? Eigen::Vector2d(u->second, v->second)
                                                       : Eigen::Vector2d(Eigen::Vector2d::Zero())});
  }
  return edges;
}

/// The outline point with the direction in which its distance from an edge counts.  Along the outline it has none, but
/// where the outline ends: then the way between the two counts.
[[nodiscard]] OutlineHit hit_of(int edge, const MaskEdge& at, const OutlinePoint& point) {
  constexpr double kAlong = 1.5;  // pixels, more than points of the outline are apart
  const Eigen::Vector2d way = point.pixel - at.pixel;
  OutlineHit hit{edge, point, way.norm()};
  const double across = point.normal.dot(way);
  if (std::sqrt(std::max(0.0, way.squaredNorm() - across * across)) > kAlong) {
    hit.on.normal = way / hit.distance;
  } else {
    hit.distance = std::abs(across);
  }
  return hit;
}

}  // namespace
}  // namespace detail

OutlineHits match_outlines(const Outliner& outliner, const RobotSurface& surface,
                           const SurfacePair& pair, const AnyProblem& problem,
                           ParameterValues values, std::span<const Sample> samples, double bound,
                           int threads) {
  const auto& sensors = problem.sensors();
  const auto camera = std::find_if(sensors.begin(), sensors.end(), [&](const MountedSensor& one) {
    return one.mount().name == pair.camera;
  });
  if (camera == sensors.end()) throw std::invalid_argument("no sensor '" + pair.camera + "'");
  const std::vector<double> own = camera->own_values(values);
  const SampledChain& chain = camera->chains().front();
  const Corrections<double> corrections = corrections_for(chain.parameters(), values);
  OutlineHits hits(samples.size());
  const auto match = [&](int s, int) {
    const Sample& sample = samples[static_cast<std::size_t>(s)];
    OutlineMatch& of_sample = hits[static_cast<std::size_t>(s)];
    const Observation* seen = sample.observation(pair.camera);
    if (seen == nullptr || seen->features.empty() || !seen->camera) return;
    const int width = seen->camera->width, height = seen->camera->height;
    const std::vector<double> settings = camera->sensor().settings(*seen);
    const Pose<double> camera_T_base = chain.tip(sample, corrections).inverse();
    std::vector<Pose<double>> links = link_poses(surface, pair, problem, values, sample);
    for (Pose<double>& link : links) link = camera_T_base * link;
    const std::vector<OutlinePoint> outline = outliner.outline(
        links, [&](const Vector3<double>& p) { return camera->sensor().predict(p, settings, own); },
        width, height);
    const std::vector<MaskEdge> edges = detail::edges_of(*seen);
    const auto agree = [&](std::size_t edge, std::size_t point) {
      return edges[edge].pixel.allFinite() && edges[edge].normal.dot(outline[point].normal) >= 0.0;
    };
    const auto pixels = [](const auto& all) {
      std::vector<Eigen::Vector2d> of_all;
      for (const auto& one : all) {
        of_all.push_back(one.pixel.allFinite() ? one.pixel
                                               : Eigen::Vector2d(Eigen::Vector2d::Zero()));
      }
      return of_all;
    };
    const PixelGrid points(pixels(outline), width, height);
    for (std::size_t i = 0; i < edges.size(); ++i) {
      OutlineHit& hit = of_sample.edges.emplace_back();
      if (!edges[i].pixel.allFinite()) continue;
      const int point = points.nearest(
          edges[i].pixel, bound, [&](int k) { return agree(i, static_cast<std::size_t>(k)); });
      if (point < 0) continue;
      hit = detail::hit_of(static_cast<int>(i), edges[i], outline[static_cast<std::size_t>(point)]);
    }
    const PixelGrid grid(pixels(edges), width, height);
    for (std::size_t i = 0; i < outline.size(); ++i) {
      OutlineHit& hit = of_sample.outline.emplace_back();
      hit.on = outline[i];
      const int edge = grid.nearest(outline[i].pixel, bound,
                                    [&](int k) { return agree(static_cast<std::size_t>(k), i); });
      if (edge < 0) continue;
      hit = detail::hit_of(edge, edges[static_cast<std::size_t>(edge)], outline[i]);
    }
  };
  detail::for_each_piece(static_cast<int>(samples.size()), detail::number_of_threads(threads),
                         match);
  return hits;
}

std::vector<Sample> with_outline(const RobotSurface& surface, const SurfacePair& pair,
                                 std::span<const Sample> samples, const OutlineHits& hits,
                                 double gate) {
  std::vector<Sample> matched(samples.begin(), samples.end());
  for (std::size_t s = 0; s < matched.size(); ++s) {
    std::vector<SurfaceFeature> features;
    hits[s].for_each([&](const OutlineHit& hit) {
      if (hit.edge < 0 || hit.distance > gate) return;
      Feature edge =
          samples[s].observation(pair.camera)->features[static_cast<std::size_t>(hit.edge)];
      edge.id.reset();  // some edges occur twice
      edge.conditions["nu"] = hit.on.normal.x();
      edge.conditions["nv"] = hit.on.normal.y();
      features.push_back({hit.on.link, std::move(edge), {.frame = {}, .point = hit.on.point}});
    });
    set_matched(surface, pair, std::move(features), matched[s]);
  }
  return matched;
}

}  // namespace kinecal
