// Writes the first capture.yaml of a robot, with the names of its first configuration.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "kinecal/kinematics/robot.hpp"
#include "kinecal/tools/init/init_answers.hpp"

namespace kinecal {

/// The first words of what initial_capture() writes, by which it is recognised.
inline constexpr const char* kInitialCaptureMark = "# Capture for 'kinecal init'";

/// The text of a capture.yaml; empty with a tracker or LEDs in pixels, which no finder looks for.  Sizes and numbers of
/// a board are zero, and readers refuse it until they are filled in: a guess would be a wrong scale.
/// @param given  as of initial_config(), which checks them
[[nodiscard]] std::string initial_capture(const Robot& robot, const InitAnswers& given);
/// The same for several arms and cameras: see answers_of_all().
[[nodiscard]] std::string initial_capture(const Robot& robot,
                                          const std::vector<InitAnswers>& given);

/// The keys of a capture.yaml that must agree with the configuration: "chain_sensor_name: board,
/// ..."
[[nodiscard]] std::string capture_names(const Robot& robot, const InitAnswers& given);

}  // namespace kinecal
