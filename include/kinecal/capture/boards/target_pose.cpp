// Definitions of target_pose.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/capture/boards/target_pose.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <exception>
#include <limits>
#include <numbers>

#include "kinecal/capture/boards/homography.hpp"
#include "kinecal/sensors/lenses/lens.hpp"

namespace kinecal {

namespace detail {
namespace {

/// Corners of a target, and the rays at which a camera sees them that is turned to their middle.
struct SeenTarget {
  std::vector<Vector3<double>> points;  ///< (3) metres, in the target
  std::vector<Eigen::Vector2d> rays;    ///< (2) x / z, y / z in the turned camera
  double focal = 1.0;                   ///< pixels

  /// Sum of squares of a pose, pixels^2; infinite if a corner is behind the camera.
  [[nodiscard]] double cost(const Pose<double>& pose) const {
    double sum = 0.0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Vector3<double> p = pose * points[i];
      if (!(p.z() > 0.0)) return std::numeric_limits<double>::infinity();
      sum += (focal * (p.head<2>() / p.z() - rays[i])).squaredNorm();
    }
    return sum;
  }

  /// Normal equations at a pose, for a rotation and a shift in the camera's frame.
  void linearize(const Pose<double>& pose, Eigen::Matrix<double, 6, 6>& sums,
                 Eigen::Matrix<double, 6, 1>& right) const {
    sums.setZero();
    right.setZero();
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Vector3<double> turned = pose.rotation * points[i], p = turned + pose.translation;
      Eigen::Matrix<double, 2, 3> by_point;
      by_point << 1.0, 0.0, -p.x() / p.z(), 0.0, 1.0, -p.y() / p.z();
      by_point *= focal / p.z();
      Matrix3<double> cross;
      cross << 0.0, -turned.z(), turned.y(), turned.z(), 0.0, -turned.x(), -turned.y(), turned.x(),
          0.0;
      Eigen::Matrix<double, 2, 6> rows;
      rows << -by_point * cross, by_point;
      sums += rows.transpose() * rows;
      right -= rows.transpose() * (focal * (p.head<2>() / p.z() - rays[i]));
    }
  }
};

/// A pose and its sum of squares, pixels^2.
struct PoseFit {
  Pose<double> pose;
  double cost = std::numeric_limits<double>::infinity();
};

/// The minimum near a pose.  Source: Levenberg, Marquardt.
[[nodiscard]] PoseFit refined_pose(const SeenTarget& seen, const Pose<double>& start) {
  constexpr int kSteps = 60;
  constexpr double kStill = 1e-14;
  PoseFit fit{start, seen.cost(start)};
  if (!std::isfinite(fit.cost)) return fit;
  double damping = 1e-3;
  Eigen::Matrix<double, 6, 6> sums;
  Eigen::Matrix<double, 6, 1> right;
  seen.linearize(fit.pose, sums, right);
  for (int step = 0; step < kSteps; ++step) {
    Eigen::Matrix<double, 6, 6> damped = sums;
    damped.diagonal() *= 1.0 + damping;
    const Eigen::Matrix<double, 6, 1> by = damped.ldlt().solve(right);
    Pose<double> next;
    next.rotation = exp(Vector3<double>(by.head<3>())) * fit.pose.rotation;
    next.translation = fit.pose.translation + by.tail<3>();
    const double cost = seen.cost(next);
    if (!(cost < fit.cost)) {
      damping *= 10.0;
      if (damping > 1e9) break;
      continue;
    }
    const bool is_still = by.squaredNorm() < kStill;
    fit = {next, cost};
    damping = std::max(1e-9, 0.1 * damping);
    if (is_still) break;
    seen.linearize(fit.pose, sums, right);
  }
  return fit;
}

/// The pose in which a flat target looks much the same: its normal reflected across the line of sight
/// to its middle.
[[nodiscard]] Pose<double> reflected_pose(const SeenTarget& seen, const Pose<double>& pose) {
  Vector3<double> middle = Vector3<double>::Zero();
  for (const Vector3<double>& p : seen.points) {
    middle += p / static_cast<double>(seen.points.size());
  }
  const Vector3<double> at = pose * middle, sight = at.normalized(), normal = pose.rotation.col(2);
  // Half a turn about the line of sight takes the normal there; another about the target's own normal
  // turns its corners back.
  const auto half_turn = [](const Vector3<double>& axis) -> Matrix3<double> {
    return 2.0 * axis * axis.transpose() - Matrix3<double>::Identity();
  };
  Pose<double> other;
  other.rotation = half_turn(sight) * half_turn(normal) * pose.rotation;
  other.translation = at - other.rotation * middle;
  return other;
}

/// The corners of the plane of constant z with most of them.
[[nodiscard]] std::vector<std::size_t> corners_of_a_plane(const SeenTarget& seen) {
  std::vector<std::size_t> most;
  for (const Vector3<double>& first : seen.points) {
    std::vector<std::size_t> beside;
    for (std::size_t i = 0; i < seen.points.size(); ++i) {
      if (std::abs(seen.points[i].z() - first.z()) < 1e-9) beside.push_back(i);
    }
    if (beside.size() > most.size()) most = beside;
  }
  return most;
}

/// A first pose, from a plane of the target.
[[nodiscard]] std::optional<Pose<double>> first_pose(const SeenTarget& seen) {
  const std::vector<std::size_t> chosen = corners_of_a_plane(seen);
  if (chosen.size() < 4) return std::nullopt;
  std::vector<Eigen::Vector2d> plane, rays;
  for (const std::size_t i : chosen) {
    plane.emplace_back(seen.points[i].head<2>());
    rays.push_back(seen.rays[i]);
  }
  std::optional<Pose<double>> pose = plane_pose(plane, rays);
  if (pose) pose->translation -= seen.points[chosen.front()].z() * pose->rotation.col(2);
  return pose;
}

}  // namespace
}  // namespace detail

