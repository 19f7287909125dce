// A view: what a camera saw at one moment; and what a finder found in it.
//
// All stamps use one clock, the robot's.  Nothing here reads the computer's clock, so a simulated
// robot, a recording and a real robot are captured in the same way.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "kinecal/capture/image.hpp"
#include "kinecal/samples/sample.hpp"

namespace kinecal {

/// A time on the robot's clock, since its epoch.
using Stamp = std::chrono::nanoseconds;

/// Joint positions at one moment.
struct MeasuredJoints {
  Stamp stamp{};                        ///< when they were measured
  std::vector<std::string> names;       ///< of joints
  std::vector<double> positions;        ///< radians or metres, in the order of the names
  std::vector<double> velocities = {};  ///< rad/s or m/s, in the same order; empty: unknown
  std::map<std::string, Pose<double>> poses = {};  ///< measured ones, of floating joints

  /// Position of a joint, radians or metres; nullopt if it was not measured.
  [[nodiscard]] std::optional<double> position(const std::string& joint) const {
    for (std::size_t i = 0; i < names.size() && i < positions.size(); ++i) {
      if (names[i] == joint) return positions[i];
    }
    return std::nullopt;
  }
};

/// A camera's view at one moment: an image, a cloud, or both of the same size.
struct View {
  Stamp stamp{};                     ///< of the exposure
  std::string frame;                 ///< the camera's optical frame: z forward, x right, y down
  std::optional<CameraInfo> camera;  ///< nullopt if the driver did not send it
  GrayImage image;                   ///< empty if absent
  PointCloud points;                 ///< empty if absent
  MeasuredJoints joints;             ///< of the robot at that moment
  /// Seconds from one point of a scan to the next, the first at the stamp; zero: all at the stamp.
  double point_time = 0.0;
};

/// A place in the image, for pictures of what was found.
struct Mark {
  double u = 0.0;          ///< column, pixels
  double v = 0.0;          ///< row, pixels
  std::string label = {};  ///< such as the feature's id
  std::optional<double> off =
      {};                ///< distance from where the others put it, pixels; if it is known
  bool dropped = false;  ///< too far off to be a feature
};

/// A line in pictures of what was found: a piece of a target's grid where it was fitted, pixels.
struct GridLine {
  double u0 = 0.0, v0 = 0.0, u1 = 0.0, v1 = 0.0;
};

/// The result of a finder: observations of two or more sensors with the same features, such as a
/// camera and the chain that holds the board; or why they are missing.
struct Found {
  std::vector<Observation> observations;  ///< empty if nothing was found
  std::string refusal;      ///< why not: "squares of 3.1 pixels; at least 8 are needed"
  std::vector<Mark> marks;  ///< where its features are in the image; also for refused ones
  std::vector<std::string> notes = {};  ///< what else is to be said, the same in each such view
  std::vector<GridLine> grid = {};      ///< of a flat target, if enough corners show where it is

  /// True if features were found.
  [[nodiscard]] explicit operator bool() const { return !observations.empty(); }
};

/// The result if nothing was found, with the reason.
[[nodiscard]] inline Found refused(std::string why, std::vector<Mark> marks = {}) {
  return {{}, std::move(why), std::move(marks), {}, {}};
}

}  // namespace kinecal
