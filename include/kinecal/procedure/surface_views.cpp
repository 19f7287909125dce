// Definitions of surface_views.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/procedure/surface_views.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <string>
#include <utility>

#include "kinecal/config/assemble.hpp"
#include "kinecal/evaluation/any_evaluator.hpp"
#include "kinecal/samples/joint_moves.hpp"
#include "kinecal/sensors/lenses/lens.hpp"
#include "kinecal/surface/outline.hpp"
#include "kinecal/surface/surface_match.hpp"
#include "kinecal/text/frame_name.hpp"
#include "kinecal/trust/noise/noise.hpp"

namespace kinecal {

namespace detail {
namespace {

/// Every n-th of a list, so that at most so many are left.
template <class T>
[[nodiscard]] std::vector<T> evenly(const std::vector<T>& all, std::size_t most) {
  if (all.size() <= most) return all;
  std::vector<T> some;
  for (std::size_t i = 0; i < most; ++i) some.push_back(all[i * all.size() / most]);
  return some;
}

/// A surface as one camera sees it.
class SurfaceViewer {
 public:
  SurfaceViewer(const SurfaceBlock& block, const AnyProblem& problem, const SimulatedCamera& camera)
      : block_(block),
        problem_(problem),
        camera_(camera),
        lens_(camera.info, camera.image),
        outliner_(block.is_outline ? block.surface : RobotSurface()) {}

  /// Adds what the camera sees in a pose; returns the number of its features.
  /// @param next  in: number of the next feature; out.  Points of a surface are others in each sample.
  std::size_t add_to(Sample& sample, const Eigen::VectorXd& values, int& next) const {
    const auto& sensors = problem_.sensors();
    const auto camera = std::ranges::find_if(
        sensors, [&](const MountedSensor& one) { return one.mount().name == block_.pair.camera; });
    const SampledChain& chain = camera->chains().front();
    const Pose<double> base_T_camera =
        chain.tip(sample, corrections_for(chain.parameters(), ParameterValues(values)));
    const std::vector<Pose<double>> links =
        link_poses(block_.surface, block_.pair, problem_, values, sample);
    std::vector<SurfaceFeature> features =
        block_.is_outline ? edges(base_T_camera, links) : points(base_T_camera, links);
    for (SurfaceFeature& feature : features) {
      feature.seen.frame = camera->mount().frame;
      feature.seen.id = feature.on_link.id = next++;
    }
    const std::size_t count = features.size();
    sample.observations.push_back({block_.pair.camera, {}, camera_.info});
    set_matched(block_.surface, block_.pair, std::move(features), sample);
    return count;
  }

 private:
  [[nodiscard]] std::vector<SurfaceFeature> points(const Pose<double>& base_T_camera,
                                                   const std::vector<Pose<double>>& links) const {
    constexpr double kRays = 3000.0;  // of which a part hits the robot
    const CameraInfo& info = camera_.info;
    const double step = std::max(1.0, std::sqrt(double(info.width) * info.height / kRays));
    std::vector<SurfaceFeature> all;
    for (double v = 0.5 * step; v < info.height; v += step) {
      for (double u = 0.5 * step; u < info.width; u += step) {
        const Vector3<double> ray = lens_.ray(u, v);
        if (!ray.allFinite()) continue;
        const Vector3<double> way = base_T_camera.rotation * ray;
        const SurfaceHit hit = block_.surface.cast(links, base_T_camera.translation, way);
        if (hit.link < 0) continue;
        const Vector3<double> p = hit.distance * ray;
        const bool is_measured = p.z() > camera_.nearest && p.z() < camera_.farthest &&
                                 std::abs(hit.face.dot(way)) > camera_.grazing * way.norm();
        if (!is_measured) continue;
        SurfaceFeature& feature = all.emplace_back(SurfaceFeature{hit.link, {}, {}});
        feature.seen.point = p;
        feature.on_link.point = hit.point;
        feature.on_link.conditions = {
            {"nx", hit.face.x()}, {"ny", hit.face.y()}, {"nz", hit.face.z()}};
      }
    }
    return evenly(all, kViewPoints);
  }

  [[nodiscard]] std::vector<SurfaceFeature> edges(const Pose<double>& base_T_camera,
                                                  std::vector<Pose<double>> links) const {
    const Pose<double> camera_T_base = base_T_camera.inverse();
    for (Pose<double>& link : links) link = camera_T_base * link;
    const auto pixel_of = [&](const Vector3<double>& p) -> Eigen::Vector2d {
      if (p.z() > 0.0) return lens_.project(p);
      return Eigen::Vector2d::Constant(std::numeric_limits<double>::quiet_NaN());
    };
    std::vector<SurfaceFeature> all;
    for (const OutlinePoint& point :
         outliner_.outline(links, pixel_of, camera_.info.width, camera_.info.height)) {
      SurfaceFeature& feature = all.emplace_back(SurfaceFeature{point.link, {}, {}});
      feature.seen.point = {point.pixel.x(), point.pixel.y(), 0.0};
      feature.seen.conditions = {{"nu", point.normal.x()}, {"nv", point.normal.y()}};
      feature.on_link.point = point.point;
    }
    return evenly(all, kViewPoints);
  }

