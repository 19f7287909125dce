// The true robot of a simulation: joints and frames differ from the URDF by known errors.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <set>
#include <span>
#include <string>
#include <utility>

#include "kinecal/problem/sampled_chain.hpp"
#include "kinecal/samples/sample.hpp"

namespace kinecal {

/// Joint positions by name: radians or metres.
using Positions = std::map<std::string, double>;

/// A sample of these positions, without observations.
[[nodiscard]] inline Sample sample_at(const Positions& positions) {
  Sample sample;
  for (const auto& [joint, position] : positions) {
    sample.joint_names.push_back(joint);
    sample.joint_positions.push_back(position);
  }
  return sample;
}

/// The true poses of a robot's links.
class TrueRobot {
 public:
  /// @param truth   errors of the URDF, by parameter name
  /// @param frames  names of corrected frames; those that are not joints are virtual frames
  TrueRobot(Robot robot, ParameterTable truth, std::set<std::string> frames)
      : robot_(std::move(robot)), truth_(std::move(truth)), frames_(std::move(frames)) {}

  [[nodiscard]] const Robot& robot() const { return robot_; }           ///< as its URDF has it
  [[nodiscard]] const ParameterTable& truth() const { return truth_; }  ///< errors of the URDF

  /// True pose of a link when the joints report these positions.
  /// @param beyond  a virtual frame beyond the link: returns its pose instead
  /// @returns       base_T_tip, metres
  /// @throws RobotError  if there is no chain between the links
  /// @throws SampleError  if the position of a joint of the chain is missing
  [[nodiscard]] Pose<double> pose(const std::string& base, const std::string& tip,
                                  const Positions& positions,
                                  const std::string& beyond = "") const {
    const std::pair key(base, tip + "/" + beyond);
    auto known = ways_.find(key);
    if (known == ways_.end()) known = ways_.emplace(key, way(base, tip, beyond)).first;
    const auto& [chain, corrections] = known->second;
    return chain.tip(sample_at(positions), corrections);
  }

 private:
  using Way = std::pair<SampledChain, Corrections<double>>;

  [[nodiscard]] Way way(const std::string& base, const std::string& tip,
                        const std::string& beyond) const {
    RuntimeChain chain = make_chain(robot_, base, tip, frames_);
    if (!beyond.empty()) chain = with_virtual_frame(chain, beyond);
    const Eigen::VectorXd values = truth_.values();
    const std::span<const double> all(values.data(), static_cast<std::size_t>(values.size()));
    SampledChain sampled(robot_, std::move(chain), truth_);
    Corrections<double> corrections = corrections_for(sampled.parameters(), all);
    return {std::move(sampled), std::move(corrections)};
  }

  Robot robot_;
  ParameterTable truth_;
  std::set<std::string> frames_;
  mutable std::map<std::pair<std::string, std::string>, Way> ways_;  ///< cache
};

/// True pose of a link when the joints report the positions of the sample.
/// @param truth  errors of the robot's drawing: offsets or frames of any joints
/// @returns      base_T_tip, metres
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

}  // namespace kinecal
