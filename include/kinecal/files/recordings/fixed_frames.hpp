// Frames that do not move against each other, from tf and from fixed joints of a URDF.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <string>

#include "kinecal/files/messages/value.hpp"
#include "kinecal/geometry/pose.hpp"
#include "kinecal/kinematics/robot.hpp"

namespace kinecal {

/// A tree of frames.  Names with and without a leading slash are the same.
class FixedFrames {
 public:
  /// Adds a transform of tf.  One that changes later, or gets another parent, is not fixed.
  /// @param pose  parent_T_child, metres
  void add(const std::string& parent, const std::string& child, const Pose<double>& pose);

  /// Adds the transforms of a message of tf: tf2_msgs/TFMessage.  What cannot be read is left out.
  void add(const MessageFields& message);

  /// Adds the fixed joints of a robot, except of links that tf has.
  void add(const Robot& robot);

  /// a_T_b, metres.
  /// @returns  nullopt if the frames are not known, not connected, or something moves between them
  [[nodiscard]] std::optional<Pose<double>> pose(const std::string& a, const std::string& b) const;

 private:
  struct Edge {
    std::string parent;
    Pose<double> pose;  ///< parent_T_child, metres
    bool moves = false;
  };
  /// Where a frame is in each frame above it, until one moves: above_T_frame.
  [[nodiscard]] std::map<std::string, Pose<double>> above(const std::string& frame) const;

  std::map<std::string, Edge> edges_;  ///< by child
};

/// The frames of a recording: of /tf, /tf_static and /robot_description.  What cannot be read is left out.
[[nodiscard]] FixedFrames recorded_frames(const std::string& path);

}  // namespace kinecal
