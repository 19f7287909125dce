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

/// The step between two readings, radians or metres; a joint that crosses +-pi makes no whole turn.
[[nodiscard]] double unwrapped_step(double from, double to);

/// Positions of the same joints over time, at most 100 per second; faster readings are averaged.
struct JointTrack {
  std::string topic;               ///< of the messages
  std::vector<std::string> names;  ///< of joints
  std::vector<bool> used = {};     ///< true if a joint's positions are taken from here
  std::vector<Stamp> stamps = {};  ///< of the positions
  std::vector<std::vector<double>> rows =
      {};                               ///< positions of each stamp, in the order of the names
  Stamp bin = {};                       ///< start of the last stamp's hundredth of a second
  Stamp newest = {};                    ///< stamp
  int readings = 0;                     ///< in the last hundredth of a second
  std::optional<Standstill> back = {};  ///< where stamps go back far: from end to begin

  /// Adds positions in the order of the names.
  void add(Stamp stamp, const std::vector<double>& positions);

  /// Sorts by stamps.
  void sort();

  /// The periods in which these joints stand still.
  /// @param joints  indices
  [[nodiscard]] std::vector<Standstill> rests(const std::vector<std::size_t>& joints,
                                              const SettleOptions& options) const;

  /// Indices of the rows within a time, the last one excluded; of the nearest row if there are
  /// none.
  [[nodiscard]] std::pair<std::size_t, std::size_t> near(Stamp stamp, const Standstill& time) const;
};

/// Periods common to both lists.
[[nodiscard]] std::vector<Standstill> common(const std::vector<Standstill>& a,
                                             const std::vector<Standstill>& b);

}  // namespace detail
}  // namespace kinecal
