// Which joint offsets samples can determine beside free frames: decided on generated poses.
//
// Poses are random within the joints' limits.  A target's points p, seen by a sensor, are
//
//   p_sensor = (base_T_sensor)^-1 base_T_target p
//
// Its derivatives with respect to frames and camera parameters span what these can imitate.  An
// offset is determined if its derivative is not within this span, nor within that of offsets before
// it: what is left after projection is at least kLeastEffect of it.  So an offset before the first
// turn counts as determined if a rail moves the arm in another direction than along that turn, and
// not if a lift is parallel to it.
// Source: Hollerbach, Wampler, The Calibration Index and Taxonomy for Robot Kinematic Calibration
// Methods, 1996.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "kinecal/kinematics/robot.hpp"

namespace kinecal {

/// A target and the sensor that measures its points.
struct MeasuredTarget {
  std::string base;               ///< link to which chains and frames beyond them refer
  std::string target;             ///< link that carries the points
  std::string sensor;             ///< link of the sensor
  std::string target_frame = {};  ///< free frame of the points in the target's link; empty: none
  bool is_point = false;          ///< it has a position only, as the frame of a reflector
  std::string sensor_frame = {};  ///< free frame of the sensor in its link; empty: none
  bool is_camera = false;         ///< the sensor has intrinsics, which are free
  bool has_depth = false;         ///< it measures points in metres, not pixels
};

/// What a joint's offset changes.
struct OffsetEffect {
  std::string joint;        ///< that is driven: mimic joints have no offset of their own
  bool determined = false;  ///< samples can tell it
  bool is_seen = true;      ///< false if it changes nothing, such as of a joint below all chains
  std::string imitated_by = {};  ///< the free frame that does the same; empty: no frame alone
};

/// The effects of several offsets, and whether samples determine the free frames beside them.
struct OffsetEffects {
  std::vector<OffsetEffect> offsets;  ///< in the given order
  bool frames_determined = true;
};

/// The driven joints that move the target or the sensor: those of the target's chain from its base,
/// then those of the sensor's.
/// @throws RobotError  like make_chain()
[[nodiscard]] std::vector<std::string> driven_joints(const Robot& robot,
                                                     const MeasuredTarget& measured);

/// The effects of these joints' offsets.
/// @param frames  joints whose frames are free
/// @throws RobotError  like make_chain()
[[nodiscard]] OffsetEffects offset_effects(const Robot& robot, const MeasuredTarget& measured,
                                           const std::vector<std::string>& frames,
                                           const std::vector<std::string>& joints);

}  // namespace kinecal
