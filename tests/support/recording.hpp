// Recordings of a robot that moves and rests: joint states, images and camera_info.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "kinecal/capture/view.hpp"
#include "kinecal/files/messages/make.hpp"
#include "kinecal/files/messages/message_fields.hpp"
#include "kinecal/files/recordings/bag_output.hpp"
#include "kinecal/files/samples/read_samples.hpp"

namespace kinecal::test {

/// Writes messages with stamps to a ROS 1 bag or an MCAP file.
class Recorder {
 public:
  Recorder(const std::string& path, Encoding encoding) : bag_(path, encoding) {}

  Stamp delay = std::chrono::milliseconds(30);  ///< from a message's moment to its recording
  std::string frame = "optical";                ///< frame_id of what follows
  Stamp camera_ahead{};  ///< stamps of images against those of joints, for the same moment

  void joints(const std::string& topic, const MeasuredJoints& joints) {
    write(topic, "sensor_msgs/JointState", joints.stamp, {},
          detail::fields("name", detail::texts(joints.names), "position",
                         detail::numbers(joints.positions)));
  }

  /// @param data  of an encoding with a byte for each pixel
  void image(const std::string& topic, Stamp stamp, const GrayImage& image,
             std::string_view encoding = "mono8") {
    write(topic, "sensor_msgs/Image", stamp, camera_ahead,
          detail::fields("height", std::int64_t{image.height}, "width", std::int64_t{image.width},
                         "encoding", encoding, "step", std::int64_t{image.width}, "data",
                         std::as_bytes(std::span(image.pixels))));
  }

  /// @param millimetres  0 where nothing was measured
  void depth(const std::string& topic, Stamp stamp, const Image<std::uint16_t>& millimetres) {
    write(topic, "sensor_msgs/Image", stamp, camera_ahead,
          detail::fields("height", std::int64_t{millimetres.height}, "width",
                         std::int64_t{millimetres.width}, "encoding", std::string_view("16UC1"),
                         "step", std::int64_t{2 * millimetres.width}, "data",
                         std::as_bytes(std::span(millimetres.pixels))));
  }

  /// @param file  PNG or JPEG
  void compressed(const std::string& topic, Stamp stamp, const std::string& file) {
    write(topic, "sensor_msgs/CompressedImage", stamp, camera_ahead,
          detail::fields("format", std::string_view("mono8; png compressed"), "data",
                         std::as_bytes(std::span(file))));
  }

  void camera_info(const std::string& topic, Stamp stamp, const CameraInfo& camera,
                   int binning = 0) {
    write(topic, "sensor_msgs/CameraInfo", stamp, camera_ahead,
          detail::fields("height", std::int64_t{camera.height}, "width", std::int64_t{camera.width},
                         "distortion_model", std::string_view(camera.distortion_model), "d",
                         detail::numbers(camera.d), "k", detail::numbers(camera.k), "r",
                         detail::numbers(camera.r), "p", detail::numbers(camera.p), "binning_x",
                         std::int64_t{binning}, "binning_y", std::int64_t{binning}));
  }

  /// A scan from the right to the left.
  /// @param ranges     metres, of beams from `first` to -`first`, radians
  /// @param time_step  from one beam to the next, seconds
  void scan(const std::string& topic, Stamp stamp, double first, const std::vector<double>& ranges,
            double time_step) {
    const double step = -2.0 * first / (static_cast<double>(ranges.size()) - 1.0);
    write(topic, "sensor_msgs/LaserScan", stamp, {},
          detail::fields("angle_min", first, "angle_max", -first, "angle_increment", step,
                         "time_increment", time_step, "range_min", 0.1, "range_max", 10.0, "ranges",
                         detail::numbers(ranges)));
  }

