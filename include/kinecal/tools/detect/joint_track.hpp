// Positions over time of joints that are published together.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "kinecal/capture/session/settling.hpp"
#include "kinecal/capture/view.hpp"

namespace kinecal {

/// A period in which all joints stand still.
struct Standstill {
  Stamp begin{};  ///< start
  Stamp end{};    ///< end
};

namespace detail {

/// Whether no joint moves by a step, radians or metres, in a time.
[[nodiscard]] bool is_impossible(double step, Stamp time);

/// The positions in one message, in the order of the track's names.
struct JointMessage {
  Stamp stamp;
  std::vector<double> positions;  ///< radians or metres
};

/// A joint that goes to another place and back within two messages, faster than joints move: two
/// nodes publish it, or a driver has lost its encoders.
struct JointJump {
  std::size_t joint = 0;        ///< index
  double from = 0.0, to = 0.0;  ///< radians or metres
};

/// Positions of the same joints over time, at most 100 per second; faster readings are averaged.
/// Readings that jump to another place and back are left out.
struct JointTrack {
  std::string topic;                ///< of the messages
  std::vector<std::string> names;   ///< of joints
  std::vector<bool> used = {};      ///< true if a joint's positions are taken from here
  std::vector<bool> restless = {};  ///< true if a joint may do anything
  std::vector<Stamp> stamps = {};   ///< of the positions
  std::vector<std::vector<double>> rows =
      {};                               ///< positions of each stamp, in the order of the names
  Stamp bin = {};                       ///< start of the last stamp's hundredth of a second
  Stamp newest = {};                    ///< stamp
  int readings = 0;                     ///< in the last hundredth of a second
  std::optional<Standstill> back = {};  ///< where stamps go back far: from end to begin
  std::size_t messages = 0, jumps = 0;  ///< all, and those left out
  std::optional<JointJump> jump = {};   ///< the first one
  std::size_t zeros = 0;                ///< messages left out at the beginning
  std::vector<double> noise = {};       ///< of each joint at rest, radians or metres

  /// Adds positions in the order of the names.
  void add(JointMessage reading);

  /// After the last message: sorts by stamps, and finds the noise.  Leaves out zeros of all joints
  /// before the first real reading, to which the joints jump.
  void finish();

  /// The periods in which these joints stand still.
  /// @param joints  indices
  [[nodiscard]] std::vector<Standstill> rests(const std::vector<std::size_t>& joints,
                                              const SettleOptions& options) const;

  /// Mean position of a joint, radians or metres; a joint that crosses +-pi makes no whole turn.
  /// @param first, last  index of the first row, and after the last one
  [[nodiscard]] double mean(std::size_t joint, std::size_t first, std::size_t last) const;

  /// Indices of the rows within a time, the last one excluded; of the nearest row if there are
  /// none.
  [[nodiscard]] std::pair<std::size_t, std::size_t> near(Stamp stamp, const Standstill& time) const;

 private:
  void take(const JointMessage& reading);
  void leave_out_first_zeros();
  [[nodiscard]] double noise_at_rest(std::size_t joint) const;
  std::optional<JointMessage> taken_ = {}, last_ = {};  ///< the last but one is taken
};

/// Periods common to both lists.
[[nodiscard]] std::vector<Standstill> common(const std::vector<Standstill>& a,
                                             const std::vector<Standstill>& b);

}  // namespace detail
}  // namespace kinecal
