// Definitions of possible_targets.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/tools/init/possible_targets.hpp"

#include <algorithm>

#include "kinecal/kinematics/chain.hpp"
#include "kinecal/tools/init/robot_parts.hpp"

namespace kinecal {

namespace detail {
namespace {

/// True if a camera moves with the end of an arm: no joint moves between them.
[[nodiscard]] bool moves_with(const Robot& robot, const std::string& camera,
                              const std::string& end) {
  try {
    const RuntimeChain between = make_chain(robot, camera, end);
    return std::none_of(between.joints.begin(), between.joints.end(),
                        [](const ChainJoint& joint) { return moves(joint.type); });
  } catch (const RobotError&) {
    return false;  // reported where they are used
  }
}

}  // namespace
}  // namespace detail

std::vector<std::string> cameras_for(const Robot& robot, InitTarget target,
                                     const std::string& arm) {
  std::vector<std::string> cameras = propose_cameras(robot);
  if (!needs_arm(target)) return cameras;
  const std::vector<std::string> arms =
      arm.empty() ? propose_arms(robot) : std::vector<std::string>{arm};
  std::erase_if(cameras, [&](const std::string& camera) {
    return !arms.empty() && std::all_of(arms.begin(), arms.end(), [&](const std::string& end) {
      return detail::moves_with(robot, camera, end);
    });
  });
  return cameras;
}

std::string why_no_target(const Robot& robot, InitTarget target, const std::string& arm,
                          const std::string& camera) {
  if (needs_camera(target) && camera.empty() && propose_cameras(robot).empty()) {
    return "--target: no link of the URDF looks like a camera; add it to the URDF, or give "
           "--camera LINK";
  }
  if (target == InitTarget::grip && arm.empty() && propose_arms(robot).size() < 2) {
    return "--target: grip is of two hands that hold one thing, and the URDF does not look like "
           "two "
           "arms; give their links: --arm LINK --touched-link LINK";
  }
  if (!needs_arm(target) || !needs_camera(target)) return "";
  const std::string advice =
      " moves with the arm and sees the same in every pose; let it see a board in the world: "
      "--target world_checkerboard, world_apriltag or world_charuco";
  if (camera.empty()) {
    if (!cameras_for(robot, target, robot.has_link(arm) ? arm : "").empty()) return "";
    return "--target: the camera '" + propose_cameras(robot).front() + "'" + advice;
  }
  if (!robot.has_link(camera) || !robot.has_link(arm)) return "";  // reported elsewhere
  return detail::moves_with(robot, camera, arm) ? "--camera: camera '" + camera + "'" + advice : "";
}

}  // namespace kinecal
