// A robot as it really is, beside what its URDF says: for examples that simulate one.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <set>
#include <string>
#include <utility>

#include "kinecal/parameters.hpp"
#include "kinecal/samples/sample.hpp"

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
