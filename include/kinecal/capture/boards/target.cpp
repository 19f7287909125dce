// Definitions of target.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/capture/boards/target.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "kinecal/capture/boards/board_fit.hpp"
#include "kinecal/capture/boards/board_grid.hpp"
#include "kinecal/capture/boards/corner_depth.hpp"
#include "kinecal/capture/boards/target_pose.hpp"
#include "kinecal/capture/finders/view_checks.hpp"

namespace kinecal {

namespace detail {

inline constexpr double kFarthestDepth = 12.0;  // from a corner, pixels: 600 points are enough

std::string pixels_text(int width, int height) {
  return std::to_string(width) + " x " + std::to_string(height);
}

namespace {

/// Marks of corners with what their fit says.
[[nodiscard]] std::vector<Mark> fitted_marks(const std::vector<TargetCorner>& corners,
                                             const BoardFit& fit) {
  std::vector<Mark> marks = kinecal::marks_of(corners);
  for (std::size_t i = 0; i < fit.off.size(); ++i) {
    marks[i].off = fit.off[i];
    marks[i].dropped = fit.off[i] > fit.limit;
  }
  return marks;
}

/// The observations of a target's pose.
[[nodiscard]] Found observed_pose(const View& view, const TargetSettings& settings,
                                  const std::vector<TargetCorner>& corners,
                                  std::vector<Mark> marks) {
  const TargetPose pose = target_pose(corners, *view.camera);
  if (!pose.camera_T_target) return refused(pose.fault, std::move(marks));
  Observation camera{settings.camera_sensor, {}, view.camera}, chain{settings.chain_sensor, {}, {}};
  camera.features.push_back(
      {view.frame, pose.camera_T_target->translation, pose.camera_T_target->rotation, {}, {}});
  chain.features.push_back(
      {settings.frame, Vector3<double>::Zero(), Matrix3<double>::Identity(), {}, {}});
  return {{std::move(camera), std::move(chain)}, "", std::move(marks), {}, {}};
}

/// The observations of a target's corners.
[[nodiscard]] Found observed_corners(const View& view, const TargetSettings& settings,
                                     const std::vector<TargetCorner>& corners,
                                     std::vector<Mark> marks) {
  Observation camera{settings.camera_sensor, {}, view.camera}, chain{settings.chain_sensor, {}, {}};
  for (const TargetCorner& c : corners) {
    std::optional<Vector3<double>> seen = Vector3<double>(c.pixel.x(), c.pixel.y(), 0.0);
    if (settings.corners == CornerKind::points) {
      seen = point_at(view.points, c.pixel, std::min(c.reach, kFarthestDepth));
    }
    if (!seen) continue;
    camera.features.push_back({view.frame, *seen, {}, {}, c.id});
    chain.features.push_back({settings.frame, c.target, {}, {}, c.id});
  }
  const std::size_t missing = corners.size() - camera.features.size();
  if (static_cast<double>(missing) >
          settings.max_without_depth * static_cast<double>(corners.size()) ||
      camera.features.empty()) {
    return refused("depth is missing at " + std::to_string(missing) + " of " +
                       std::to_string(corners.size()) + " corners",
                   std::move(marks));
  }
  return {{std::move(camera), std::move(chain)}, "", std::move(marks), {}, {}};
}

}  // namespace

}  // namespace detail

std::string view_fault(const View& view, CornerKind corners) {
  const GrayImage& image = view.image;
  if (std::string problem = image_problem(view); !problem.empty()) return problem;
  const std::string size = detail::pixels_text(image.width, image.height);
  if (!view.camera) return "the view has no camera_info";
  const CameraInfo& camera = *view.camera;
  if (camera.width != image.width || camera.height != image.height) {
    return "camera_info is of " + detail::pixels_text(camera.width, camera.height) +
           " pixels, the image has " + size;
  }
  if (corners != CornerKind::points) return "";
  if (view.points.empty()) return "the view has no cloud, and 3-D corners are wanted";
  if (view.points.width != image.width || view.points.height != image.height) {
    return "the cloud has " + detail::pixels_text(view.points.width, view.points.height) +
           " points, the image " + size + " pixels: each pixel needs its point";
  }
  return "";
}

std::vector<Mark> marks_of(const std::vector<TargetCorner>& corners) {
  std::vector<Mark> marks;
  for (const TargetCorner& c : corners) {
    marks.push_back({c.pixel.x(), c.pixel.y(), std::to_string(c.id)});
  }
  return marks;
}

Found observed(const View& view, const TargetSettings& settings,
               std::vector<TargetCorner> corners) {
  std::sort(corners.begin(), corners.end(),
            [](const TargetCorner& a, const TargetCorner& b) { return a.id < b.id; });
  const BoardFit fit = view.camera ? fit_board(corners, *view.camera) : BoardFit();
  std::vector<Mark> marks = detail::fitted_marks(corners, fit);
  std::vector<GridLine> grid = board_grid(corners, fit);
  const std::string fault = board_fault(fit);
  if (!fault.empty()) return refused(fault, std::move(marks));
  drop_wrong_corners(fit, corners);
  for (std::size_t i = 1; i < corners.size(); ++i) {
    if (corners[i - 1].id != corners[i].id) continue;
    throw std::invalid_argument("two corners have id " + std::to_string(corners[i].id));
  }
  const bool has_dropped = corners.size() < marks.size();
  const auto observe =
      settings.corners == CornerKind::pose ? detail::observed_pose : detail::observed_corners;
  Found found = observe(view, settings, corners, std::move(marks));
  if (!found) return found;
  found.grid = std::move(grid);
  if (has_dropped) found.notes.emplace_back(kWrongCornersNote);
  return found;
}

void check_target(const TargetSettings& settings) {
  if (settings.camera_sensor.empty() || settings.chain_sensor.empty() || settings.frame.empty()) {
    throw std::invalid_argument("a target needs names of its camera's sensor, of the sensor that " +
                                std::string("holds it, and of its frame"));
  }
  if (settings.camera_sensor == settings.chain_sensor) {
    throw std::invalid_argument("sensor '" + settings.camera_sensor +
                                "' cannot both see a target and hold it");
  }
  const TargetQuality& q = settings.quality;
  if (!(q.min_square > 0.0) || !(q.max_edge_width > 0.0) || !(q.max_glare >= 0.0) ||
      !(q.max_bleed > 0.0)) {
    throw std::invalid_argument("limits of a target's image must be positive");
  }
  if (!(settings.max_without_depth >= 0.0 && settings.max_without_depth <= 1.0)) {
    throw std::invalid_argument("max_without_depth is a share, from 0 to 1");
  }
}

}  // namespace kinecal
