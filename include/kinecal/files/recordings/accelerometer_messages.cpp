// Definitions of accelerometer_messages.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/files/recordings/accelerometer_messages.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <optional>
#include <utility>

#include "kinecal/capture/session/settling.hpp"
#include "kinecal/files/messages/message_fields.hpp"
#include "kinecal/files/recordings/message_decoder.ipp"
#include "kinecal/files/recordings/read_bag.hpp"
#include "kinecal/geometry/median.hpp"
#include "kinecal/geometry/rotation.hpp"
#include "kinecal/text/counted.hpp"

namespace kinecal {

namespace detail {
namespace {

/// A time in which joints are still, and their positions.
struct Rest {
  Stamp begin = {}, end = {};
  std::map<std::string, double> joints = {};  ///< radians or metres
};

/// When the joints of one list of names are still.
class RestsOfJoints {
 public:
  void add(MeasuredJoints reading) {
    const Stamp stamp = reading.stamp;
    ++readings_;
    try {
      rest_.add(std::move(reading));
    } catch (const PoseError&) {  // its stamp is that of another one, or it is not a number
      return;
    }
    if (!rest_.still()) return;
    const Stamp begin = stamp - options_.window;
    if (rests_.empty() || begin > rests_.back().end) {
      const MeasuredJoints mean = rest_.mean();
      rests_.push_back({begin, stamp});
      for (std::size_t i = 0; i < mean.names.size(); ++i)
        rests_.back().joints[mean.names[i]] = mean.positions[i];
    }
    rests_.back().end = stamp;
  }
  [[nodiscard]] const std::vector<Rest>& rests() const { return rests_; }
  /// Too few readings show no rest: a message that is published once.
  [[nodiscard]] bool is_too_short() const {
    constexpr int kFewest = 4;
    return readings_ < kFewest;
  }

 private:
  SettleOptions options_;
  JointRest rest_{options_};
  std::vector<Rest> rests_;
  int readings_ = 0;
};

/// Times in which both are still, with the joints of both; those of the first count.
[[nodiscard]] std::vector<Rest> both(const std::vector<Rest>& a, const std::vector<Rest>& b) {
  std::vector<Rest> all;
  for (std::size_t i = 0, j = 0; i < a.size() && j < b.size();) {
    Rest rest{std::max(a[i].begin, b[j].begin), std::min(a[i].end, b[j].end), a[i].joints};
    rest.joints.insert(b[j].joints.begin(), b[j].joints.end());
    if (rest.begin < rest.end) all.push_back(std::move(rest));
    a[i].end < b[j].end ? ++i : ++j;
  }
  return all;
}

/// A reading of an IMU.
struct ImuReading {
  Stamp stamp = {};
  Vector3<double> acceleration, rate;  ///< m/s^2, rad/s
};

/// Readings of one IMU.
struct ImuReadings {
  std::string frame = {};
  std::vector<ImuReading> readings = {};  ///< sorted by stamp

  /// The mean in a time without its ends; nullopt if there are too few.
  [[nodiscard]] std::optional<Vector3<double>> mean(const Rest& rest) const {
    constexpr std::chrono::milliseconds kEnd{100};
    constexpr std::ptrdiff_t kFewest = 5;
    const auto first = from(rest.begin + kEnd), last = from(rest.end - kEnd);
    if (last - first < kFewest) return std::nullopt;
    Vector3<double> sum = Vector3<double>::Zero();
    for (auto at = first; at != last; ++at) sum += at->acceleration;
    return Vector3<double>(sum / static_cast<double>(last - first));
  }
  /// How it turned from a rest to the next by its gyroscope; nullopt if readings are missing.
  /// @returns  (3) rotation vector in its axes at the first rest
  [[nodiscard]] std::optional<Vector3<double>> turn(const Rest& before, const Rest& now) const {
    constexpr double kGap = 0.2;  // seconds
    const auto first = from(before.end), last = from(now.begin);
    if (last - first < 2) return std::nullopt;
    Matrix3<double> rotation = Matrix3<double>::Identity();
    for (auto at = first; at + 1 != last; ++at) {
      const double time = std::chrono::duration<double>((at + 1)->stamp - at->stamp).count();
      if (time > kGap) return std::nullopt;
      rotation = Matrix3<double>(rotation *
                                 exp(Vector3<double>(0.5 * time * (at->rate + (at + 1)->rate))));
    }
    return log(rotation);
  }

