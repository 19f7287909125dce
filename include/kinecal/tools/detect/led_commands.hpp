// Which LED was on when, in a recording: the commands to the gripper, another topic, or a table.
//
//   robot_calibration_msgs/GripperLedCommandActionGoal   goal.led_code, at the stamp of its header
//   --led TOPIC                 led_code or data of any message, at its stamp, else when it was recorded
//   --led FILE.csv              columns time (seconds, as stamps are) and code
//
// A code holds until the next one.  0 means that all are off.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "kinecal/capture/view.hpp"
#include "kinecal/files/bags/bag.hpp"
#include "kinecal/files/diagnostics.hpp"
#include "kinecal/files/messages/value.hpp"
#include "kinecal/tools/detect/joint_track.hpp"

namespace kinecal {

/// LEDs were switched.
struct LedCommand {
  Stamp time{};
  int code = 0;  ///< of the LEDs that are on since then
};

/// A time in which the same LEDs are on.
struct LedSpan {
  int code = 0;
  Standstill time;  ///< without the time that LEDs and exposure take
};

/// True if a topic has commands of LEDs.
/// @param given  name of the topic, without slash; empty: by its type
[[nodiscard]] bool switches_leds(const BagTopic& topic, const std::string& given);

/// True if the codes are in a table.
[[nodiscard]] bool is_led_table(const std::string& given);

/// The code of a message; nullopt if it has none.
[[nodiscard]] std::optional<int> led_code(const MessageFields& message);

/// The commands of a table.
/// @throws InputError  if it cannot be read
[[nodiscard]] std::vector<LedCommand> read_led_table(const std::string& path,
                                                     Diagnostics& diagnostics);

/// The spans within a standstill, from the first command on: which LEDs are on before, nothing says.  If no command switches
/// all of them off, they count as off before the first one.
/// @param commands  sorted by time
/// @param settle    from a switch to the first view that counts
[[nodiscard]] std::vector<LedSpan> led_spans(const std::vector<LedCommand>& commands,
                                             const Standstill& time, Stamp settle);

}  // namespace kinecal
