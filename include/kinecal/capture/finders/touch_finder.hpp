// A tip that touches something: nothing looks, the positions of the joints are all that is recorded.
//
// Two sensors without a camera observe it: the chain, whose point is the tip, and what is touched, whose point or pose is
// where it is in a frame of its own.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "kinecal/capture/robot_interface.hpp"

namespace kinecal {

/// Records that a tip touches something now.
struct TouchFinder {
  std::string chain_sensor = "arm";        ///< chain_sensor_name: observes the tip
  std::string tip = "tip";                 ///< tip_frame: the tip is its origin
  std::string touched_sensor = "touched";  ///< touched_sensor_name
  std::string frame = "place";             ///< frame_id: of what is touched
  Vector3<double> place =
      Vector3<double>::Zero();  ///< (3) x y z, metres: where it is in that frame
  bool has_direction = false;   ///< of a plane, a line or a hand, whose frame has a direction

  /// The observations of both, whatever the view shows.
  [[nodiscard]] Found find(const View& view) const;

  /// Empty: there is nothing to look at.
  [[nodiscard]] static std::string fault(const View& /*view*/) { return {}; }
};
static_assert(Finder<TouchFinder>);

}  // namespace kinecal
