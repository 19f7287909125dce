// <calibration rising> of a URDF: an earlier calibration, which recorded positions include or not.
//
// A driver adds `rising` to the encoder reading.  Positions recorded after it was written include
// it, and a new offset is added: rising + offset.  Samples recorded before do not include it;
// mistaking them for the others would add the same offset a second time.  For these, positions +
// rising is what the driver would publish today.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <span>
#include <string>
#include <vector>

#include "kinecal/config/config.hpp"
#include "kinecal/files/diagnostics.hpp"
#include "kinecal/kinematics/robot.hpp"
#include "kinecal/samples/sample.hpp"

namespace kinecal {

/// When samples were recorded: before or after the <calibration rising> of the URDF was written.
enum class Recorded { after, before };

/// The nonzero <calibration rising> of a URDF, radians or metres, by joint.
/// @param text               the URDF, UTF-8
/// @param name_for_messages  name of the text in messages: its file
/// @throws InputError  if the text is not XML or a number cannot be read
[[nodiscard]] std::map<std::string, double> rising_of(const std::string& text,
                                                      const std::string& name_for_messages);

/// Adds `rising` to the positions of samples recorded before it was written.
/// @param factor  -1 removes it again
void add_rising(const std::map<std::string, double>& rising, std::vector<Sample>& samples,
                double factor = 1.0);

namespace detail {

/// Warning: the assumption about a nonzero <calibration rising>.  Doubt: the residuals fit better
/// under the other assumption, with both figures.
/// @param samples  with positions as the driver publishes them today, that is, after add_rising()
///                 for samples recorded before
void check_rising(const Config& config, const Robot& robot, const std::string& text,
                  const std::string& name_for_messages, std::span<const Sample> samples,
                  Recorded recorded, Diagnostics& diagnostics);

}  // namespace detail
}  // namespace kinecal
