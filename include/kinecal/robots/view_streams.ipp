// Joins the streams of a camera behind a bridge by their stamps.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <chrono>
#include <deque>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "kinecal/capture/robot_interface.hpp"
#include "kinecal/files/messages/camera_message.ipp"
#include "kinecal/files/messages/view_message.hpp"
#include "kinecal/robots/joint_stream.ipp"
#include "kinecal/robots/ros_robot.hpp"

namespace kinecal::detail {

class ViewStreams {
 public:
  ViewStreams(RosRobot& robot, RosCameraOptions options)
      : robot_(&robot), options_(std::move(options)) {
    subscribe(options_.image, {"sensor_msgs/Image", "sensor_msgs/CompressedImage"});
    subscribe(options_.depth, {"sensor_msgs/Image", "sensor_msgs/CompressedImage"});
    subscribe(options_.cloud, {"sensor_msgs/PointCloud2"});
    if (streams_.empty()) {
      throw std::invalid_argument("a camera needs a topic of images, depth or clouds");
    }
    if (!options_.camera_info.empty()) {
      robot.bridge.subscribe(options_.camera_info, {"sensor_msgs/CameraInfo"}, 1);
    }
  }

  [[nodiscard]] View next(Stamp after) {
    const Deadline deadline = robot_->bridge.deadline();
    int ahead = 0;
    while (true) {
      for (Stream& stream : streams_) (void)take(stream, std::chrono::steady_clock::now());
      if (const auto match = matching(after)) {
        if (!is_ahead(*match->front())) return view_of(*match, deadline);
        constexpr int kConsistently = 3;
        if (++ahead >= kConsistently) throw PoseError(why_ahead(*match->front()));
        after = match->front()->stamp;
      }
      Stream& awaited = missing(after);
      if (!take(awaited, deadline)) fail_late(awaited, after);
    }
  }

 private:
  struct Stamped {
    BridgeMessage message;
    Stamp stamp;
  };
  struct Stream {
    std::string topic;
    std::deque<Stamped> newest;
  };
  using Match = std::vector<const Stamped*>;  ///< one message of each stream

  static constexpr std::size_t kKept = 4;
  static constexpr std::chrono::milliseconds kTogether{40};  ///< stamps of one exposure
  static constexpr std::chrono::seconds kSameClock{1};       ///< allowed difference of clocks

  void subscribe(const std::string& topic, std::vector<std::string> types) {
    if (topic.empty()) return;
    streams_.push_back({topic, {}});
    robot_->bridge.subscribe(topic, std::move(types), kKept);
  }

  bool take(Stream& stream, Deadline deadline) {
    auto messages = robot_->bridge.take(stream.topic, deadline);
    for (BridgeMessage& message : messages) {
      const Stamp stamp = header_stamp(message.fields());
      stream.newest.push_back({std::move(message), stamp});
      if (stream.newest.size() > kKept) stream.newest.pop_front();
    }
    return !messages.empty();
  }

  /// The newest messages of one moment after a time.
  [[nodiscard]] std::optional<Match> matching(Stamp after) const {
    const auto& first = streams_.front().newest;
    for (auto one = first.rbegin(); one != first.rend(); ++one) {
      Match match;
      for (const Stream& stream : streams_) {
        if (const Stamped* other = nearest(stream, one->stamp, after)) match.push_back(other);
      }
      if (match.size() == streams_.size()) return match;
    }
    return std::nullopt;
  }

  /// The message after a time that is nearest to a moment; null if none is near enough.
  [[nodiscard]] static const Stamped* nearest(const Stream& stream, Stamp moment, Stamp after) {
    const auto apart = [&](const Stamped& one) {
      return one.stamp > after ? std::chrono::abs(one.stamp - moment) : Stamp::max();
    };
    const auto best = std::ranges::min_element(stream.newest, {}, apart);
    return best != stream.newest.end() && apart(*best) <= kTogether ? &*best : nullptr;
  }

