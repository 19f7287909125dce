// Which joint offsets samples can determine beside free frames: decided on generated poses.
//
// Poses are random within the joints' limits.  A target's points p, seen by a sensor, are
//
//   p_sensor = (base_T_sensor)^-1 base_T_target p
//
// Of a tip that touches something, poses are random too, then moved by Gauss-Newton until it does, and only the components
// of p_sensor are looked at that the contact determines: all of a point, x and y of a line, z of a plane, the distance to
// the center of a sphere.  Of two hands that hold one rigid thing, all six numbers of the pose of one in the other.
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

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "kinecal/geometry/pose.hpp"
#include "kinecal/geometry/rotation.hpp"
#include "kinecal/kinematics/robot.hpp"

namespace kinecal {

/// What a tip touches: in its own frame, the origin, the z axis, the plane z = 0, or a sphere about the origin.
/// Or gravity, as an accelerometer on the arm reads it; or a hand whose pose in another hand stays: both hold one rigid thing.
enum class Contact { none, point, line, plane, sphere, gravity, grip };

/// The tip of a further arm that touches the same.
struct FurtherTip {
  std::string link;   ///< at the end of the arm
  std::string frame;  ///< free frame of the tip in it
};

/// A target and the sensor that measures its points; or a tip on an arm and what it touches, fixed to `sensor`.
struct MeasuredTarget {
  std::string base;               ///< link to which chains and frames beyond them refer
  std::string target;             ///< link that carries the points
  std::string sensor;             ///< link of the sensor
  std::string target_frame = {};  ///< free frame of the points in the target's link; empty: none
  bool is_point = false;          ///< it has a position only, as the frame of a reflector
  std::string sensor_frame =
      {};  ///< free frame of the sensor in its link, or of what is touched; empty: none
  bool is_camera = false;           ///< the sensor has intrinsics, which are free
  bool has_depth = false;           ///< it measures points in metres, not pixels
  Contact contact = Contact::none;  ///< what the point of the target touches in every pose
  int places = 1;  ///< of points that the tip touches: each has a free position of its own
  std::vector<Vector3<double>> layout =
      {};  ///< metres: known places of such points in one frame, or in the link, if no frame of the sensor is free
  bool radius_known = true;                ///< of a sphere
  std::vector<FurtherTip> more_tips = {};  ///< that touch the same points, one tip in each pose
};

/// The axes of a frame that touching points of it shows: x y z and the rotations about them.
/// @param layout  metres, in the frame; empty: its origin
[[nodiscard]] std::array<bool, 6> shown_axes(const std::vector<Vector3<double>>& layout);

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
/// those of further tips, then those of the sensor's.
/// @throws RobotError  like make_chain()
[[nodiscard]] std::vector<std::string> driven_joints(const Robot& robot,
                                                     const MeasuredTarget& measured);

/// Poses in which a tip touches what it touches.
struct TouchingPoses {
  std::vector<std::map<std::string, double>>
      positions;                  ///< of the joints, by name: radians or metres
  std::vector<std::size_t> tips;  ///< which one touches in each pose: 0 is the target
  std::vector<double> distances;  ///< that a distance sensor measures, metres; empty: a tip touches
  Pose<double>
      sensor_T_touched;  ///< where what is touched is in its link: of hands that hold one thing, the pose that stays
};

/// Random ones.  Nothing looks for collisions.
/// @param measured  with a contact
/// @param count     at most
/// @throws RobotError  like make_chain()
[[nodiscard]] TouchingPoses touching_poses(const Robot& robot, const MeasuredTarget& measured,
                                           std::size_t count, std::uint64_t seed);

/// The effects of these joints' offsets.
/// @param frames  joints whose frames are free
/// @throws RobotError  like make_chain()
[[nodiscard]] OffsetEffects offset_effects(const Robot& robot, const MeasuredTarget& measured,
                                           const std::vector<std::string>& frames,
                                           const std::vector<std::string>& joints);

}  // namespace kinecal
