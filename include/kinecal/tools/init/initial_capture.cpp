// Definitions of initial_capture.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/tools/init/initial_capture.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "kinecal/files/yaml/yaml_text.hpp"
#include "kinecal/kinematics/chain.hpp"
#include "kinecal/tools/init/robot_parts.hpp"

namespace kinecal {

namespace detail {
namespace {

/// Joints with drives on the way from the base to a link, without those that are known.
[[nodiscard]] std::vector<std::string> drives_to(const Robot& robot, const std::string& base,
                                                 const std::string& link,
                                                 const std::vector<std::string>& known) {
  std::vector<std::string> joints;
  const RuntimeChain chain = make_chain(robot, base, link);
  for (const ChainJoint& joint : chain.joints) {
    const std::string& name = joint.drive.joint;
    if (!has_position(joint)) continue;
    const auto is_in = [&](const std::vector<std::string>& list) {
      return std::find(list.begin(), list.end(), name) != list.end();
    };
    if (!is_in(known) && !is_in(joints)) joints.push_back(name);
  }
  return joints;
}

[[nodiscard]] std::string chain_text(const std::string& name,
                                     const std::vector<std::string>& joints) {
  if (joints.empty()) return "";
  std::string list;
  for (const std::string& joint : joints) list += (list.empty() ? "" : ", ") + name_to_yaml(joint);
  return fmt::format(
      " - name: {}\n   topic: /{}_controller/follow_joint_trajectory  # of its controller\n"
      "   joints: [{}]\n",
      name, name, list);
}

/// Which joints move, by which controllers.
[[nodiscard]] std::string chains_text(const Robot& robot, const InitAnswers& answers) {
  std::vector<std::string> arm, head;
  if (needs_arm(answers.target)) arm = drives_to(robot, answers.base, answers.arm, {});
  head = drives_to(robot, answers.base, answers.camera, arm);
  if (arm.empty()) std::swap(arm, head);
  const std::string text = chain_text("arm", arm) + chain_text("head", head);
  if (text.empty()) return "";
  return "\n# The joints that move, by controller: for `kinecal capture` only.\nchains:\n" + text;
}

/// The same of several arms and cameras, each joint once.
[[nodiscard]] std::string chains_text(const Robot& robot, const std::vector<InitAnswers>& all) {
  std::vector<std::string> known;
  std::string text;
  for (const InitAnswers& answers : all) {
    for (const std::string& link : {answers.arm, answers.camera}) {
      if (link.empty()) continue;
      const std::vector<std::string> joints = drives_to(robot, answers.base, link, known);
      known.insert(known.end(), joints.begin(), joints.end());
      text += chain_text(link, joints);
    }
  }
  if (text.empty()) return "";
  return "\n# The joints that move, by controller: for `kinecal capture` only.\nchains:\n" + text;
}

/// The keys that all finders of a camera have.
[[nodiscard]] std::string finder_head(const InitAnswers& answers, const std::string& name,
                                      const std::string& type) {
  const bool depth = answers.camera_type == "camera3d";
  return fmt::format(
      "  {}:\n    type: robot_calibration/{}\n"
      "    topic: {}  # for recordings and `kinecal capture`\n    camera_sensor_name: {}\n",
      name, type, depth ? "/camera/depth_registered/points" : "/camera/image_raw",
      name_to_yaml(answers.camera_name));
}

/// What describes a board: to be measured.
[[nodiscard]] std::string board_numbers(InitBoard board) {
  if (board == InitBoard::apriltag) {
    return "    columns: 0     # of tags; fill in\n"
           "    rows: 0        # fill in\n"
           "    size: 0.0      # side of a tag's black border, metres; measure it\n"
           "    spacing: 0.3   # gap between tags, as a fraction of the size\n"
           "    family: tag36h11\n"
           "    border: 1      # bits of the black border; 2 in Kalibr's own PDFs\n";
  }
  if (board == InitBoard::charuco) {
    return "    squares_x: 0      # columns of squares; fill in\n"
           "    squares_y: 0      # fill in\n"
           "    square_size: 0.0  # metres; measure it\n"
           "    marker_size: 0.0  # metres; measure it\n"
           "    dictionary: DICT_4X4_50\n";
  }
  return "    points_x: 0    # inner corners in a row; fill in\n"
         "    points_y: 0    # fill in\n"
         "    size: 0.0      # of a square, metres; measure it\n";
}

[[nodiscard]] std::string board_text(const InitAnswers& answers, const std::string& name) {
  const char* of = answers.board == InitBoard::apriltag  ? "AprilTagFinder"
                   : answers.board == InitBoard::charuco ? "CharucoFinder"
                                                         : "CheckerboardFinder";
  const std::string type = of + std::string(answers.camera_type == "camera3d" ? "" : "2d");
  return finder_head(answers, name, type) +
         fmt::format("    chain_sensor_name: {}\n    frame_id: {}\n",
                     name_to_yaml(holder_of(answers)), name_to_yaml(answers.target_frame)) +
         board_numbers(answers.board);
}

[[nodiscard]] std::string leds_text(const InitAnswers& answers, const std::string& name) {
  return finder_head(answers, name, "LedFinder") +
         fmt::format(
             "    chain_sensor_name: {}\n    gripper_led_frame: {}\n"
             "    action: /gripper_controller/led_action  # switches the LEDs\n"
             "    poses: []  # fill in, in metres: [{{code: 1, topic: led1, x: 0.01, y: 0, z: 0}}, "
             "...]\n",
             name_to_yaml(holder_of(answers)), name_to_yaml(answers.arm));
}

/// What a tip touches: a finder for each place.
/// @param of  of several arms: "_" and its name
[[nodiscard]] std::string touches_text(const InitAnswers& answers, const std::string& of) {
  const bool has_layout = !answers.layout.empty();
  const std::size_t count = has_layout ? answers.layout.size() : answers.places.size();
  const bool has_direction = answers.target == InitTarget::plane ||
                             answers.target == InitTarget::line ||
                             answers.target == InitTarget::grip;
  std::string text;
  for (std::size_t i = 0; i < count; ++i) {
    const std::string& frame = answers.places[has_layout ? 0 : i];
    text += fmt::format(
        "  {}:\n    type: TouchFinder\n    chain_sensor_name: {}\n    tip_frame: {}\n"
        "    touched_sensor_name: {}\n    frame_id: {}\n",
        name_to_yaml((has_layout ? fmt::format("socket_{}", i + 1) : frame) + of),
        name_to_yaml(holder_of(answers)), name_to_yaml(answers.target_frame),
        name_to_yaml(tracker_of(answers)), name_to_yaml(frame));
    if (has_direction) text += "    has_direction: true\n";
    if (has_layout) {
      const Vector3<double>& at = answers.layout[i];
      text += fmt::format("    x: {}\n    y: {}\n    z: {}\n", at.x(), at.y(), at.z());
    }
  }
  return text;
}

}  // namespace
}  // namespace detail

std::string initial_capture(const Robot& robot, const InitAnswers& given) {
  return initial_capture(robot, std::vector<InitAnswers>{given});
}

std::string initial_capture(const Robot& robot, const std::vector<InitAnswers>& given) {
  std::vector<InitAnswers> all;
  for (const InitAnswers& one : given) all.push_back(with_proposals(robot, one));
  const InitAnswers& answers = all.front();
  // No finder reports where a reflector is, or LEDs in pixels; clouds and masks are taken as they are.
  const bool in_pixels = answers.camera_type == "camera2d";
  if (answers.target == InitTarget::tracker || answers.target == InitTarget::robot) return "";
  // Their readings come in a table.
  if (answers.target == InitTarget::distance || answers.target == InitTarget::gravity) return "";
  if (is_touched(answers.target)) {
    std::string text =
        fmt::format("{}: what the tip touches, for `kinecal capture --manual`.\n\nfeatures:\n",
                    kInitialCaptureMark) +
        detail::touches_text(answers, answers.more_arms.empty() ? "" : "_" + answers.arm);
    for (const FurtherArm& more : answers.more_arms) {
      InitAnswers of = answers;
      of.holder = more.arm;
      of.target_frame = more.target_frame;
      text += detail::touches_text(of, "_" + more.arm);
    }
    return text;
  }
  if (answers.target == InitTarget::leds && in_pixels) return "";
  std::string text = fmt::format(
      "{}: what to look for, with the names of its configuration.\n"
      "# Fill in what is zero: sizes decide the scale of the result, so measure them.\n",
      kInitialCaptureMark);
  text += all.size() == 1 ? detail::chains_text(robot, answers) : detail::chains_text(robot, all);
  text += "\nfeatures:\n";
  std::vector<std::string> holders;
  for (const InitAnswers& one : all) {
    const std::string holder = holder_of(one);
    if (std::find(holders.begin(), holders.end(), holder) != holders.end()) continue;
    const std::string of = holders.empty() ? "" : "_of_" + holder;
    holders.push_back(holder);
    if (one.target == InitTarget::leds) text += detail::leds_text(one, "leds" + of);
    if (is_board(one.target)) text += detail::board_text(one, "board" + of);
  }
  if (answers.target == InitTarget::ground || answers.with_ground) {
    text += detail::finder_head(answers, "ground", "PlaneFinder");
  }
  return text;
}

std::string capture_names(const Robot& robot, const InitAnswers& given) {
  const InitAnswers answers = with_proposals(robot, given);
  std::string names = "camera_sensor_name: " + answers.camera_name;
  if (answers.target == InitTarget::ground) return names;
  names += ", chain_sensor_name: " + holder_of(answers);
  return names + (is_board(answers.target) ? ", frame_id: " + answers.target_frame
                                           : ", gripper_led_frame: " + answers.arm);
}

}  // namespace kinecal
