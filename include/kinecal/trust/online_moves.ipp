// Possible next moves of one joint in a session.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <set>

#include "kinecal/trust/online_impl.ipp"
#include "kinecal/trust/pose_in_base.ipp"

namespace kinecal {

namespace detail {

/// True if a point is in the image of the camera that observed a sample, or if that is unknown.
[[nodiscard]] inline bool in_image(const Sample& sample, const Vector3<double>& p_camera) {
  if (!(p_camera.z() > 0.0)) return false;
  for (const Observation& seen : sample.observations) {
    if (!seen.camera || !(seen.camera->p[0] > 0.0)) continue;
    const CameraInfo& camera = *seen.camera;
    const double u = camera.p[0] * p_camera.x() / p_camera.z() + camera.p[2];
    const double v = camera.p[5] * p_camera.y() / p_camera.z() + camera.p[6];
    if (u < 0.0 || v < 0.0 || u > camera.width || v > camera.height) return false;
  }
  return true;
}

/// True if a sample has an observation of a camera.
[[nodiscard]] inline bool has_camera(const Sample& sample) {
  return std::any_of(sample.observations.begin(), sample.observations.end(),
                     [](const Observation& seen) { return seen.camera.has_value(); });
}

}  // namespace detail

/// Moves of one joint from the pose of the last sample, with that sample moved.  Its measurements
/// do not matter: information is that of the error-free problem.
inline std::vector<std::pair<NextMove, Sample>> OnlineCalibration::Impl::candidates(
    double step) const {
  const RobotState robot{*problem, values};
  const detail::PoseInBase of_frame(robot, frame), of_in(robot, in);
  std::set<std::string> joints;
  for (const FrameOnRobot* of : {&frame, &in}) {
    const RuntimeChain chain =
        make_chain(problem->robot(), problem->base(), of->link, problem->frames());
    for (const ChainJoint& joint : chain.joints) {
      if (has_position(joint)) joints.insert(joint.drive.joint);
    }
  }
  std::vector<std::pair<NextMove, Sample>> found;
  const Sample& last = samples.back();
  for (const std::string& name : joints) {
    const Joint& joint = problem->robot().joint(name);
    const double by = joint.type == JointType::prismatic ? 0.2 * step : step;
    for (const double change : {-by, by}) {
      Sample there = last;
      const auto at = std::find(there.joint_names.begin(), there.joint_names.end(), name);
      if (at == there.joint_names.end()) continue;
      double& position =
          there.joint_positions[static_cast<std::size_t>(at - there.joint_names.begin())];
      position += change;
      if (joint.limits && (position < joint.limits->lower || position > joint.limits->upper)) {
        continue;
      }
      const Vector3<double> p_in = (of_in.at(there).inverse() * of_frame.at(there)).translation;
      if (detail::has_camera(last) && !detail::in_image(there, p_in)) continue;
      found.emplace_back(NextMove{name, change, 0.0}, std::move(there));
    }
  }
  return found;
}

}  // namespace kinecal
