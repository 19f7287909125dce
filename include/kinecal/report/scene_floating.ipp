// Floating joints in a scene: for scene_robot.ipp.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>

#include "kinecal/kinematics/floating_joint.hpp"
#include "kinecal/problem/any_problem.hpp"
#include "kinecal/report/robot_scene.hpp"

namespace kinecal::detail {

/// True for a floating joint that moves a sensor or target, so that the samples have its pose.
[[nodiscard]] inline bool is_measured(const AnyProblem& problem, const Joint& joint) {
  const auto is_part = [&](const ChainJoint& part) { return part.floating == joint.name; };
  if (joint.type != JointType::floating) return false;
  for (const MountedSensor& sensor : problem.sensors()) {
    for (const SampledChain& chain : sensor.chains()) {
      const auto& joints = chain.chain().joints;
      if (std::any_of(joints.begin(), joints.end(), is_part)) return true;
    }
  }
  return false;
}

/// A coordinate of a floating joint, without links and drive; nothing is drawn between its links.
[[nodiscard]] inline SceneJoint scene_coordinate(const Joint& joint, std::size_t i) {
  SceneJoint shown;
  const bool slides = i < 3;
  shown.name = joint.name;
  shown.type = slides ? JointType::prismatic : JointType::continuous;
  if (i == 0) shown.origin = joint.origin;
  shown.axis = {};
  shown.axis[slides ? i : 5 - i] = 1.0;
  shown.is_virtual = true;
  return shown;
}

}  // namespace kinecal::detail