std::optional<TargetFit> fit_target(std::vector<Vector3<double>> points,
                                    const std::vector<Vector3<double>>& directions, double focal) {
  detail::SeenTarget seen{std::move(points), {}, focal};
  const Matrix3<double> turn = turn_to_axis(directions);
  for (const Vector3<double>& direction : directions) {
    const Vector3<double> turned = turn * direction;
    if (!(turned.z() > 0.0)) return std::nullopt;
    seen.rays.emplace_back(turned.hnormalized());
  }
  const auto start = detail::first_pose(seen);
  if (!start) return std::nullopt;
  detail::PoseFit best = detail::refined_pose(seen, *start),
                  other = detail::refined_pose(seen, detail::reflected_pose(seen, best.pose));
  if (other.cost < best.cost) std::swap(best, other);
  if (!std::isfinite(best.cost)) return std::nullopt;
  const Pose<double> camera_T_turned{turn.transpose(), Vector3<double>::Zero()};
  return TargetFit{camera_T_turned * best.pose, best.cost, camera_T_turned * other.pose,
                   other.cost};
}

TargetPose target_pose(const std::vector<TargetCorner>& corners, const CameraInfo& camera) {
  std::vector<Vector3<double>> points, directions;
  double focal = 1.0;
  try {
    const Lens lens(camera);
    focal = lens.focal_length();
    for (const TargetCorner& corner : corners) {
      points.push_back(corner.target);
      directions.push_back(lens.ray(corner.pixel.x(), corner.pixel.y()));
    }
  } catch (const std::exception& error) {
    return {std::nullopt, 0.0, std::string("the pose needs the camera's lens: ") + error.what()};
  }
  if (corners.size() < 4) return {std::nullopt, 0.0, "its corners are too few for a pose"};
  const auto fit = fit_target(std::move(points), directions, focal);
  if (!fit) return {std::nullopt, 0.0, "its corners do not show a pose"};
  const double count = static_cast<double>(corners.size()), rms = std::sqrt(fit->cost / count);
  // The log of the ratio of their probabilities, for corners that are exact to 0.1 pixels.
  constexpr double kCorner = 0.1, kClear = 6.0, kSame = 5.0 * std::numbers::pi / 180.0;
  const double variance = std::max(kCorner * kCorner, 0.5 * fit->cost / count);
  const double apart =
      log(Matrix3<double>(fit->other.rotation * fit->pose.rotation.transpose())).norm();
  if (apart > kSame && fit->other_cost - fit->cost < 2.0 * kClear * variance) {
    return {std::nullopt, rms,
            "its pose is ambiguous: two poses " +
                detail::one_digit(apart * 180.0 / std::numbers::pi) +
                " degrees apart fit alike; tilt it, let it be larger in the image, or use more "
                "corners"};
  }
  return {fit->pose, rms, ""};
}

}  // namespace kinecal
