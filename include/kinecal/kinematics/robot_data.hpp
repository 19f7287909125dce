// A robot as constant data: what kinecal_add_robot() makes of a URDF when a project is built.
//
// The numbers are those that read_urdf() finds at run time, bit by bit; the compiler knows them, so
// that chains can be put together and checked before anything runs.
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
};

/// The position of a mimic joint: multiplier * position(joint) + offset.
struct MimicData {
  std::string_view joint = {};
  double multiplier = 1.0;
  double offset = 0.0;  ///< radians or metres
};

struct LimitsData {
  double lower = 0.0, upper = 0.0;  ///< radians or metres
};

struct JointData {
  std::string_view name = {};
  JointType type = JointType::fixed;
  std::string_view parent = {}, child = {};      ///< links
  PoseData origin = {};                          ///< of the joint in the parent link
  std::array<double, 3> axis = {1.0, 0.0, 0.0};  ///< unit vector, in the joint's frame
  std::optional<MimicData> mimic = {};
  std::optional<LimitsData> limits = {};
};

/// True if the joints are a tree in which each stands behind the one that moves its parent link;
/// the first joint's parent is the root.
[[nodiscard]] constexpr bool parents_first(std::span<const JointData> joints) {
  for (std::size_t i = 0; i < joints.size(); ++i) {
    const std::string_view root = joints.front().parent, parent = joints[i].parent;
    bool is_placed = parent == root;
    for (std::size_t above = i; above-- > 0 && !is_placed;) {  // mostly the next one
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

[[nodiscard]] inline Pose<double> pose_from(const PoseData& data) {
  using RowMajor = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
  return {Eigen::Map<const RowMajor>(data.rotation.data()),
          Eigen::Map<const Vector3<double>>(data.translation.data())};
}

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

/// The same robot at run time, where names are looked up.
/// @throws RobotError  as the constructor of Robot
template <RobotData R>
[[nodiscard]] Robot robot_from() {
  std::vector<Joint> joints;
  for (const JointData& joint : R::kJoints) joints.push_back(joint_from(joint));
  return Robot(std::string(R::kName), std::move(joints));
}

}  // namespace kinecal
