// Definitions of ros_robot.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/robots/ros_robot.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "kinecal/capture/robot_interface.hpp"
#include "kinecal/files/messages/camera_message.hpp"
#include "kinecal/files/messages/make.hpp"
#include "kinecal/files/messages/message_fields.hpp"
#include "kinecal/files/messages/scan_message.hpp"
#include "kinecal/files/messages/view_message.hpp"
#include "kinecal/robots/action_definitions.ipp"
#include "kinecal/robots/bridge_client.hpp"
#include "kinecal/robots/ros_action.hpp"
#include "kinecal/text/frame_name.hpp"
#include "kinecal/text/printable.hpp"

namespace kinecal {

namespace detail {

// The joint states of a robot behind a bridge.

/// Offset of this computer's clock ahead of a stream's stamps.
using ClockOffset = std::chrono::nanoseconds;

[[nodiscard]] inline ClockOffset clock_offset(const BridgeMessage& message, Stamp stamp) {
  return std::chrono::duration_cast<ClockOffset>(message.arrival.time_since_epoch()) - stamp;
}

/// A connection and the state of the joints.  Several nodes may publish different joints on one
/// topic, so the newest position of each joint is kept.
class RosRobot {
 public:
  RosRobot(const BridgeOptions& options, std::string topic)
      : bridge(options), topic_(std::move(topic)) {
    constexpr std::size_t kKept = 256;
    bridge.subscribe(topic_, {"sensor_msgs/JointState"}, kKept);
  }

  BridgeClient bridge;

  /// Positions of all joints.
  /// @param needed  joints whose stamps must be later; empty: any
  /// @throws SilenceError     if they do not arrive in time
  /// @throws ConnectionError  if the bridge has withdrawn their topic
  [[nodiscard]] MeasuredJoints next(Stamp after, const std::vector<std::string>& needed) {
    const Deadline deadline = bridge.deadline();
    take(std::chrono::steady_clock::now());
    while (true) {
      const auto stamp = stamp_of(needed);
      if (stamp && *stamp > after) return joints(*stamp);
      if (!take(deadline)) fail_late(after, needed);
    }
  }

  /// The newest stamp; nullopt before the first message.
  [[nodiscard]] std::optional<Stamp> newest() const { return newest_; }

  /// Offset of this computer's clock ahead of the robot's; nullopt before the first message.
  [[nodiscard]] std::optional<ClockOffset> offset() {
    take(std::chrono::steady_clock::now());
    return offset_;
  }

  /// Stamp of the next joint states.
  [[nodiscard]] Stamp now() {
    take(std::chrono::steady_clock::now());
    if (!take(bridge.deadline())) fail_late(newest_.value_or(Stamp{}), {});
    return newest_.value();
  }

  /// Reports a silent topic.
  /// @param newest  stamp of its last message
  [[noreturn]] void fail_silent(const std::string& topic, const std::string& why,
                                std::optional<Stamp> newest) {
    if (newest && !bridge.topic_type(topic, std::chrono::steady_clock::now())) {
      throw ConnectionError("topic '" + topic +
                            "': the bridge has withdrawn it; its newest message is of " +
                            stamp_text(*newest));
    }
    throw SilenceError(why, topic, newest);
  }

 private:
  struct Position {
    double value;
    Stamp stamp;
  };

  /// False if nothing came in time.
  bool take(Deadline deadline) {
    const auto messages = bridge.take(topic_, deadline);
    for (const BridgeMessage& message : messages) {
      const MessageFields state = message.fields();
      const Stamp stamp = header_stamp(state);
      // A restarted simulation or recording has earlier stamps.
      constexpr std::chrono::seconds kRestart{1};
      if (newest_ && stamp < *newest_ - kRestart) positions_.clear();
      if (!newest_ || stamp > *newest_ || positions_.empty()) newest_ = stamp;
      offset_ = clock_offset(message, stamp);
      const auto& names = list_at(state, "name");
      const auto& values = list_at(state, "position");
      for (std::size_t i = 0; i < std::min(names.size(), values.size()); ++i) {
        const auto* name = names[i].as<std::string_view>();
        const auto* value = values[i].as<double>();
        if (name != nullptr && value != nullptr) positions_[std::string(*name)] = {*value, stamp};
      }
    }
    return !messages.empty();
  }

  /// The oldest stamp of these joints; nullopt if one is unknown.
  [[nodiscard]] std::optional<Stamp> stamp_of(const std::vector<std::string>& needed) const {
    std::optional<Stamp> oldest = newest_;
    for (const std::string& joint : needed) {
      const auto position = positions_.find(joint);
      if (position == positions_.end()) return std::nullopt;
      oldest = std::min(*oldest, position->second.stamp);
    }
    return oldest;
  }