  /// @param pose  of `child` in `parent`, metres
  void transform(const std::string& topic, Stamp stamp, const std::string& parent,
                 const std::string& child, const Pose<double>& pose) {
    const Eigen::Vector4d q = detail::quaternion(pose.rotation).normalized();
    const Vector3<double>& t = pose.translation;
    MessageFields one = detail::fields(
        "header",
        detail::fields("stamp", detail::time_fields(stamp), "frame_id", std::string_view(parent)),
        "child_frame_id", std::string_view(child), "transform",
        detail::fields("translation", detail::fields("x", t.x(), "y", t.y(), "z", t.z()),
                       "rotation", detail::fields("x", q(0), "y", q(1), "z", q(2), "w", q(3))));
    MessageValue::List all;
    all.emplace_back(std::move(one));
    bag_.write({topic, "tf2_msgs/TFMessage"}, (stamp + delay).count(),
               detail::fields("transforms", std::move(all)));
  }

  /// A command to LEDs, to the gripper's action or as a number.
  void led(const std::string& topic, const std::string& type, Stamp stamp, int code) {
    const std::int64_t number = code;
    if (type == "std_msgs/UInt8") {
      bag_.write({topic, type}, stamp.count(), detail::fields("data", number));
    } else {
      write(topic, type, stamp, {}, detail::fields("goal", detail::fields("led_code", number)));
    }
  }

  void finish() { bag_.finish(); }

 private:
  void write(const std::string& topic, const std::string& type, Stamp moment, Stamp ahead,
             MessageFields content) {
    content.fields.emplace_back(
        "header", detail::fields("stamp", detail::time_fields(moment + ahead), "frame_id",
                                 std::string_view(frame)));
    bag_.write({topic, type}, (moment + delay).count(), content);
  }

  BagOutput bag_;
};

/// A robot that rests a second in each pose and moves half a second to the next.
struct Tour {
  std::vector<std::string> names;
  std::vector<std::vector<double>> poses;
  double noise = 1e-4;  ///< of joint positions, at most

  static constexpr double kRest = 1.0, kMove = 0.5;  // seconds

  [[nodiscard]] double seconds() const {
    return static_cast<double>(poses.size()) * (kRest + kMove) - kMove;
  }

  /// The pose in which the robot rests, or that it leaves.
  [[nodiscard]] std::size_t pose_at(double time) const {
    return std::min(static_cast<std::size_t>(time / (kRest + kMove)), poses.size() - 1);
  }

  /// Share of the motion to the next pose; 0 at rest.
  [[nodiscard]] double progress_at(double time) const {
    const double since = time - static_cast<double>(pose_at(time)) * (kRest + kMove);
    return std::clamp((since - kRest) / kMove, 0.0, 1.0);
  }

  [[nodiscard]] std::vector<double> positions(double time) const {
    const std::size_t pose = pose_at(time), next = std::min(pose + 1, poses.size() - 1);
    std::vector<double> all;
    for (std::size_t j = 0; j < names.size(); ++j) {
      const double way = poses[next][j] - poses[pose][j];
      all.push_back(poses[pose][j] + progress_at(time) * way +
                    noise * std::sin(1e4 * time + static_cast<double>(j)));
    }
    return all;
  }
};

inline const Stamp kTourStart = std::chrono::seconds(1'700'000'000);

/// Calls what is recorded at 50 Hz and at 10 Hz, in the order of time.
inline void play(const Tour& tour, const std::function<void(Stamp, double time)>& joints,
                 const std::function<void(Stamp, double time)>& image) {
  constexpr int kPeriod = 20, kPerImage = 5;  // milliseconds; joint states
  const int count = static_cast<int>(tour.seconds() * 1000.0) / kPeriod;
  for (int i = 0; i <= count; ++i) {
    const Stamp since = std::chrono::milliseconds(i * kPeriod);
    const double time = std::chrono::duration<double>(since).count();
    joints(kTourStart + since, time);
    if (i % kPerImage == 0) image(kTourStart + since, time);
  }
}

/// The samples of a file that has no errors.
inline std::vector<Sample> samples_in(const std::filesystem::path& file) {
  Diagnostics diagnostics;
  std::vector<Sample> samples = read_samples(file.string(), diagnostics);
  diagnostics.throw_if_errors();
  return samples;
}

}  // namespace kinecal::test
