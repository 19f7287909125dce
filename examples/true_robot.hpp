// A robot and a camera as they really are, beside what URDF and driver say: for examples that
// simulate them.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <map>
#include <set>
#include <span>
#include <string>
#include <utility>

#include "kinecal/kinematics/pose_walker.hpp"
#include "kinecal/parameters/chain_parameters.hpp"
#include "simulation.hpp"

namespace kinecal::examples {

/// What the joints report: radians or metres.
using Positions = std::map<std::string, double>;

class TrueRobot {
 public:
  /// @param truth   what is wrong with the URDF, by the names of the parameters
  /// @param frames  whose corrections are among them; those that are no joints are virtual frames
  TrueRobot(const Robot& robot, const ParameterTable& truth, std::set<std::string> frames)
      : robot_(robot), truth_(truth), frames_(std::move(frames)) {}

  [[nodiscard]] const Robot& robot() const { return robot_; }
  [[nodiscard]] const ParameterTable& truth() const { return truth_; }

  /// Where a link really is when the joints report these positions.
  /// @param beyond  a virtual frame that hangs on the link, if that is what is asked for
  [[nodiscard]] Pose<double> pose(const std::string& base, const std::string& tip,
                                  const Positions& positions,
                                  const std::string& beyond = "") const {
    auto [known, is_new] = ways_.try_emplace({base, tip + "/" + beyond});
    if (is_new) known->second = way(base, tip, beyond);
    const auto& [chain, corrections] = known->second;
    const auto position_of = [&](const std::string& joint) { return positions.at(joint); };
    return forward_kinematics(chain, position_of, corrections);
  }

 private:
  using Way = std::pair<RuntimeChain, Corrections<double>>;

  [[nodiscard]] Way way(const std::string& base, const std::string& tip,
                        const std::string& beyond) const {
    RuntimeChain chain = make_chain(robot_, base, tip, frames_);
    if (!beyond.empty()) chain = with_virtual_frame(chain, beyond);
    const Eigen::VectorXd values = truth_.values();
    const std::span<const double> all(values.data(), static_cast<std::size_t>(values.size()));
    Corrections<double> corrections = corrections_for(chain_parameters(chain, truth_), all);
    return {std::move(chain), std::move(corrections)};
  }

  const Robot& robot_;
  const ParameterTable& truth_;
  std::set<std::string> frames_;
  mutable std::map<std::pair<std::string, std::string>, Way> ways_;  ///< those asked for so far
};

/// Where a link really is while the joints report what the sample says.
/// @param truth  what is wrong with the robot's drawing: of any joint, as an offset or a frame
[[nodiscard]] inline Pose<double> true_pose(const Robot& robot, const ParameterTable& truth,
                                            const std::string& base, const std::string& tip,
                                            const Sample& sample) {
  std::set<std::string> joints;
  for (const Joint& joint : robot.joints()) joints.insert(joint.name);
  Positions positions;
  for (std::size_t i = 0; i < sample.joint_names.size(); ++i) {
    positions[sample.joint_names[i]] = sample.joint_positions[i];
  }
  return TrueRobot(robot, truth, joints).pose(base, tip, positions);
}

/// A depth camera that its driver takes for example_camera_info().
class TrueCamera {
 public:
  /// @param truth  holds what is wrong with it: camera_fx, ..., camera_z_scaling
  /// @param frame  its optical frame
  TrueCamera(const ParameterTable& truth, std::string frame)
      : driver_(DepthCamera<>::from(example_camera_info())), frame_(std::move(frame)) {
    for (std::size_t i = 0; i < errors_.size(); ++i) {
      errors_[i] = truth[parameter_name("camera", kCameraParameters[i])].value;
    }
  }

  /// What its driver reports of a point.
  /// @param p_camera  (3) metres, in the optical frame
  [[nodiscard]] Feature record(const Vector3<double>& p_camera, SeededRandom& random) const {
    return {frame_, recorded_point(driver_, p_camera, errors_, {}, random)};
  }

  [[nodiscard]] const DepthCamera<>& driver() const { return driver_; }

 private:
  DepthCamera<> driver_;
  std::string frame_;
  std::array<double, 6> errors_{};
};

/// A sample of these positions in which nothing observes yet.
[[nodiscard]] inline Sample sample_at(const Positions& positions) {
  Sample sample;
  for (const auto& [joint, position] : positions) {
    sample.joint_names.push_back(joint);
    sample.joint_positions.push_back(position);
  }
  return sample;
}

}  // namespace kinecal::examples
