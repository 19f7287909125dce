// Recognizes likely parts of a robot: definitions of robot_parts.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/tools/init/robot_parts.hpp"

#include <algorithm>
#include <cstddef>
#include <initializer_list>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "kinecal/kinematics/chain.hpp"
#include "kinecal/text/nearest_name.hpp"
#include "kinecal/tools/init/camera_parts.ipp"

namespace kinecal {

namespace detail {
namespace {

/// True for a joint with a drive: it moves, and does not mimic another.
[[nodiscard]] bool is_driven(const Joint& joint) {
  return moves(joint.type) && !joint.mimic;
}

/// The joints below each link, and how many driven joints are in a row from each on.
class Branches {
 public:
  explicit Branches(const Robot& robot) {
    for (const Joint& joint : robot.joints()) {
      below_[joint.parent].push_back(&joint);
      if (!is_driven(joint)) continue;
      std::size_t count = 0;
      for (const Joint* above : joints_to_root(robot, joint.child)) {
        if (is_driven(*above)) ++count;
        std::size_t& most = driven_[above];
        most = std::max(most, count);
      }
    }
  }

  /// True if another branch than a joint's begins at its parent link, of a head or a second arm, not a wheel: with
  /// two driven joints in a row.
  [[nodiscard]] bool has_other(const Joint& joint) const {
    const auto& beside = below_.at(joint.parent);
    return std::any_of(beside.begin(), beside.end(), [&](const Joint* other) {
      const auto driven = driven_.find(other);
      return other != &joint && driven != driven_.end() && driven->second >= 2;
    });
  }