  /// The stream to wait for: the one furthest behind.
  [[nodiscard]] Stream& missing(Stamp after) {
    const auto newest = [&](const Stream& stream) {
      return stream.newest.empty() ? Stamp::min() : std::max(stream.newest.back().stamp, after);
    };
    return *std::ranges::min_element(streams_, {}, newest);
  }

  [[nodiscard]] View view_of(const Match& match, Deadline deadline) {
    View view;
    view.stamp = match.front()->stamp;
    view.camera = camera(deadline);
    for (std::size_t i = 0; i < match.size(); ++i) {
      view.stamp = std::min(view.stamp, match[i]->stamp);
      const MessageFields message = match[i]->message.fields();
      if (view.frame.empty()) view.frame = std::string(text_at(message, "header.frame_id"));
      try {
        add(streams_[i].topic, message, view);
      } catch (const std::exception& error) {
        throw PoseError("topic '" + streams_[i].topic + "': " + error.what());
      }
    }
    return view;
  }

  void add(const std::string& topic, const MessageFields& message, View& view) const {
    if (topic == options_.image) {
      view.image = gray_image(message);
    } else if (topic == options_.cloud) {
      read_cloud(message, view.points, view.image);
    } else if (view.camera) {
      view.points = points_of(depth_image(message), *view.camera);
    } else {
      throw std::runtime_error("depth becomes points only with camera_info, of which none came");
    }
  }

  /// The newest camera_info; waits only for the first one.
  [[nodiscard]] std::optional<CameraInfo> camera(Deadline deadline) {
    if (options_.camera_info.empty()) return std::nullopt;
    const auto messages = robot_->bridge.take(
        options_.camera_info, camera_ || no_camera_ ? std::chrono::steady_clock::now() : deadline);
    for (const BridgeMessage& message : messages) camera_ = camera_of(message.fields());
    no_camera_ = !camera_;
    return camera_;
  }

  /// Offset of a stream's stamps ahead of those of the joints, if known.
  [[nodiscard]] std::optional<ClockOffset> lead(const Stamped& message) const {
    const auto joints = robot_->offset();
    if (!joints) return std::nullopt;
    return *joints - clock_offset(message.message, message.stamp);
  }

  [[nodiscard]] bool is_ahead(const Stamped& message) const {
    return lead(message).value_or(ClockOffset{}) > kSameClock;
  }

  [[nodiscard]] std::string why_ahead(const Stamped& message) const {
    return "topic '" + streams_.front().topic + "': its stamps are " +
           stamp_text(lead(message).value_or(ClockOffset{})) +
           " ahead of those of the joint states: they are of another clock; synchronise the clocks "
           "(ntp, use_sim_time)";
  }

  [[noreturn]] void fail_late(const Stream& stream, Stamp after) const {
    const std::string& topic = stream.topic;
    if (stream.newest.empty()) throw SilenceError(robot_->bridge.why_silent(topic), topic, {});
    const Stamped& last = stream.newest.back();
    std::string why = "topic '" + topic + "': nothing after " + stamp_text(after) +
                      "; the newest message is of " + stamp_text(last.stamp);
    if (last.stamp > after) {
      throw PoseError(why + ", and no other topic has one within " +
                      std::to_string(kTogether.count()) + " ms of it");
    }
    const auto ahead = lead(last);
    if (std::chrono::steady_clock::now() - last.message.arrival > kSameClock) {
      why += "; the stream has stopped";
    } else if (ahead && *ahead < -kSameClock) {
      why += ", " + stamp_text(-*ahead) + " behind the joint states: it lags, or is of another " +
             "clock; synchronise the clocks (ntp, use_sim_time)";
    }
    robot_->fail_silent(topic, why, last.stamp);
  }

  RosRobot* robot_;
  RosCameraOptions options_;
  std::vector<Stream> streams_;  ///< of those that make a view
  std::optional<CameraInfo> camera_;
  bool no_camera_ = false;  ///< true after a vain wait
};

}  // namespace kinecal::detail