  [[nodiscard]] MeasuredJoints joints(Stamp stamp) const {
    MeasuredJoints joints;
    joints.stamp = stamp;
    for (const auto& [name, position] : positions_) {
      joints.names.push_back(name);
      joints.positions.push_back(position.value);
    }
    return joints;
  }

  [[noreturn]] void fail_late(Stamp after, const std::vector<std::string>& needed) {
    if (!newest_) throw SilenceError(bridge.why_silent(topic_), topic_, {});
    const std::string who = "topic '" + topic_ + "'";
    for (const std::string& joint : needed) {
      const auto position = positions_.find(joint);
      const std::string stream = topic_ + ": " + joint;
      if (position == positions_.end()) {
        throw SilenceError(who + " has no positions of joint '" + joint + "'", stream, {});
      }
      const Stamp last = position->second.stamp;
      if (last > after || *newest_ <= after) continue;
      throw SilenceError(
          who + ": joint '" + joint + "' is not measured any more, since " + stamp_text(last),
          stream, last);
    }
    fail_silent(topic_,
                who + ": no joint positions after " + stamp_text(after) + "; the newest are of " +
                    stamp_text(*newest_),
                newest_);
  }

  std::string topic_;
  std::map<std::string, Position> positions_;
  std::optional<Stamp> newest_;
  std::optional<ClockOffset> offset_;
};

// Joins the streams of a camera behind a bridge by their stamps.

class ViewStreams {
 public:
  ViewStreams(RosRobot& robot, RosCameraOptions options)
      : robot_(&robot), options_(std::move(options)) {
    subscribe(options_.image, {"sensor_msgs/Image", "sensor_msgs/CompressedImage"});
    subscribe(options_.depth, {"sensor_msgs/Image", "sensor_msgs/CompressedImage"});
    subscribe(options_.cloud, {"sensor_msgs/PointCloud2", "sensor_msgs/LaserScan"});
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
  static constexpr std::chrono::seconds kLate{1};            ///< beyond any latency
  static constexpr std::chrono::milliseconds kAhead{100};    ///< jitter of arrivals

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
      const std::string frame(text_at(message, "header.frame_id"));
      if (view.frame.empty()) view.frame = frame;
      if (!frame.empty() && !same_frame(frame, view.frame)) {
        throw PoseError("topic '" + streams_[i].topic + "': its frame is '" + printable(frame) +
                        "', that of topic '" + streams_.front().topic + "' is '" +
                        printable(view.frame) +
                        "': the depth is of another camera; publish depth that is registered to "
                        "the image");
      }
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
      read_points(message, view);
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
    return lead(message).value_or(ClockOffset{}) > kAhead;
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
    if (std::chrono::steady_clock::now() - last.message.arrival > kLate) {
      why += "; the stream has stopped";
    } else if (ahead && *ahead < -kLate) {
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

}  // namespace detail

RosBridge::RosBridge(const BridgeOptions& options, const std::string& joint_states)
    : robot_(std::make_unique<detail::RosRobot>(options, joint_states)) {}
RosBridge::RosBridge(RosBridge&&) noexcept = default;
RosBridge& RosBridge::operator=(RosBridge&&) noexcept = default;
RosBridge::~RosBridge() = default;

namespace detail {
namespace {

/// Duration for the joint with the longest path, seconds.
[[nodiscard]] double motion_time(const JointTarget& target, const MeasuredJoints& now,
                                 const RosArmOptions& options) {
  double time = options.duration;
  for (std::size_t i = 0; i < target.names.size(); ++i) {
    const auto from = now.position(target.names[i]);
    if (!from) continue;
    const auto own = options.speeds.find(target.names[i]);
    const double speed = own == options.speeds.end() ? options.speed : own->second;
    time = std::max(time, std::abs(target.positions[i] - *from) / (speed * target.velocity_factor));
  }
  return time;
}

/// The goal of FollowJointTrajectory: one point; joints without a target stay.
[[nodiscard]] MessageFields trajectory_goal(const JointController& controller,
                                            const MeasuredJoints& target, double time) {
  std::vector<double> positions;
  for (const std::string& joint : controller.joints) {
    positions.push_back(target.position(joint).value());
  }
  const std::vector<double> zeros(positions.size(), 0.0);
  const auto duration = std::chrono::duration_cast<Stamp>(std::chrono::duration<double>(time));
  MessageValue::List points;
  points.push_back(MessageValue(fields("positions", numbers(positions), "velocities",
                                       numbers(zeros), "time_from_start", time_fields(duration))));
  return fields("trajectory", fields("joint_names", texts(controller.joints), "points", points));
}

}  // namespace
}  // namespace detail

RosArm::RosArm(RosBridge& bridge, const RosArmOptions& options)
    : robot_(&bridge.robot()), options_(options) {
  for (const JointController& controller : options_.controllers) {
    actions_.emplace_back(
        robot_->bridge, controller.action,
        detail::ActionKind{"control_msgs/FollowJointTrajectory", detail::ros1_trajectory()});
  }
}
RosArm::RosArm(RosArm&&) noexcept = default;
RosArm& RosArm::operator=(RosArm&&) noexcept = default;
RosArm::~RosArm() = default;

void RosArm::move(const JointTarget& target) {
  if (target.names.size() != target.positions.size()) {
    throw std::invalid_argument("a target has " + std::to_string(target.names.size()) +
                                " joints and " + std::to_string(target.positions.size()) +
                                " positions");
  }
  if (!(target.velocity_factor > 0.0 && target.velocity_factor <= 1.0)) {
    throw std::invalid_argument("velocity factor must be in (0, 1], is " +
                                std::to_string(target.velocity_factor));
  }
  const MeasuredJoints now = next_joints(Stamp::min());
  const MeasuredJoints wanted{now.stamp, target.names, target.positions};
  bool moves = false;
  for (std::size_t i = 0; i < actions_.size(); ++i) {
    const JointController& controller = options_.controllers[i];
    MeasuredJoints all{now.stamp, controller.joints, {}};
    JointTarget own{{}, {}, target.velocity_factor};
    for (const std::string& joint : controller.joints) {
      const auto position = wanted.position(joint);
      all.positions.push_back(position ? *position : now.position(joint).value());
      if (!position) continue;
      own.names.push_back(joint);
      own.positions.push_back(*position);
    }
    if (own.names.empty()) continue;
    moves = true;
    actions_[i].start(
        detail::trajectory_goal(controller, all, detail::motion_time(own, now, options_)),
        now.stamp);
  }
  if (!moves) throw PoseError("no controller moves any of the joints of this pose");
}

MeasuredJoints RosArm::next_joints(Stamp after) {
  for (detail::RosAction& action : actions_) {
    if (action.is_running()) (void)action.succeeded(std::chrono::steady_clock::now());
  }
  std::vector<std::string> needed = options_.measured;
  for (const JointController& controller : options_.controllers) {
    needed.insert(needed.end(), controller.joints.begin(), controller.joints.end());
  }
  return robot_->next(after, needed);
}

std::string robot_description(const BridgeOptions& options) {
  const std::string name = "/robot_description";
  detail::BridgeClient bridge(options);
  if (auto urdf = bridge.parameter(name, bridge.deadline())) return *std::move(urdf);
  bridge.subscribe(name, {"std_msgs/String"}, 1);
  const auto messages = bridge.take(name, bridge.deadline());
  if (!messages.empty()) return std::string(detail::text_at(messages.back().fields(), "data"));
  throw ConnectionError("bridge '" + options.url + "': it has no URDF: no parameter '" + name +
                        "', and " + bridge.why_silent(name));
}

RosCamera::RosCamera(RosBridge& bridge, const RosCameraOptions& options)
    : streams_(std::make_unique<detail::ViewStreams>(bridge.robot(), options)) {}
RosCamera::RosCamera(RosCamera&&) noexcept = default;
RosCamera& RosCamera::operator=(RosCamera&&) noexcept = default;
RosCamera::~RosCamera() = default;

View RosCamera::next_view(Stamp after) {
  return streams_->next(after);
}

RosLamp::RosLamp(RosBridge& bridge, const std::string& action)
    : robot_(&bridge.robot()),
      action_(std::make_unique<detail::RosAction>(
          robot_->bridge, action,
          detail::ActionKind{"robot_calibration_msgs/GripperLedCommand", "uint8 led_code\n"})) {}
RosLamp::RosLamp(RosLamp&&) noexcept = default;
RosLamp& RosLamp::operator=(RosLamp&&) noexcept = default;
RosLamp::~RosLamp() = default;

Stamp RosLamp::light(int code) {
  constexpr int kMost = 255;
  if (code < 0 || code > kMost) {
    throw std::invalid_argument("an LED code is 0 to 255, is " + std::to_string(code));
  }
  const Stamp now = robot_->newest() ? *robot_->newest() : robot_->now();
  action_->start(detail::fields("led_code", std::uint64_t(code)), now);
  if (!action_->succeeded(robot_->bridge.deadline())) {
    throw PoseError("the LEDs did not switch in time: their action has not ended");
  }
  return robot_->now();
}

}  // namespace kinecal
