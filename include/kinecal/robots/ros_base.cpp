// Definitions of ros_base.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/robots/ros_base.hpp"

#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <thread>
#include <utility>

#include "kinecal/capture/robot_interface.hpp"
#include "kinecal/files/messages/known_definitions.hpp"
#include "kinecal/files/messages/make.hpp"
#include "kinecal/files/messages/message_fields.hpp"
#include "kinecal/geometry/rotation.hpp"
#include "kinecal/robots/bridge_client.hpp"
#include "kinecal/robots/view_ahead.hpp"

namespace kinecal {

using BaseClock = std::chrono::steady_clock;

class RosBase::State {
 public:
  State(const BridgeOptions& options, BaseTopics topics, RecordMessage record)
      : bridge(options), topics_(std::move(topics)), record_(std::move(record)) {
    constexpr std::size_t kKept = 4096;
    bridge.subscribe(topics_.odom, {"nav_msgs/Odometry"}, kKept);
    for (const std::string& scan : topics_.scans) {
      bridge.subscribe(scan, {"sensor_msgs/LaserScan"}, kKept);
    }
    for (const std::string& other : topics_.others) bridge.subscribe(other, {}, kKept);
  }

  detail::BridgeClient bridge;
  std::map<std::string, int> received;
  std::optional<Odometry> odometry;
  std::optional<Ahead> ahead;

  [[nodiscard]] const BaseTopics& topics() const { return topics_; }
  [[nodiscard]] std::string why_nothing_ahead() const { return view_.why_none(frame_); }

  void take_all() {
    take(topics_.odom);
    for (const std::string& scan : topics_.scans) take(scan);
    for (const std::string& other : topics_.others) take(other);
    if (const auto now = view_.ahead(frame_)) ahead = now;
  }

 private:
  void take(const std::string& topic) {
    for (const detail::BridgeMessage& message : bridge.take(topic, BaseClock::now())) {
      const MessageFields fields = message.fields();
      const auto since = std::chrono::system_clock::now().time_since_epoch() -
                         (BaseClock::now() - message.arrival);
      ++received[topic];
      record_(topic, message.type,
              std::chrono::duration_cast<std::chrono::nanoseconds>(since).count(), fields);
      if (message.type == "nav_msgs/Odometry") take_odometry(fields, message.arrival);
      if (message.type == "sensor_msgs/LaserScan") view_.take_scan(topic, fields, message.arrival);
      if (topic == "/tf_static") view_.take_frames(fields);
    }
  }
  void take_odometry(const MessageFields& message, BaseClock::time_point arrival) {
    const auto at = [&](const char* field) {
      return detail::number_at(message, std::string("pose.pose.") + field);
    };
    frame_ = detail::text_at(message, "child_frame_id");
    const Eigen::Vector4d q(at("orientation.x"), at("orientation.y"), at("orientation.z"),
                            at("orientation.w"));
    if (!(q.norm() > 0.5) || !std::isfinite(at("position.x") + at("position.y")))
      return;  // no pose
    const Matrix3<double> turned = rotation_from_quaternion<double>(q.normalized());
    const double yaw = std::atan2(turned(1, 0), turned(0, 0));
    const double before = odometry ? odometry->yaw : yaw;
    odometry = {at("position.x"), at("position.y"),
                before + std::remainder(yaw - before, 2.0 * std::numbers::pi), arrival};
  }

