// A robot as constant data: kinecal_add_robot() generates it from a URDF at build time.
//
// The numbers equal those that read_urdf() reads at run time, bit for bit.  The compiler knows
// them, so it builds chains and checks names before anything runs.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <concepts>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "kinecal/kinematics/robot.hpp"

namespace kinecal {

/// A constant pose as plain numbers.
struct PoseData {
  std::array<double, 9> rotation = {1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0};  ///< row-major
  std::array<double, 3> translation = {};                                          ///< metres

  /// b_T_a of a_T_b.
  [[nodiscard]] constexpr PoseData inverse() const {
    PoseData other;
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t j = 0; j < 3; ++j) other.rotation[3 * i + j] = rotation[3 * j + i];
    }
    const double *r = other.rotation.data(), *t = translation.data();
    for (std::size_t i = 0; i < 3; ++i, r += 3) {
      other.translation[i] = -(r[0] * t[0] + r[1] * t[1] + r[2] * t[2]);
    }
    return other;
  }
};

/// a_T_c = a_T_b * b_T_c.
[[nodiscard]] constexpr PoseData operator*(const PoseData& a, const PoseData& b) {
  PoseData product;
  for (std::size_t r = 0; r < 3; ++r) {
    const double *row = &a.rotation[3 * r], *t = b.translation.data();
    for (std::size_t c = 0; c < 3; ++c) {
      const double* m = &b.rotation[c];
      product.rotation[3 * r + c] = row[0] * m[0] + row[1] * m[3] + row[2] * m[6];
    }
    product.translation[r] = row[0] * t[0] + row[1] * t[1] + row[2] * t[2] + a.translation[r];
  }
  return product;
}

/// The position of a mimic joint: multiplier * position(joint) + offset.
struct MimicData {
  std::string_view joint = {};  ///< the joint that it follows
  double multiplier = 1.0;      ///< of that joint's position
  double offset = 0.0;          ///< radians or metres
};

/// Range of a joint's position.
struct LimitsData {
  double lower = 0.0;  ///< radians or metres
  double upper = 0.0;  ///< radians or metres
};

/// A Joint as constant data.
struct JointData {
  std::string_view name = {};                    ///< unique in the robot
  JointType type = JointType::fixed;             ///< how it moves
  std::string_view parent = {};                  ///< link
  std::string_view child = {};                   ///< link
  PoseData origin = {};                          ///< of the joint in the parent link
  std::array<double, 3> axis = {1.0, 0.0, 0.0};  ///< unit vector, in the joint's frame
  std::optional<MimicData> mimic = {};           ///< if it follows another joint
  std::optional<LimitsData> limits = {};         ///< if it has any
};

/// True if the joints are a tree in which each joint comes after the one that moves its parent
/// link.  The parent of the first joint is the root.
[[nodiscard]] constexpr bool parents_first(std::span<const JointData> joints) {
  for (std::size_t i = 0; i < joints.size(); ++i) {
    const std::string_view root = joints.front().parent, parent = joints[i].parent;
    bool is_placed = parent == root;
    for (std::size_t above = i; above-- > 0 && !is_placed;) {  // mostly the previous one
      is_placed = joints[above].child == parent;
    }
    if (!is_placed || joints[i].child == root) return false;
  }
  return true;
}

/// A type that holds a robot: its name and its joints, parents before children.
template <class R>
concept RobotData = requires {
  { R::kName } -> std::convertible_to<std::string_view>;
  requires std::same_as<std::remove_cvref_t<decltype(R::kJoints)>,
                        std::array<JointData, R::kJoints.size()>>;
  requires parents_first(R::kJoints);
};

/// The pose as matrix and vector.
[[nodiscard]] inline Pose<double> pose_from(const PoseData& data) {
  using RowMajor = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
  return {Eigen::Map<const RowMajor>(data.rotation.data()),
          Eigen::Map<const Vector3<double>>(data.translation.data())};
}

/// The joint as Robot takes it.
[[nodiscard]] inline Joint joint_from(const JointData& data) {
  Joint joint{std::string(data.name),   data.type,
              std::string(data.parent), std::string(data.child),
              pose_from(data.origin),   Vector3<double>(data.axis[0], data.axis[1], data.axis[2])};
  if (data.mimic) {
    joint.mimic = {std::string(data.mimic->joint), data.mimic->multiplier, data.mimic->offset};
  }
  if (data.limits) joint.limits = {data.limits->lower, data.limits->upper};
  return joint;
}

/// The same robot at run time.
/// @throws RobotError  as the constructor of Robot does
template <RobotData R>
[[nodiscard]] Robot robot_from() {
  std::vector<Joint> joints;
  for (const JointData& joint : R::kJoints) joints.push_back(joint_from(joint));
  return Robot(std::string(R::kName), std::move(joints));
}

}  // namespace kinecal
