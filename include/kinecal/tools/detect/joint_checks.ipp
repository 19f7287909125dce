// Checks that the stamps of a joint track are usable.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <chrono>
#include <string>

#include "kinecal/files/diagnostics.hpp"
#include "kinecal/tools/detect/joint_track.hpp"
#include "kinecal/tools/detect/listed.ipp"

namespace kinecal::detail {

/// An error if stamps go back; a warning if joints were not measured throughout.
/// @param all        from the first to the last reading of any joint
/// @param in_motion  whether views are taken while the robot moves
inline void check_stamps(const JointTrack& track, const Standstill& all, bool in_motion,
                         const std::string& file, Diagnostics& diagnostics) {
  const std::string about = "topic '" + printable(track.topic) + "': ";
  if (track.back) {
    diagnostics.error({file, 0},
                      about + "stamps go back from " + seconds_text(track.back->end) + " to " +
                          seconds_text(track.back->begin) +
                          ": the clock was set, or a simulation began anew; cut the recording "
                          "there");
  }
  constexpr double kMost = 0.9;
  const auto [first, last] = std::minmax_element(track.stamps.begin(), track.stamps.end());
  const std::chrono::duration<double> own = *last - *first, whole = all.end - all.begin;
  if (own >= kMost * whole) return;
  diagnostics.warning(
      {file, 0}, about + "joints " + listed(track.names) + " were measured for " +
                     seconds_text(*last - *first) + " of " + seconds_text(all.end - all.begin) +
                     (in_motion ? ", and only then are views used; choose topics with --joints"
                                : ", and only then is it known that they stand still; name those "
                                  "that need not with --restless"));
}

}  // namespace kinecal::detail
