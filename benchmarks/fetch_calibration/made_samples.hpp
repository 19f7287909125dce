// Simulated samples instead of recorded ones: a robot with errors looks at LEDs in its gripper.
//
// The poses are random within the joint limits; in each the camera sees all four LEDs.  Walk and
// camera model use known true values.  Measured points have noise of 1 mm.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <random>

#include "fetch_robot.hpp"
#include "kinecal/kinematics/forward_kinematics.hpp"
#include "kinecal/parameters/chain_parameters.hpp"
#include "kinecal/samples/sample.hpp"

namespace kinecal::bench {

/// Positions of the LEDs: metres, in wrist_roll_link.
[[nodiscard]] inline std::array<Vector3<double>, kLeds> led_points() {
  return {{{0.1044, 0.0355, 0.0396},
           {0.0514, 0.0355, 0.0396},
           {0.0514, -0.0355, 0.0396},
           {0.1044, -0.0355, 0.0396}}};
}

[[nodiscard]] inline CameraInfo head_camera_info() {
  constexpr double kFocal = 554.2546911911879;  // pixels
  CameraInfo info;
  info.width = 640;
  info.height = 480;
  info.distortion_model = "plumb_bob";
  info.d = {0, 0, 0, 0, 0};
  info.k = {kFocal, 0, 320.5, 0, kFocal, 240.5, 0, 0, 1};
  info.r = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  info.p = {kFocal, 0, 320.5, 0, 0, kFocal, 240.5, 0, 0, 0, 1, 0};
  return info;
}

/// Values as large as a real robot's errors: degrees in joints, a centimetre in frames and depth,
/// one percent in intrinsics.  Each is determined by its index.
[[nodiscard]] inline Eigen::VectorXd made_values(const ParameterTable& table) {
  Eigen::VectorXd values(table.size());
  for (int i = 0; i < table.size(); ++i) {
    const double size = table[i].unit == "rad" ? 0.02 : 0.01;
    values(i) = table[i].initial + size * std::sin(1.0 + 2.0 * i);
  }
  return values;
}

class MadeSamples {
 public:
  /// @param values  (26) true values of the parameters
  MadeSamples(const Robot& robot, const ParameterTable& table, const Eigen::VectorXd& values)
      : robot_(robot),
        arm_(make_chain(robot, kBase, kArmLink, kFreeFrames)),
        head_(make_chain(robot, kBase, kCameraLink, kFreeFrames)) {
    const std::span<const double> all(values.data(), static_cast<std::size_t>(values.size()));
    arm_corrections_ = corrections_for(chain_parameters(arm_, table), all);
    head_corrections_ = corrections_for(chain_parameters(head_, table), all);
    const std::string prefix = camera_mount().parameter_prefix();
    for (std::size_t i = 0; i < depth_.size(); ++i) {
      depth_[i] = values(table.index(parameter_name(prefix, DepthCamera::kParameters[i].name)));
    }
  }

  [[nodiscard]] std::vector<Sample> operator()(int count) {
    std::vector<Sample> samples;
    while (static_cast<int>(samples.size()) < count) {
      Sample sample = random_pose();
      if (!observe(sample)) continue;
      sample.source = "made:" + std::to_string(samples.size());
      samples.push_back(std::move(sample));
    }
    return samples;
  }

 private:
  [[nodiscard]] Sample random_pose() {
    Sample sample;
    for (const Joint& joint : robot_.joints()) {
      if (!moves(joint.type)) continue;
      const JointLimits limits =
          joint.limits.value_or(JointLimits{-std::numbers::pi, std::numbers::pi});
      sample.joint_names.push_back(joint.name);
      sample.joint_positions.push_back(
          std::uniform_real_distribution<double>(limits.lower, limits.upper)(random_));
    }
    return sample;
  }

  /// Adds the observations; false unless the camera sees all LEDs, at least half a metre away.
  [[nodiscard]] bool observe(Sample& sample) {
    const auto position_of = [&](const std::string& joint) { return *sample.position(joint); };
    const Pose<double> base_T_arm = forward_kinematics(arm_, position_of, arm_corrections_);
    const Pose<double> camera_T_base =
        forward_kinematics(head_, position_of, head_corrections_).inverse();
    Observation camera{"camera", {}, head_camera_info()}, arm{"arm", {}};
    const auto [fx, fy, cx, cy, z_offset, z_scaling] = DepthCamera::settings(camera);
    for (const Vector3<double>& led : led_points()) {
      const Vector3<double> p = camera_T_base * (base_T_arm * led);
      if (p.z() < 0.5) return false;
      // The pixel and raw depth of this point in the true camera.
      const double u = fx * (1 + depth_[0]) * p.x() / p.z() + cx * (1 + depth_[2]);
      const double v = fy * (1 + depth_[1]) * p.y() / p.z() + cy * (1 + depth_[3]);
      const double z = p.z() / (1 + depth_[5]) - depth_[4];
      if (u < 0 || u > camera.camera->width || v < 0 || v > camera.camera->height) return false;
      Vector3<double> seen((u - cx) * z / fx, (v - cy) * z / fy, z);
      for (int axis = 0; axis < 3; ++axis) seen(axis) += noise_(random_);
      camera.features.push_back({kCameraLink, seen});
      arm.features.push_back({kArmLink, led});
    }
    sample.observations = {camera, arm};
    return true;
  }

  const Robot& robot_;
  RuntimeChain arm_, head_;
  Corrections<double> arm_corrections_, head_corrections_;
  std::array<double, 6> depth_{};
  std::mt19937 random_{1};
  std::normal_distribution<double> noise_{0.0, 1e-3};  // metres
};

}  // namespace kinecal::bench
