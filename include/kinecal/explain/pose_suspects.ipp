// Possible mistakes in poses that a robot's controller reports: inverted, in another order, in another unit.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <functional>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "kinecal/explain/suspect.hpp"
#include "kinecal/geometry/rotation.hpp"
#include "kinecal/geometry/rpy.hpp"

namespace kinecal::detail {

/// The poses of samples: floating joints, but for those that are fitted.
[[nodiscard]] inline std::set<std::string> measured_poses(const Config& config,
                                                          std::span<const Sample> samples) {
  std::set<std::string> joints;
  for (const Sample& sample : samples) {
    for (const auto& [joint, pose] : sample.poses) joints.insert(joint);
  }
  for (const FreeParamConfig& own : config.per_sample) joints.erase(own.name);
  return joints;
}

/// R of numbers that were read as other ones.
using Reread = std::function<Matrix3<double>(const Matrix3<double>&)>;

/// What the numbers of a rotation may have meant.
[[nodiscard]] inline std::vector<std::pair<std::string, Reread>> rereadings() {
  using R = Matrix3<double>;
  using V = Vector3<double>;
  const auto about = [](const V& angles) -> R {  // moving axes: x, then y, then z
    return exp(V(angles.x(), 0, 0)) * exp(V(0, angles.y(), 0)) * exp(V(0, 0, angles.z()));
  };
  return {
      {"with rotations transposed", [](const R& r) -> R { return r.transpose(); }},
      {"with quaternions read as w x y z in place of x y z w",
       [](const R& r) -> R {
         const Eigen::Quaterniond q(r);
         return Eigen::Quaterniond(q.x(), q.y(), q.z(), q.w()).toRotationMatrix();
       }},
      {"with quaternions read as x y z w in place of w x y z",
       [](const R& r) -> R {
         const Eigen::Quaterniond q(r);
         return Eigen::Quaterniond(q.z(), q.w(), q.x(), q.y()).toRotationMatrix();
       }},
      {"with rotation vectors read as roll, pitch, yaw about fixed axes (fixed_xyz)",
       [](const R& r) -> R { return rotation_from_rpy(log(r)); }},
      {"with rotation vectors read as angles about moving axes (euler_xyz)",
       [about](const R& r) -> R { return about(log(r)); }},
      {"with roll, pitch, yaw read as a rotation vector",
       [](const R& r) -> R { return exp(rpy_from_rotation(r)); }},
      {"with roll, pitch, yaw read as angles about moving axes (euler_xyz)",
       [about](const R& r) -> R { return about(rpy_from_rotation(r)); }},
      {"with roll, pitch, yaw read in the order yaw, pitch, roll",
       [](const R& r) -> R { return rotation_from_rpy(rpy_from_rotation(r).reverse().eval()); }},
  };
}

inline void add_pose_suspects(const Config& config, std::span<const Sample> samples,
                              std::vector<Suspect>& all) {
  for (const std::string& joint : measured_poses(config, samples)) {
    const auto add = [&](const std::string& undone, const auto& change,
                         SuspectKind kind = SuspectKind::mistake) {
      all.push_back({.undone = undone, .kind = kind, .correct = [=](Sample& s) {
                       const auto at = s.poses.find(joint);
                       if (at != s.poses.end()) at->second = change(at->second);
                     }});
    };
    const std::string in = " in the poses of '" + joint + "'";
    add(fmt::format("with the poses of '{}' inverted, as if they were those of the base in the "
                    "flange (init --inverse), or the target on the other side",
                    joint),
        [](const Pose<double>& pose) { return pose.inverse(); });
    for (const auto& [undone, reread] : rereadings()) {
      const Reread of = reread;  // lambdas of C++20 capture no structured bindings in clang 14
      add(undone + in, [of](const Pose<double>& pose) {
        return Pose<double>{of(pose.rotation), pose.translation};
      });
    }
    for (const double factor : {1e3, 1e2, 1e1, 1e-1, 1e-2, 1e-3}) {
      const bool is_unit = factor > 50.0 || factor < 0.05;  // nobody's robot is in decimetres
      add(
          fmt::format("with positions multiplied by {}{}", factor, in),
          [factor](const Pose<double>& pose) {
            return Pose<double>{pose.rotation, factor * pose.translation};
          },
          is_unit ? SuspectKind::mistake : SuspectKind::property);
    }
  }
}

}  // namespace kinecal::detail
