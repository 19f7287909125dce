// A sample: one pose of the robot and what its sensors observed in it.
//
// Same content as robot_calibration_msgs/CalibrationData, in metres, radians and pixels.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <chrono>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "kinecal/geometry/pose.hpp"
#include "kinecal/kinematics/floating_joint.hpp"

namespace kinecal {

/// Begins the name of a condition that is one of the sample before: "before left_wheel".
inline constexpr std::string_view kBefore = "before ";
/// The condition that numbers the runs of a recording: a sample of another run is not the sample before, and samples of a
/// run may err together.
inline constexpr const char* kRun = "run";

/// One observed point, pixel, pose or reading.
struct Feature {
  std::string frame;                                ///< frame of the point
  Vector3<double> point = Vector3<double>::Zero();  ///< (3) metres; a pixel is (u, v, 0), a reading
                                                    ///< (value, 0, 0)
  std::optional<Matrix3<double>> rotation = {};     ///< (3 x 3) of a pose: frame_R_feature
  /// Standard deviation of this measurement, in the unit of the residual: metres or pixels.  It
  /// replaces the error block's sigma.
  std::optional<double> sigma = {};
  /// Identifies the feature on its target, from 0: the corner of a board, the tag.  Error blocks
  /// pair features of several sensors by id, or by place in the list if there are no ids.
  std::optional<int> id = {};
  /// Further numbers of the feature, by name: the normal of a surface there, a temperature.  Error blocks name those
  /// they take; one of the feature comes before the sample's of the same name.
  std::map<std::string, double> conditions = {};
};

/// The settings of a camera during recording: sensor_msgs/CameraInfo and the depth driver's.
struct CameraInfo {
  int width = 0;                 ///< pixels
  int height = 0;                ///< pixels
  std::string distortion_model;  ///< such as "plumb_bob"
  std::vector<double> d;         ///< k1 k2 p1 p2 k3; rational: k4 k5 k6
  std::array<double, 9> k{};     ///< 3x3, row-major, pixels
  std::array<double, 9> r{};     ///< 3x3, row-major
  std::array<double, 12> p{};    ///< 3x4, row-major, pixels
  double z_offset = 0.0;         ///< of the depth driver, metres (z_offset_mm in files)
  double z_scaling = 1.0;        ///< of the depth driver: z = (z0 + z_offset) * z_scaling
};

/// The name of a feature in messages and tables: its place and its id.
struct FeatureLabel {
  int place =
      0;  ///< from 0, in the list of the observation; -1: a residual without a sensor, of the sample itself
  std::optional<int> id = {};  ///< Feature::id, if it has one

  /// "feature 3", counted from 1, "the feature with id 17" or "the sample".
  [[nodiscard]] std::string text() const {
    if (place < 0) return "the sample";
    return id ? "the feature with id " + std::to_string(*id)
              : "feature " + std::to_string(place + 1);
  }
};

/// What one sensor observed in a sample.
struct Observation {
  std::string sensor;                     ///< name of the sensor
  std::vector<Feature> features;          ///< with ids, or in an order that all sensors share
  std::optional<CameraInfo> camera = {};  ///< of cameras only
};

/// A sample that cannot be used with a robot and its sensors.
struct SampleError : std::invalid_argument {
  using std::invalid_argument::invalid_argument;
};

/// One pose of the robot and what its sensors observed in it.
struct Sample {
  std::vector<std::string> joint_names;   ///< of the joints whose positions were measured
  std::vector<double> joint_positions;    ///< radians or metres, in the order of the names
  std::vector<Observation> observations;  ///< at most one of each sensor
  std::string source;                     ///< source location, for messages: "samples.yaml:37"
  /// Further numbers of the sample, by name: temperature, load.  Error blocks name those they take
  /// and their units: see errors/error_block.hpp.
  std::map<std::string, double> conditions = {};
  /// Time at which the joints were measured, since the epoch of the robot's clock; nullopt if
  /// unknown.
  std::optional<std::chrono::nanoseconds> stamp = {};
  /// Velocities, rad/s or m/s, in the order of the names; empty: not recorded.
  std::vector<double> joint_velocities = {};
  /// How far each joint has come from where it stood before, radians or metres; 0 if it has not
  /// moved yet; empty: unknown.  See set_joint_moves().
  std::vector<double> joint_moves = {};
  /// What the sample before it in the recording had: its conditions and joint positions, by name; empty: there is
  /// none, or nobody asked.  Error blocks name those they take, after kBefore.  See set_before().
  std::map<std::string, double> before = {};
  /// Measured poses of floating joints by name, such as that of a flange: parent_T_child without the
  /// joint's origin, metres.  See kinematics/floating_joint.hpp.
  std::map<std::string, Pose<double>> poses = {};

  /// Measured position of a joint, or of a coordinate of a floating joint, radians or metres; nullopt
  /// if it was not measured.
  [[nodiscard]] std::optional<double> position(const std::string& joint) const {
    if (const std::optional<double> own = of(joint, joint_positions)) return own;
    if (poses.empty()) return std::nullopt;
    const std::optional<FloatingCoordinate> part = floating_coordinate(joint);
    const auto pose = part ? poses.find(part->joint) : poses.end();
    if (pose == poses.end()) return std::nullopt;
    return floating_positions(pose->second)[part->index];
  }
  /// Adds to the measured position of a joint, or of a coordinate of a floating joint; nothing if it
  /// was not measured.
  /// @param change  radians or metres
  void add_to_position(const std::string& joint, double change) {
    bool known = false;
    for (std::size_t i = 0; i < std::min(joint_names.size(), joint_positions.size()); ++i) {
      if (joint_names[i] != joint) continue;
      joint_positions[i] += change;
      known = true;
    }
    const std::optional<FloatingCoordinate> part = floating_coordinate(joint);
    const auto pose = known || !part ? poses.end() : poses.find(part->joint);
    if (pose == poses.end()) return;
    std::array<double, 6> at = floating_positions(pose->second);
    at[part->index] += change;
    pose->second = floating_pose(at);
  }
  /// Measured velocity of a joint, rad/s or m/s; nullopt if it was not measured.
  [[nodiscard]] std::optional<double> velocity(const std::string& joint) const {
    return of(joint, joint_velocities);
  }
  /// How far a joint has come: see joint_moves; nullopt if unknown.
  [[nodiscard]] std::optional<double> move(const std::string& joint) const {
    return of(joint, joint_moves);
  }

  /// The observation of a sensor; nullptr if absent.
  [[nodiscard]] const Observation* observation(const std::string& sensor) const {
    for (const Observation& o : observations) {
      if (o.sensor == sensor) return &o;
    }
    return nullptr;
  }

 private:
  [[nodiscard]] std::optional<double> of(const std::string& joint,
                                         const std::vector<double>& numbers) const {
    const std::size_t measured = std::min(joint_names.size(), numbers.size());
    for (std::size_t i = 0; i < measured; ++i) {
      if (joint_names[i] == joint) return numbers[i];
    }
    return std::nullopt;
  }
};

/// True if all points of a sample are numbers.
[[nodiscard]] inline bool has_numbers(const Sample& sample) {
  return std::all_of(sample.observations.begin(), sample.observations.end(), [](const auto& of) {
    return std::all_of(of.features.begin(), of.features.end(),
                       [](const Feature& feature) { return feature.point.allFinite(); });
  });
}

}  // namespace kinecal
