// Which links of a robot are likely to be the end of an arm, a camera, the base: proposals to
// choose from, the likeliest first.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "kinecal/kinematics/chain.hpp"

namespace kinecal {

namespace detail {

[[nodiscard]] inline bool contains_word(const std::string& name, std::string_view word) {
  const auto lower = [](char c) { return 'A' <= c && c <= 'Z' ? static_cast<char>(c + 32) : c; };
  const auto same = [&](char a, char b) { return lower(a) == b; };
  return std::search(name.begin(), name.end(), word.begin(), word.end(), same) != name.end();
}

[[nodiscard]] inline bool looks_like_camera(const std::string& link) {
  for (const char* word : {"optical", "camera", "kinect", "xtion", "realsense"}) {
    if (contains_word(link, word)) return true;
  }
  return false;
}

/// A joint that is driven by itself.
[[nodiscard]] inline bool is_driven(const Joint& joint) {
  return moves(joint.type) && !joint.mimic;
}

/// Joints of the way to a link that are its own: below the last fork to other driven joints.
[[nodiscard]] inline std::size_t own_joints(const Robot& robot, const std::string& link) {
  const std::vector<const Joint*> way = joints_to_root(robot, link);
  std::size_t count = 0;
  for (std::size_t i = 0; i < way.size(); ++i) {
    if (is_driven(*way[i])) ++count;
    for (const Joint& other : robot.joints()) {
      // A head or a second arm, not a wheel: two driven joints in a row.
      if (!is_driven(other)) continue;
      const std::vector<const Joint*> beside = joints_to_root(robot, other.child);
      const auto fork = std::find_if(beside.begin(), beside.end(),
                                     [&](const Joint* j) { return j->parent == way[i]->parent; });
      if (fork == beside.end() || *fork == way[i]) continue;
      const auto driven =
          std::count_if(beside.begin(), fork + 1, [](const Joint* j) { return is_driven(*j); });
      if (driven >= 2) return count;
    }
  }
  return count;
}

/// Leaves a gripper's fingers and cameras on the wrist out of the end of an arm.
[[nodiscard]] inline std::string end_of_arm(const Robot& robot, std::string link) {
  for (;;) {
    const std::vector<const Joint*> way = joints_to_root(robot, link);
    if (way.empty()) return link;
    const Joint& last = *way.front();
    const auto turning =
        std::count_if(way.begin(), way.end(), [](const Joint* j) { return turns(j->type); });
    const bool finger = last.mimic || (last.type == JointType::prismatic && turning >= 3 &&
                                       contains_word(last.name, "finger"));
    if (!finger && !looks_like_camera(link)) return link;
    link = last.parent;
  }
}

}  // namespace detail

/// Links at the ends of chains with at least three moving joints of their own, the chains with most
/// of them first.
[[nodiscard]] inline std::vector<std::string> propose_arms(const Robot& robot) {
  constexpr std::size_t kLeast = 3;  // a pan-tilt head has two
  std::set<std::string> parents;
  for (const Joint& joint : robot.joints()) parents.insert(joint.parent);
  std::vector<std::pair<std::size_t, std::string>> ends;
  for (const Joint& joint : robot.joints()) {
    if (parents.contains(joint.child)) continue;
    const std::string end = detail::end_of_arm(robot, joint.child);
    const std::size_t own = detail::own_joints(robot, end);
    const auto same = [&](const auto& known) { return known.second == end; };
    if (own < kLeast || std::any_of(ends.begin(), ends.end(), same)) continue;
    ends.emplace_back(own, end);
  }
  std::stable_sort(ends.begin(), ends.end(),
                   [](const auto& a, const auto& b) { return a.first > b.first; });
  std::vector<std::string> names;
  for (auto& [own, name] : ends) names.push_back(std::move(name));
  return names;
}

/// Links that are called optical, those of colour before those of depth; then links that are called
/// camera.
[[nodiscard]] inline std::vector<std::string> propose_cameras(const Robot& robot) {
  const auto rank = [](const std::string& link) {
    if (!detail::contains_word(link, "optical")) return 3;
    if (detail::contains_word(link, "rgb") || detail::contains_word(link, "color")) return 0;
    return detail::contains_word(link, "depth") || detail::contains_word(link, "infra") ? 2 : 1;
  };
  std::vector<std::string> names;
  for (const Joint& joint : robot.joints()) {
    if (detail::looks_like_camera(joint.child)) names.push_back(joint.child);
  }
  std::stable_sort(names.begin(), names.end(),
                   [&](const std::string& a, const std::string& b) { return rank(a) < rank(b); });
  return names;
}

/// The highest link from which a chain leads to this one: the root, unless a floating or planar
/// joint is in between.
/// @throws RobotError  if there is no such link
[[nodiscard]] inline std::string propose_base(const Robot& robot, const std::string& link) {
  std::string base = link;
  for (const Joint* joint : joints_to_root(robot, link)) {
    if (joint->type == JointType::floating || joint->type == JointType::planar) break;
    base = joint->parent;
  }
  return base;
}

}  // namespace kinecal
