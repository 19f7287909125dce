// Predicted samples of an arm that touches something, for a configuration that `kinecal init` wrote for one of the targets
// that a tip touches or that two hands hold: poses that nobody has taken yet.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "kinecal/config/config.hpp"
#include "kinecal/kinematics/robot.hpp"
#include "kinecal/parameters/parameter_table.hpp"
#include "kinecal/samples/sample.hpp"
#include "kinecal/tools/init/determined_offsets.hpp"

namespace kinecal {

/// What a tip touches by a configuration, or one hand that holds what another holds.
struct ConfiguredTouch {
  MeasuredTarget target;      ///< with a contact
  std::string held, touched;  ///< sensors: of the tip, and of what it touches (of gravity: empty)
  std::string tip;            ///< frame of the tip
  std::vector<std::string> more_held = {};  ///< sensors of the target's further tips
  std::vector<std::string> places = {};     ///< frames of what is touched
};

/// nullopt if the configuration is not of a tip that touches something.
[[nodiscard]] std::optional<ConfiguredTouch> configured_touch(const Config& config);

/// Samples of poses, and where what is touched is.
struct TouchedSamples {
  std::vector<Sample> samples;
  ParameterTable values;  ///< of hands that hold one thing: of the frame between them; else empty
};

/// Samples in random poses within the joints' limits in which the tip touches, without errors.  Nothing looks for
/// collisions.
/// @param count  at most
/// @throws InputError  if the arm hardly reaches anything in different poses
[[nodiscard]] TouchedSamples touched_samples(const Robot& robot, const ConfiguredTouch& touch,
                                             std::size_t count, std::uint64_t seed);

}  // namespace kinecal
