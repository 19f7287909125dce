// Builds a chain from joints: finds the path between two links and folds its constant transforms.
//
// These functions take the joints of a Robot or of a RobotData.  So run-time and compile-time
// chains share the same search, checks and folding.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <limits>
#include <string_view>
#include <type_traits>

#include "kinecal/kinematics/joint.hpp"

namespace kinecal::detail {

/// Index that means "not found".
inline constexpr std::size_t kNowhere = std::numeric_limits<std::size_t>::max();

/// Index of the joint with this name, or kNowhere.
/// @param joints  Joints or JointDatas
template <class Joints>
[[nodiscard]] constexpr std::size_t joint_index(const Joints& joints, std::string_view name) {
  for (std::size_t i = 0; i < joints.size(); ++i) {
    if (joints[i].name == name) return i;
  }
  return kNowhere;
}

/// Index of the joint above a link, or kNowhere.
template <class Joints>
[[nodiscard]] constexpr std::size_t joint_above(const Joints& joints, std::string_view link) {
  for (std::size_t i = 0; i < joints.size(); ++i) {
    if (joints[i].child == link) return i;
  }
  return kNowhere;
}

/// The joint that drives a joint, through all mimic joints in between, with their multipliers and
/// offsets combined.  A joint that does not mimic drives itself.
template <class Joints, class Joint>
[[nodiscard]] constexpr auto drive_of(const Joints& joints, const Joint& joint) {
  typename std::remove_cvref_t<decltype(joint.mimic)>::value_type total{joint.name, 1.0, 0.0};
  const Joint* j = &joint;
  for (std::size_t n = 0; j->mimic && n < joints.size(); ++n) {
    total.offset += total.multiplier * j->mimic->offset;
    total.multiplier *= j->mimic->multiplier;
    total.joint = j->mimic->joint;
    j = &joints[joint_index(joints, total.joint)];
  }
  return total;
}

/// The joints between two links.
/// @tparam Indices  array or vector with room for twice the joints of the robot
template <class Indices>
struct Way {
  Indices joints{};           ///< from base to tip
  std::size_t up = 0;         ///< the first ones are passed from child to parent
  std::size_t size = 0;       ///< number of them
  bool is_connected = false;  ///< false: there is no path
  bool ends = true;           ///< false: a link is below itself
};

/// Goes up from the base and from the tip to their lowest common ancestor.
/// @param base, tip  links of the robot
template <class Joints, class Indices>
[[nodiscard]] constexpr Way<Indices> find_way(const Joints& joints, std::string_view base,
                                              std::string_view tip, Indices room) {
  Way<Indices> way{room};
  // Joints above the base from the front, those above the tip from the back.
  std::size_t front = 0, back = room.size();
  for (std::size_t j = joint_above(joints, base); j != kNowhere && way.ends;
       j = joint_above(joints, base)) {
    way.ends = front < joints.size();
    if (!way.ends) return way;
    way.joints[front++] = j;
    base = joints[j].parent;
  }
  for (std::size_t j = joint_above(joints, tip); j != kNowhere; j = joint_above(joints, tip)) {
    way.ends = room.size() - back < joints.size();
    if (!way.ends) return way;
    way.joints[--back] = j;
    tip = joints[j].parent;
  }
  way.is_connected = base == tip;
  while (front > 0 && back < room.size() && way.joints[front - 1] == way.joints[back]) {
    --front;
    ++back;  // above the common ancestor
  }
  way.up = front;
  for (way.size = front; back < room.size(); ++back) way.joints[way.size++] = way.joints[back];
  return way;
}

/// True if a chain can pass joints of this type as one joint.
[[nodiscard]] constexpr bool is_passable(JointType type) {
  return type == JointType::fixed || moves(type);
}

/// Visits the joints of a path that move, float or are corrected; folds everything constant between them.
/// @param is_corrected  callable: name of a joint -> whether it has a frame correction
/// @param visit         callable (joint, constant transform before it, is_corrected, reversed)
/// @returns             the constant transform after the last of them
template <class Joints, class Indices, class IsCorrected, class Visit>
[[nodiscard]] constexpr auto fold(const Joints& joints, const Way<Indices>& way,
                                  const IsCorrected& is_corrected, Visit&& visit) {
  std::remove_cvref_t<decltype(joints[0].origin)> fixed{};
  for (std::size_t n = 0; n < way.size; ++n) {
    const auto& joint = joints[way.joints[n]];
    const bool reversed = n < way.up;
    if (!reversed) fixed = fixed * joint.origin;
    const bool corrected = is_corrected(joint.name);
    if (corrected || moves(joint.type) || joint.type == JointType::floating) {
      visit(joint, fixed, corrected, reversed);
      fixed = {};
    }
    if (reversed) fixed = fixed * joint.origin.inverse();
  }
  return fixed;
}

}  // namespace kinecal::detail