  const SurfaceBlock& block_;
  const AnyProblem& problem_;
  const SimulatedCamera& camera_;
  Lens lens_;
  Outliner outliner_;
};

/// Errors: a block that compares anything but the surface as the camera sees it.
void check_compares_only(const Config& config, const SimulatedCamera& camera,
                         Diagnostics& diagnostics) {
  const StepConfig& step = config.steps.back();
  for (const BlockConfig& block : step.error_blocks) {
    if (block.type == "outrageous") continue;
    const bool is_seen = std::ranges::any_of(step.models, [&](const ModelConfig& model) {
      return std::ranges::count(block.models, model.name) > 0 && !model.is_surface &&
             same_frame(model.frame, camera.frame);
    });
    if (block.surface && is_seen) continue;
    diagnostics.error(block.place,
                      fmt::format("error block '{}' compares something else than the robot's "
                                  "surface as the camera in '{}' sees it, which is not predicted; "
                                  "give recorded samples: --samples",
                                  block.name, camera.frame));
  }
}

}  // namespace
}  // namespace detail

PoseSamples surface_views(const SurfaceInput& input, const SimulatedCamera& camera, Config& config,
                          std::span<const CapturePose> poses, Diagnostics& diagnostics) {
  PoseSamples views;
  const std::size_t before = diagnostics.errors.size();
  detail::check_compares_only(config, camera, diagnostics);
  if (diagnostics.errors.size() > before) return views;
  const std::vector<SurfaceBlock> blocks = read_surface_blocks(input, config, diagnostics).back();
  if (diagnostics.errors.size() > before) return views;
  Diagnostics quiet;
  const Calibration empty = assemble(config, input.robot, {}, quiet);
  quiet.throw_if_errors();
  const CalibrationStep& step = empty.steps.back();
  Eigen::VectorXd values = empty.table.values();
  for (const CalibrationStep& one : empty.steps) {
    for (const auto& [index, value] : one.assignments) values[index] = value;
  }
  std::vector<detail::SurfaceViewer> viewers;
  viewers.reserve(blocks.size());
  for (const SurfaceBlock& block : blocks) viewers.emplace_back(block, *step.problem, camera);
  constexpr std::size_t kFewest = 30;
  int next = 0;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    Sample sample = sample_in_pose(input.robot, poses[i]);
    std::size_t seen = 0;
    for (const detail::SurfaceViewer& viewer : viewers) {
      seen += viewer.add_to(sample, values, next);
    }
    if (seen < kFewest) {
      views.skipped.push_back(poses[i].source + ": the camera sees nearly nothing of the robot");
      continue;
    }
    views.samples.push_back(std::move(sample));
    views.poses.push_back(i);
  }
  set_joint_moves(views.samples);
  return views;
}

std::vector<Sample> surface_points(const AnyProblem& problem, ParameterValues values,
                                   std::span<const std::string> blocks,
                                   std::span<const Sample> samples) {
  constexpr double kOnSurface = 3.0;  // standard deviations
  std::vector<Sample> kept;
  for (const Sample& sample : samples) kept.push_back(problem.paired(sample).value_or(sample));
  int next = 0;
  for (int t = 0; t < problem.num_terms(); ++t) {
    const Term& term = problem.term(t);
    if (std::ranges::count(blocks, term.name) == 0) continue;
    std::vector<std::pair<std::pair<int, int>, double>> distances;  // by sample and place
    std::vector<double> norms;
    (void)evaluate(problem, values, nullptr, [&](int of, int sample, const TermResiduals& rows) {
      for (Eigen::Index row = 0; of == t && row < rows.residual.size(); row += term.feature_size) {
        const int place = problem.feature(t, sample, row / term.feature_size).place;
        norms.push_back(rows.residual.segment(row, term.feature_size).norm());
        distances.push_back({{sample, place}, norms.back()});
      }
    });
    const double most = kOnSurface * robust_sigma(norms, term.feature_size);
    std::map<int, std::vector<int>> places;  // of features on the surface, by sample
    for (const auto& [of, distance] : distances) {
      if (distance <= most) places[of.first].push_back(of.second);
    }
    for (std::size_t s = 0; s < kept.size(); ++s) {
      std::vector<int>& of_sample = places[static_cast<int>(s)];
      std::ranges::sort(of_sample);
      of_sample = detail::evenly(of_sample, static_cast<std::size_t>(kViewPoints));
      const int first = next;
      for (const int number : term.sensors) {
        const std::string& name = problem.sensors()[static_cast<std::size_t>(number)].mount().name;
        next = first;
        for (Observation& seen : kept[s].observations) {
          if (seen.sensor != name) continue;
          std::vector<Feature> some;
          for (const int place : of_sample) {
            some.push_back(seen.features[static_cast<std::size_t>(place)]);
            some.back().id = next++;  // another point in each sample
          }
          seen.features = std::move(some);
        }
      }
    }
  }
  return kept;
}

}  // namespace kinecal