 private:
  std::map<std::string, std::vector<const Joint*>> below_;
  std::map<const Joint*, std::size_t> driven_;
};

/// Number of driven joints that lead only to this link: below the last fork to other driven joints.
[[nodiscard]] std::size_t own_joints(const Robot& robot, const Branches& branches,
                                     const std::string& link) {
  std::size_t count = 0;
  for (const Joint* joint : joints_to_root(robot, link)) {
    if (is_driven(*joint)) ++count;
    if (branches.has_other(*joint)) return count;
  }
  return count;
}

/// True if the name of a joint, or of the link it moves, contains one of these words.
[[nodiscard]] bool is_called(const Joint& joint, std::initializer_list<const char*> words) {
  return std::any_of(words.begin(), words.end(), [&](const char* word) {
    return contains_word(joint.name, word) || contains_word(joint.child, word);
  });
}

/// True if a joint at the end of a chain moves a finger: it mimics another or is mimicked, or its
/// name says so, beyond an arm.
/// @param turning  number of rotating joints above it
[[nodiscard]] bool moves_a_finger(const Robot& robot, const Joint& joint, std::ptrdiff_t turning) {
  constexpr std::ptrdiff_t kArm = 3;
  if (joint.mimic) return true;
  if (turning < kArm) return false;
  const auto& joints = robot.joints();
  const bool is_mimicked = std::any_of(joints.begin(), joints.end(), [&](const Joint& other) {
    return other.mimic && other.mimic->joint == joint.name;
  });
  return is_mimicked || is_called(joint, {"finger", "knuckle", "thumb", "jaw", "claw"}) ||
         (joint.type == JointType::prismatic && is_called(joint, {"gripper"})) ||
         (is_called(joint, {"gripper"}) && is_called(joint, {"motor"}));
}

/// The end of an arm without the fingers of its gripper and the cameras on its wrist.
[[nodiscard]] std::string end_of_arm(const Robot& robot, std::string link) {
  for (;;) {
    const std::vector<const Joint*> way = joints_to_root(robot, link);
    const auto last =
        std::find_if(way.begin(), way.end(), [](const Joint* j) { return moves(j->type); });
    if (last == way.end()) return link;
    const auto turning =
        std::count_if(last + 1, way.end(), [](const Joint* j) { return turns(j->type); });
    if (moves_a_finger(robot, **last, turning)) {
      link = (*last)->parent;
    } else if (looks_like_camera(link)) {
      link = way.front()->parent;
    } else {
      return link;
    }
  }
}

/// True if a moving joint on the path to a link is called one of these words.
[[nodiscard]] bool is_on(const Robot& robot, const std::string& link,
                         std::initializer_list<const char*> words) {
  const std::vector<const Joint*> way = joints_to_root(robot, link);
  return std::any_of(way.begin(), way.end(), [&](const Joint* joint) {
    return moves(joint->type) && is_called(*joint, words);
  });
}

[[nodiscard]] bool is_on_a_wheel(const Robot& robot, const std::string& link) {
  return is_on(robot, link, {"wheel", "caster"});
}

[[nodiscard]] bool is_on_a_leg(const Robot& robot, const std::string& link) {
  return is_on(robot, link, {"leg", "hip", "thigh", "knee", "calf", "ankle"});
}

}  // namespace
}  // namespace detail

std::vector<std::string> propose_arms(const Robot& robot) {
  constexpr std::size_t kLeast = 3;  // a pan-tilt head has two
  const detail::Branches branches(robot);
  std::set<std::string> parents;
  for (const Joint& joint : robot.joints()) parents.insert(joint.parent);
  std::vector<std::pair<std::size_t, std::string>> ends;
  for (const Joint& joint : robot.joints()) {
    if (parents.contains(joint.child) || detail::is_on_a_wheel(robot, joint.child)) continue;
    const std::string end = detail::end_of_arm(robot, joint.child);
    const std::size_t own = detail::own_joints(robot, branches, end);
    const auto same = [&](const auto& known) { return known.second == end; };
    if (own < kLeast || std::any_of(ends.begin(), ends.end(), same)) continue;
    ends.emplace_back(own, end);
  }
  std::stable_sort(ends.begin(), ends.end(),
                   [](const auto& a, const auto& b) { return a.first > b.first; });
  const auto is_leg = [&](const auto& end) { return detail::is_on_a_leg(robot, end.second); };
  if (!std::all_of(ends.begin(), ends.end(), is_leg)) std::erase_if(ends, is_leg);
  std::vector<std::string> names;
  for (auto& [own, name] : ends) names.push_back(std::move(name));
  return names;
}

std::vector<std::string> propose_cameras(const Robot& robot) {
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

std::string propose_base(const Robot& robot, const std::string& link) {
  std::string base = link;
  for (const Joint* joint : joints_to_root(robot, link)) {
    if (joint->type == JointType::floating || joint->type == JointType::planar) break;
    base = joint->parent;
  }
  return base;
}

bool is_free_frame_name(const Robot& robot, const std::string& name) {
  return !robot.has_link(name) && !nearest_name(name, robot.joint_names());
}

std::string propose_frame(const Robot& robot, std::vector<std::string> names) {
  for (std::size_t i = 0;; ++i) {
    if (i == names.size()) names.push_back("virtual_frame_" + std::to_string(i));
    if (is_free_frame_name(robot, names[i])) return names[i];
  }
}

std::string joint_above(const Robot& robot, const std::string& link,
                        const std::vector<std::string>& joints) {
  if (!robot.has_link(link)) return "";
  const Joint* above = robot.parent_joint(link);
  while (above != nullptr && std::find(joints.begin(), joints.end(), above->name) == joints.end())
    above = robot.parent_joint(above->parent);
  return above == nullptr ? "" : above->name;
}

InitAnswers with_proposals(const Robot& robot, InitAnswers answers) {
  const auto propose = [](std::string& answer, const std::string& proposal) {
    if (answer.empty()) answer = proposal;
  };
  const InitTarget target = answers.target;
  if (is_touched(target) && robot.has_link(answers.target_frame)) {
    propose(answers.arm, answers.target_frame);
  }
  if (target == InitTarget::grip) {
    std::vector<std::string> hands = propose_arms(robot);
    std::erase(hands, answers.carrier);
    if (!hands.empty()) propose(answers.arm, hands.front());
    std::erase(hands, answers.arm);
    if (hands.size() == 1) propose(answers.carrier, hands.front());
    propose(answers.target_frame, answers.arm);
  }
  const std::string& end = needs_arm(target) ? answers.arm : answers.camera;
  if (robot.has_link(end)) propose(answers.base, propose_base(robot, end));
  if (target == InitTarget::tracker) {
    propose(answers.target_frame, propose_frame(robot, {"smr", "reflector"}));
    propose(answers.tracker_frame, propose_frame(robot, {"tracker_frame", "laser_frame"}));
  } else if (is_touched(target)) {
    if (target != InitTarget::grip) propose(answers.carrier, answers.base);
    propose(answers.target_frame,
            target == InitTarget::gravity    ? propose_frame(robot, {"accelerometer"})
            : target == InitTarget::distance ? propose_frame(robot, {"gauge", "distance_sensor"})
                                             : propose_frame(robot, {"tip", "tool_tip"}));
    if (!answers.places.empty()) return answers;
    if (target == InitTarget::sockets && answers.length && answers.layout.empty()) {
      answers.layout = {Vector3<double>::Zero(), {*answers.length, 0.0, 0.0}};
    }
    if (target == InitTarget::sockets && answers.layout.empty()) {
      answers.places = {propose_frame(robot, {"socket_1"}), propose_frame(robot, {"socket_2"})};
      return answers;
    }
    const bool is_plane = target == InitTarget::plane || target == InitTarget::distance;
    const char* own = is_plane                        ? "plane"
                      : target == InitTarget::line    ? "line"
                      : target == InitTarget::sockets ? "sockets"
                      : target == InitTarget::grip    ? "grip"
                      : has_length(target)            ? "center"
                                                      : "place";
    answers.places = {propose_frame(robot, {own, std::string("touched_") + own})};
  } else if (needs_target_frame(target)) {
    const char* own = answers.board == InitBoard::checkerboard ? "checkerboard"
                      : answers.board == InitBoard::apriltag   ? "apriltag_grid"
                                                               : "charuco_board";
    propose(answers.target_frame, propose_frame(robot, {own, "board_frame"}));
  }
  return answers;
}

}  // namespace kinecal
