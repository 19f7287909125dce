// Decides whether the pixels of each camera2d are raw or rectified, if the configuration does not
// say.
//
// camera_info describes both: K and D a raw image, P a rectified one, and ROS keeps D even on
// topics of rectified images.  So both are tried, and the better fit wins.  With distances r of
// features, s the median of the better fit and n components, each sample has
//
//   d = sum (n + 1) / 2 [log(1 + (r_raw / s)^2) - log(1 + (r_rectified / s)^2)]
//
// the log-likelihood ratio under heavy-tailed noise, limited to [-5, 5] so that bad captures count
// little.  A winner needs |sum d| > 10 and |sum d| > 2.5 sqrt(sum d^2); with fewer than eight
// samples, nearly all must agree.
// Source: Vuong, Likelihood Ratio Tests for Model Selection and Non-Nested Hypotheses, 1989.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "kinecal/config/config.hpp"
#include "kinecal/files/diagnostics.hpp"
#include "kinecal/kinematics/robot.hpp"
#include "kinecal/samples/sample.hpp"

namespace kinecal {

/// Sets ModelConfig::image of each camera2d without the key.  If both fit alike, it stays
/// automatic.  A step without the key uses that of another step.
///
/// Notes the choice, with both medians.  Error: only rectified is possible, because the distortion
/// model is unsupported, and has coefficients that are not zero.  Warns of a raw image if R is not
/// the identity.
void choose_images(Config& config, const Robot& robot, std::span<const Sample> samples,
                   Diagnostics& diagnostics);

}  // namespace kinecal