  BaseTopics topics_;
  RecordMessage record_;
  detail::ViewAhead view_;
  std::string frame_;  ///< of the base, by its odometry
};

RosBase::RosBase(const BridgeOptions& options, const BaseTopics& topics, RecordMessage record)
    : state_(std::make_unique<State>(options, topics, std::move(record))) {}
RosBase::RosBase(RosBase&&) noexcept = default;
RosBase& RosBase::operator=(RosBase&&) noexcept = default;
RosBase::~RosBase() = default;

void RosBase::record(std::chrono::milliseconds time) {
  constexpr std::chrono::milliseconds kStep{10};
  for (const auto end = BaseClock::now() + time;;) {
    state_->take_all();
    const auto left = end - BaseClock::now();
    if (left <= BaseClock::duration::zero()) return;
    std::this_thread::sleep_for(std::min<BaseClock::duration>(left, kStep));
  }
}

const std::map<std::string, int>& RosBase::received() const {
  return state_->received;
}
const std::optional<RosBase::Odometry>& RosBase::odometry() const {
  return state_->odometry;
}
const std::optional<RosBase::Ahead>& RosBase::ahead() const {
  return state_->ahead;
}
std::string RosBase::why_nothing_ahead() const {
  return state_->why_nothing_ahead();
}
std::string RosBase::why_no_odometry() const {
  return state_->bridge.why_silent(state_->topics().odom);
}

void RosBase::command(double ahead, double turn) {
  using detail::fields;
  static const detail::PublishedType kTwist{
      "geometry_msgs/Twist", detail::known_definition("geometry_msgs/Twist", Encoding::ros1)};
  state_->bridge.publish(state_->topics().commands, kTwist,
                         fields("linear", fields("x", ahead, "y", 0.0, "z", 0.0), "angular",
                                fields("x", 0.0, "y", 0.0, "z", turn)));
}

void RosBase::stop() noexcept {
  constexpr int kTimes = 5;  // a message may be lost
  try {
    for (int n = 0; n < kTimes; ++n) {
      command(0.0, 0.0);
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
  } catch (...) {  // NOLINT(bugprone-empty-catch): nothing can be sent
  }
}

namespace detail {
namespace {

constexpr std::chrono::milliseconds kCommandPeriod{20};
constexpr double kPeriod = std::chrono::duration<double>(kCommandPeriod).count();  // seconds

/// A turn in place, or a straight run.
struct DrivenRun {
  double ahead = 0.0;   ///< m/s
  double turn = 0.0;    ///< rad/s
  double amount = 0.0;  ///< radians or metres

  [[nodiscard]] double speed() const { return std::abs(turn != 0.0 ? turn : ahead); }
  [[nodiscard]] std::string text() const {
    if (turn != 0.0)
      return fmt::format("a turn to the {} at {:.2f} rad/s", turn > 0 ? "left" : "right", speed());
    return fmt::format("{:.2f} m {} at {:.2f} m/s", amount, ahead > 0 ? "ahead" : "back", speed());
  }
};

/// Stops the base at the end, whatever happens.
struct StopsAtEnd {
  explicit StopsAtEnd(RosBase& stopped) : base(stopped) {}
  StopsAtEnd(const StopsAtEnd&) = delete;
  StopsAtEnd& operator=(const StopsAtEnd&) = delete;
  ~StopsAtEnd() { base.stop(); }
  RosBase& base;
};

class RunDriver {
 public:
  RunDriver(RosBase& base, const BaseDriving& driving, const std::function<bool()>& interrupted)
      : base_(base), driving_(driving), is_interrupted_(interrupted) {}

  /// How far the base went, metres or radians.
  [[nodiscard]] double gone(const DrivenRun& run) const {
    const RosBase::Odometry& now = *base_.odometry();
    return run.turn != 0.0 ? std::abs(now.yaw - start_.yaw)
                           : std::hypot(now.x - start_.x, now.y - start_.y);
  }

  /// @returns  why it ended early; empty if it did not
  [[nodiscard]] std::string drive(const DrivenRun& run) {
    start_ = *base_.odometry();
    const auto began = BaseClock::now();
    const double acceleration =
        run.turn != 0.0 ? driving_.turn_acceleration : driving_.acceleration;
    const double limit = 3.0 * run.amount / run.speed() + 5.0;  // seconds
    double speed = 0.0;
    std::string why;
    while (why.empty()) {
      if (gone(run) >= run.amount - 0.5 * speed * speed / acceleration) break;
      if (run.ahead > 0.0 && base_.ahead()->nearest < driving_.least_range) break;
      speed = std::min(run.speed(), speed + acceleration * kPeriod);
      base_.command(std::copysign(run.ahead == 0.0 ? 0.0 : speed, run.ahead),
                    std::copysign(run.turn == 0.0 ? 0.0 : speed, run.turn));
      base_.record(kCommandPeriod);
      why = why_stop(run);
      if (why.empty() && BaseClock::now() - began > std::chrono::duration<double>(limit)) {
        why = fmt::format(
            "after {:.0f} s, the base has gone {:.2f} of {:.2f} {}: does something else command "
            "it, "
            "or is it locked?",
            limit, gone(run), run.amount, run.turn != 0.0 ? "rad" : "m");
      }
    }
    const std::string later = rest();
    return why.empty() ? later : why;
  }

  /// Commands zero until the base is at rest.
  [[nodiscard]] std::string rest() {
    for (const auto end = BaseClock::now() + driving_.rest; BaseClock::now() < end;) {
      base_.command(0.0, 0.0);
      base_.record(kCommandPeriod);
      if (is_interrupted_()) return "interrupted";
    }
    return "";
  }

 private:
  [[nodiscard]] std::string why_stop(const DrivenRun& run) const {
    if (is_interrupted_()) return "interrupted";
    const auto is_silent = [&](BaseClock::time_point arrival) {
      return BaseClock::now() - arrival > driving_.silence;
    };
    const auto silent = [&](const char* what) {
      return fmt::format("no {} for {} ms: the base was stopped", what, driving_.silence.count());
    };
    if (is_silent(base_.odometry()->arrival)) return silent("odometry");
    if (run.ahead > 0.0 && is_silent(base_.ahead()->arrival)) return silent("scan");
    return "";
  }

  RosBase& base_;
  const BaseDriving& driving_;
  const std::function<bool()>& is_interrupted_;
  RosBase::Odometry start_ = {};
};

/// What drive_base() does, once something could be commanded.
[[nodiscard]] std::string drive_all(RosBase& base, const BaseDriving& driving,
                                    const std::function<bool()>& is_interrupted,
                                    const std::function<void(const std::string&)>& say) {
  RunDriver driver(base, driving, is_interrupted);
  for (const auto end = BaseClock::now() + driving.rest;
       BaseClock::now() < end || !base.odometry();) {
    base.record(kCommandPeriod);
    if (is_interrupted()) return "interrupted";
    if (!base.odometry() && BaseClock::now() > end + driving.silence) return base.why_no_odometry();
  }
  std::vector<DrivenRun> runs;
  for (const double speed : {driving.turn / 3.0, driving.turn}) {
    for (const double turn : {speed, -speed}) runs.push_back({0.0, turn, 2.0 * std::numbers::pi});
  }
  const double room = base.ahead() ? base.ahead()->nearest - driving.least_range : 0.0;
  if (room >= driving.distance && std::isfinite(room)) {
    for (const double speed : {0.5 * driving.speed, driving.speed}) {
      for (const double ahead : {speed, -speed}) runs.push_back({ahead, 0.0, driving.distance});
    }
  } else {
    say(base.ahead()
            ? fmt::format("no straight runs: the nearest ahead is at {:.2f} m, and a run of "
                          "{:.2f} m needs {:.2f} m up to a wall",
                          base.ahead()->nearest, driving.distance,
                          driving.distance + driving.least_range)
            : "no straight runs: " + base.why_nothing_ahead());
  }
  double back = 0.0;  // what a run ahead went: the run back goes no farther
  for (DrivenRun& run : runs) {
    if (run.ahead < 0.0) run.amount = back;
    say(run.text());
    if (std::string why = driver.drive(run); !why.empty()) return why;
    if (run.ahead > 0.0) back = driver.gone(run);
  }
  return "";
}

}  // namespace
}  // namespace detail

std::string drive_base(RosBase& base, const BaseDriving& driving,
                       const std::function<bool()>& is_interrupted,
                       const std::function<void(const std::string&)>& say) {
  for (const double positive : {driving.turn, driving.speed, driving.distance,
                                driving.turn_acceleration, driving.acceleration}) {
    if (!(positive > 0.0)) throw std::invalid_argument("speeds and distances must be positive");
  }
  base.command(0.0, 0.0);  // ROS loses what is published before others know of the publisher
  const detail::StopsAtEnd stops(base);
  try {
    return detail::drive_all(base, driving, is_interrupted, say);
  } catch (const ConnectionError& error) {
    throw ConnectionError(std::string(error.what()) +
                          "; the base may be moving: only its own driver can stop it now");
  }
}

}  // namespace kinecal