 private:
  [[nodiscard]] std::vector<ImuReading>::const_iterator from(Stamp stamp) const {
    return std::lower_bound(
        readings.begin(), readings.end(), stamp,
        [](const ImuReading& reading, Stamp moment) { return reading.stamp < moment; });
  }
};

/// The joints and accelerometers of a bag.
class GravityMessages {
 public:
  GravityMessages(std::string path, Diagnostics& diagnostics)
      : path_(std::move(path)), diagnostics_(diagnostics), decoder_(path_, diagnostics) {}

  void read() {
    const auto wants = [](const BagTopic& topic) {
      return topic.type == "sensor_msgs/JointState" || topic.type == "sensor_msgs/Imu";
    };
    const auto handle = [&](const BagMessage& message) {
      const auto content = decoder_.decode(message, ++number_);
      if (!content) return;
      const Stamp stamp = header_stamp(*content);
      message.topic.type == "sensor_msgs/Imu" ? take_reading(message.topic.name, stamp, *content)
                                              : take_joints(stamp, *content);
    };
    read_bag(path_, {wants, handle}, diagnostics_);
    for (auto& [topic, imu] : imus_) {
      std::stable_sort(imu.readings.begin(), imu.readings.end(),
                       [](const ImuReading& a, const ImuReading& b) { return a.stamp < b.stamp; });
    }
  }
  [[nodiscard]] std::vector<Sample> samples() const {
    const std::vector<Rest> rests = still();
    const std::string topic = chosen(rests);
    if (topic.empty()) {
      diagnostics_.error(
          {path_, 0},
          rests.empty()
              ? fmt::format(
                    "its joints{} never stand still: to read gravity, let the arm rest for a "
                    "second in each of some ten poses",
                    restless())
              : "no accelerometer (sensor_msgs/Imu) is read while its joints stand still; do the "
                "stamps of both have one clock?");
      return {};
    }
    const ImuReadings& imu = imus_.at(topic);
    std::vector<Sample> all;
    const Rest* last = nullptr;
    for (const Rest& rest : rests) {
      const auto mean = imu.mean(rest);
      if (!mean) continue;
      const auto turn = last == nullptr ? std::nullopt : imu.turn(*last, rest);
      last = &rest;
      Sample& sample = all.emplace_back();
      sample.stamp = rest.begin;
      sample.source = fmt::format("{}:{}", path_, all.size());
      for (const auto& [joint, position] : rest.joints) {
        sample.joint_names.push_back(joint);
        sample.joint_positions.push_back(position);
      }
      sample.conditions = {{"ax", mean->x()}, {"ay", mean->y()}, {"az", mean->z()}};
      if (turn) {
        sample.conditions.insert(
            {{"turned_a", turn->x()}, {"turned_b", turn->y()}, {"turned_c", turn->z()}});
      }
      Feature axes;
      axes.frame = imu.frame;
      axes.rotation = Matrix3<double>::Identity();
      sample.observations = {{kAccelerometer, {axes}, {}}};
    }
    doubt_unit(all, topic);
    diagnostics_.note({path_, 0}, fmt::format("gravity, read by the accelerometer of '{}' at {}",
                                              topic, counted(all.size(), "rest")));
    return all;
  }

