// The joints whose measured positions a calibration uses, with these positions.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "kinecal/config/config.hpp"
#include "kinecal/kinematics/robot.hpp"
#include "kinecal/samples/sample.hpp"

namespace kinecal::detail {

/// A joint between the base link and some model, with its positions.
struct UsedJoint {
  Joint joint;                        ///< as in the URDF
  std::vector<double> positions;      ///< radians or metres, of the samples that have it
  std::vector<std::size_t> samples;   ///< index of the sample of each position
  std::optional<JointLimits> limits;  ///< from the URDF, if they bound anything: lower < upper, and
                                      ///< less than four turns for a rotating joint

  /// Largest minus smallest position.
  [[nodiscard]] double range() const;
  /// "[-3.1, 3.1] rad" or "±3.1 rad"; the joint must have limits.
  [[nodiscard]] std::string limits_text() const;
};

/// The models of all steps, each name once.
[[nodiscard]] std::vector<ModelConfig> models_of(const Config& config);

/// Names of the models whose features are not points in metres: pixels of cameras, readings.
[[nodiscard]] std::set<std::string> pixel_models(const Config& config);

/// Joints between the base link and the frames of models, fixed ones included, in the robot's
/// order.  Skips models that do not match the robot.
[[nodiscard]] std::vector<const Joint*> joints_between(const Config& config, const Robot& robot);

/// Joints whose measured positions move some model of the configuration, in the robot's order; a
/// mimic joint is represented by the joint it follows.
[[nodiscard]] std::vector<UsedJoint> used_joints(const Config& config, const Robot& robot,
                                                 std::span<const Sample> samples);

/// The joints with the zeros of the configuration: where its initial value brings all positions of a
/// joint into the limits, positions with it.
[[nodiscard]] std::vector<UsedJoint> with_initial_zeros(const Config& config,
                                                        std::vector<UsedJoint> joints);

}  // namespace kinecal::detail