 private:
  void take_joints(Stamp stamp, const MessageFields& content) {
    MeasuredJoints reading;
    reading.stamp = stamp;
    for (const MessageValue& name : list_at(content, "name")) {
      if (const auto* text = name.as<std::string_view>()) reading.names.emplace_back(*text);
    }
    for (const MessageValue& position : list_at(content, "position")) {
      position.visit_number([&](auto x) { reading.positions.push_back(static_cast<double>(x)); });
    }
    if (reading.names.empty() || reading.positions.size() != reading.names.size()) return;
    const std::vector<std::string> names = reading.names;
    joints_[names].add(std::move(reading));
  }
  void take_reading(const std::string& topic, Stamp stamp, const MessageFields& content) {
    const Vector3<double> a(number_at(content, "linear_acceleration.x"),
                            number_at(content, "linear_acceleration.y"),
                            number_at(content, "linear_acceleration.z"));
    ImuReadings& imu = imus_[topic];
    if (imu.frame.empty()) imu.frame = text_at(content, "header.frame_id");
    if (imu.frame.empty()) imu.frame = kAccelerometer;
    const Vector3<double> rate(number_at(content, "angular_velocity.x"),
                               number_at(content, "angular_velocity.y"),
                               number_at(content, "angular_velocity.z"));
    if (a.allFinite() && rate.allFinite()) imu.readings.push_back({stamp, a, rate});
  }
  /// When all joints are still.
  [[nodiscard]] std::vector<Rest> still() const {
    std::optional<std::vector<Rest>> rests;
    for (const auto& [names, of] : joints_) {
      if (of.is_too_short()) continue;
      rests = rests ? both(*rests, of.rests()) : of.rests();
    }
    return rests.value_or(std::vector<Rest>());
  }
  /// " ('pan', ...)": the first list of joints that never stands still; empty: each does.
  [[nodiscard]] std::string restless() const {
    for (const auto& [names, of] : joints_) {
      if (of.is_too_short() || !of.rests().empty()) continue;
      return fmt::format(" ('{}'{})", names.front(), names.size() > 1 ? ", ..." : "");
    }
    return "";
  }
  /// The topic whose readings at rest scatter most; empty: there are none.
  [[nodiscard]] std::string chosen(const std::vector<Rest>& rests) const {
    std::string best;
    double most = -1.0;
    for (const auto& [topic, imu] : imus_) {
      Vector3<double> sum = Vector3<double>::Zero();
      double squares = 0.0, count = 0.0;
      for (const Rest& rest : rests) {
        const auto mean = imu.mean(rest);
        if (!mean) continue;
        sum += *mean;
        squares += mean->squaredNorm();
        count += 1.0;
      }
      if (count == 0.0) continue;
      const double scatter = squares / count - (sum / count).squaredNorm();
      if (scatter > most) most = scatter, best = topic;
    }
    for (const auto& [topic, imu] : imus_) {
      if (topic == best || best.empty()) continue;
      diagnostics_.note({path_, 0}, fmt::format("of the topics of sensor_msgs/Imu, '{}' is used, "
                                                "which turns most, not '{}'",
                                                best, topic));
    }
    return best;
  }
  void doubt_unit(const std::vector<Sample>& samples, const std::string& topic) const {
    std::vector<double> strengths;
    for (const Sample& sample : samples) {
      const auto& c = sample.conditions;
      strengths.push_back(std::hypot(c.at("ax"), c.at("ay"), c.at("az")));
    }
    constexpr double kLeast = 9.3, kMost = 10.3, kNone = 0.5, kOneG = 1.2;  // m/s^2
    const double typical = median_of(std::move(strengths));
    if (typical > kLeast && typical < kMost) return;
    diagnostics_.doubt({path_, 0},
                       fmt::format("'{}' reads {:.3g} m/s^2 at rest, not 9.81{}", topic, typical,
                                   typical < kNone   ? ": its driver takes gravity off"
                                   : typical < kOneG ? ": in g?"
                                                     : ": its scale is wrong?"));
  }

  std::string path_;
  Diagnostics& diagnostics_;
  MessageDecoder decoder_;
  int number_ = 0;
  std::map<std::vector<std::string>, RestsOfJoints> joints_;  ///< by their names
  std::map<std::string, ImuReadings> imus_;                   ///< by topic
};

}  // namespace
}  // namespace detail

std::vector<Sample> read_gravity(const std::string& path, Diagnostics& diagnostics) {
  detail::GravityMessages messages(path, diagnostics);
  messages.read();
  return messages.samples();
}

}  // namespace kinecal
