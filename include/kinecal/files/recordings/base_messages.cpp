// Reading the drive of a mobile base.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/files/recordings/base_messages.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <limits>
#include <map>
#include <numbers>
#include <optional>
#include <stdexcept>
#include <utility>

#include "kinecal/capture/finders/wall_in_scan.hpp"
#include "kinecal/files/messages/message_fields.hpp"
#include "kinecal/files/messages/scan_message.hpp"
#include "kinecal/files/recordings/bag_topics.hpp"
#include "kinecal/files/recordings/base_conditions.hpp"
#include "kinecal/files/recordings/fixed_frames.hpp"
#include "kinecal/files/recordings/message_decoder.ipp"
#include "kinecal/files/recordings/read_bag.hpp"
#include "kinecal/geometry/median.hpp"
#include "kinecal/text/counted.hpp"

namespace kinecal {

namespace detail {
namespace {

constexpr double kMissing = std::numeric_limits<double>::quiet_NaN();

/// Seconds between messages beyond which nothing says what happened between them.
constexpr double kSilence = 0.5;

/// Numbers over time.
template <std::size_t N>
class Track {
 public:
  using Numbers = std::array<double, N>;

  /// A message that is not later than the one before is skipped.
  void add(double time, const Numbers& numbers) {
    if (!times_.empty() && !(time > times_.back())) return;
    times_.push_back(time);
    numbers_.push_back(numbers);
  }
  [[nodiscard]] bool empty() const { return times_.empty(); }
  [[nodiscard]] const Numbers& last() const { return numbers_.back(); }
  [[nodiscard]] double last_time() const { return times_.back(); }
  [[nodiscard]] const std::vector<double>& times() const { return times_; }  ///< seconds
  /// Interpolated; nullopt outside, or where messages are more than half a second apart.
  [[nodiscard]] std::optional<Numbers> at(double time) const {
    const auto after = std::lower_bound(times_.begin(), times_.end(), time);
    if (after == times_.end()) return std::nullopt;
    const auto i = static_cast<std::size_t>(after - times_.begin());
    if (times_[i] == time) return numbers_[i];
    if (i == 0 || times_[i] - times_[i - 1] > kSilence) return std::nullopt;
    const double part = (time - times_[i - 1]) / (times_[i] - times_[i - 1]);
    Numbers between;
    for (std::size_t k = 0; k < N; ++k) {
      between[k] = (1.0 - part) * numbers_[i - 1][k] + part * numbers_[i][k];
    }
    return between;
  }

 private:
  std::vector<double> times_;  ///< seconds
  std::vector<Numbers> numbers_;
};

/// The angle about z of a rotation, radians; not a number for a quaternion without a length, which trackers write that lost it.
/// @param path  of a quaternion
[[nodiscard]] double yaw_at(const MessageFields& message, const std::string& path) {
  const double x = number_at(message, path + ".x"), y = number_at(message, path + ".y"),
               z = number_at(message, path + ".z"), w = number_at(message, path + ".w");
  if (!(x * x + y * y + z * z + w * w > 0.0)) return kMissing;
  return std::atan2(2.0 * (w * z + x * y), w * w + x * x - y * y - z * z);
}

/// The angle near another one that differs from it by full turns, radians.
[[nodiscard]] double unwrapped(double angle, double near) {
  return near + std::remainder(angle - near, 2.0 * std::numbers::pi);
}

/// What a scan shows.
struct SeenWall {
  double time = 0.0;  ///< seconds
  double angle = kMissing, distance = kMissing;
};

/// Collects the messages of a drive.
class BaseMessages {
 public:
  BaseMessages(std::string path, Diagnostics& diagnostics)
      : path_(std::move(path)), diagnostics_(diagnostics), decoder_(path_, diagnostics) {}

  /// Reads the bag.
  void read() {
    choose_topics();
    const auto wants = [&](const BagTopic& topic) {
      const auto chosen = topics_.find(kind_of(topic.type));
      if (use_of(topic) == TopicUse::urdf) return true;
      return chosen != topics_.end() && chosen->second == topic.name;
    };
    const auto handle = [&](const BagMessage& message) {
      if (const auto content = decoder_.decode(message, ++number_)) take(message, *content);
    };
    read_bag(path_, {wants, handle}, diagnostics_);
  }
  [[nodiscard]] BaseDrive drive() { return {samples(), base_, scanner_, urdf_}; }

 private:
  [[nodiscard]] std::vector<Sample> samples() {
    const bool says = !odom_.empty() || !gyro_.empty() || !wheels_.empty();
    if (!says || (walls_.empty() && tracked_.empty())) {
      diagnostics_.error({path_, 0}, says
                                         ? "the drive of a base takes scans of a wall "
                                           "(sensor_msgs/LaserScan) or a tracked pose "
                                           "(geometry_msgs/PoseStamped): neither is in this bag"
                                         : "the drive of a base takes nav_msgs/Odometry, "
                                           "sensor_msgs/Imu or joint states of its wheels: none of "
                                           "them is in this bag; samples of a laser on a robot are "
                                           "made by 'kinecal detect'");
      return {};
    }
    say_doubts();
    return thinned(all_samples());
  }

  /// Both types of a pose are one: what tracks the base is one topic.
  [[nodiscard]] static std::string kind_of(const std::string& type) {
    return type == "geometry_msgs/PoseWithCovarianceStamped" ? "geometry_msgs/PoseStamped" : type;
  }
  /// Of several topics of a kind, the one with upstream's name, else that with most messages.
  void choose_topics() {
    const std::map<std::string, std::vector<std::string>> usual{
        {"nav_msgs/Odometry", {"odom"}},
        {"sensor_msgs/Imu", {"imu", "imu1/imu", "imu/data"}},
        {"sensor_msgs/LaserScan", {"base_scan", "scan"}},
        {"sensor_msgs/JointState", {"joint_states"}},
        {"geometry_msgs/PoseStamped", {}}};
    std::map<std::string, std::vector<std::string>> names;  // by kind
    std::vector<TopicContent> topics = bag_topics(path_, diagnostics_);
    std::stable_sort(topics.begin(), topics.end(),
                     [](const auto& a, const auto& b) { return a.messages > b.messages; });
    for (const TopicContent& topic : topics) {
      const std::string kind = kind_of(topic.type);
      if (usual.contains(kind) && topic.messages > 0) names[kind].push_back(topic.name);
    }
    for (auto& [type, of_type] : names) {
      topics_[type] = chosen_topic(std::move(of_type), usual.at(type), type, path_, diagnostics_);
    }
  }

  void take(const BagMessage& message, const MessageFields& content) {
    const std::string& type = message.topic.type;
    if (use_of(message.topic) == TopicUse::urdf) {
      urdf_ = text_at(content, "data");
      return;
    }
    const double time =
        std::chrono::duration<double>(header_stamp(content) - start_of(content)).count();
    late_[message.topic.name].push_back(
        1e-9 * static_cast<double>(message.time - header_stamp(content).count()));
    if (type == "nav_msgs/Odometry") {
      take_pose(odom_, time, content, "pose.pose");
      base_ = text_at(content, "child_frame_id");
    } else if (type == "sensor_msgs/Imu") {
      take_rate(time, number_at(content, "angular_velocity.z"));
    } else if (type == "sensor_msgs/LaserScan") {
      take_scan(time, content);
    } else if (type == "sensor_msgs/JointState") {
      take_wheels(time, content);
    } else {
      take_pose(tracked_, time, content,
                type == "geometry_msgs/PoseStamped" ? "pose" : "pose.pose");
    }
  }
  /// The first stamp, from which times count: doubles then resolve microseconds.
  [[nodiscard]] Stamp start_of(const MessageFields& content) {
    if (!start_) start_ = header_stamp(content);
    return *start_;
  }
  /// @param path  of the pose
  void take_pose(Track<3>& track, double time, const MessageFields& content,
                 const std::string& path) {
    const double x = number_at(content, path + ".position.x"),
                 y = number_at(content, path + ".position.y"),
                 yaw = yaw_at(content, path + ".orientation");
    if (!std::isfinite(x + y + yaw)) {
      ++without_numbers_;
      return;
    }
    track.add(time, {x, y, track.empty() ? yaw : unwrapped(yaw, track.last()[2])});
  }
  void take_rate(double time, double rate) {
    if (!std::isfinite(rate)) {
      ++without_numbers_;
      return;
    }
    double angle = 0.0;
    if (!gyro_.empty()) {
      const double step = time - gyro_.last_time();
      if (!(step > 0.0)) return;
      angle = gyro_.last()[0];
      if (step > kSilence) {
        gyro_gaps_.push_back(time);
      } else {
        angle += 0.5 * (rate + rate_) * step;
      }
    }
    gyro_.add(time, {angle});
    rate_ = rate;
  }
  /// True if the rate of the gyroscope is not known all the time from one sample to the next.
  [[nodiscard]] bool lacks_rates(const Sample& from, const Sample& to) const {
    const auto gap =
        std::upper_bound(gyro_gaps_.begin(), gyro_gaps_.end(), from.conditions.at("time"));
    return gap != gyro_gaps_.end() && *gap <= to.conditions.at("time");
  }
  void take_scan(double time, const MessageFields& content) {
    scanner_ = text_at(content, "header.frame_id");
    FoundWall found;
    try {
      const LaserScan scan = scan_of(content);
      found = wall_in_scan(scan.view());
    } catch (const std::runtime_error& error) {
      found.refusal = error.what();
    }
    walls_.push_back({time});
    if (found.wall) {
      walls_.back() = {time, found.wall->angle, found.wall->distance};
    } else if (without_wall_++ == 0) {
      refusal_ = found.refusal;
    }
  }
  void take_wheels(double time, const MessageFields& content) {
    const MessageValue::List &names = list_at(content, "name"),
                             &positions = list_at(content, "position");
    for (std::size_t i = 0; i < std::min(names.size(), positions.size()); ++i) {
      const auto* name = names[i].as<std::string_view>();
      const std::string wheel = name == nullptr ? "" : wheel_condition(*name);
      if (wheel.empty()) continue;
      positions[i].visit_number([&](auto x) {
        const auto position = static_cast<double>(x);
        if (std::isfinite(position)) wheels_[wheel].add(time, {position});
      });
    }
  }

  /// A scanner that hangs upside down turns the other way.
  [[nodiscard]] bool is_upside_down() const {
    const std::optional<Pose<double>> pose =
        recorded_frames(path_).pose(base_.empty() ? "base_link" : base_, scanner_);
    return pose && pose->rotation(2, 2) < 0.0;
  }
  void say_doubts() {
    constexpr double kLate = 0.2;  // seconds
    std::string earliest, latest;
    double least = std::numeric_limits<double>::infinity(), most = -least;
    for (auto& [topic, late] : late_) {
      const double typical = median_of(std::move(late));
      if (typical < least) least = typical, earliest = topic;
      if (typical > most) most = typical, latest = topic;
    }
    if (most - least > kLate) {
      diagnostics_.doubt({path_, 0},
                         fmt::format("stamps of '{}' are {:.2f} s earlier than those of '{}', "
                                     "compared with the time of recording: two clocks?",
                                     latest, most - least, earliest));
    }
    if (without_numbers_ > 0) {
      diagnostics_.note({path_, 0},
                        fmt::format("{} left out whose pose or rate is not a number, or whose "
                                    "quaternion has no length",
                                    counted(without_numbers_, "message")));
    }
    if (!gyro_gaps_.empty()) {
      diagnostics_.note(
          {path_, 0}, fmt::format("the gyroscope says nothing for more than {} s {}; a run begins "
                                  "after that",
                                  kSilence, counted(gyro_gaps_.size(), "time")));
    }
    if (without_wall_ > 0) {
      diagnostics_.note({path_, 0}, fmt::format("{} of {} scans show no wall; the first: {}",
                                                without_wall_, walls_.size(), refusal_));
    }
  }

  [[nodiscard]] std::vector<Sample> all_samples() {
    const double side = !walls_.empty() && is_upside_down() ? -1.0 : 1.0;
    std::vector<Sample> samples;
    const auto add = [&](double time) -> Sample& {
      Sample& sample = samples.emplace_back();
      sample.stamp = *start_ + std::chrono::nanoseconds(std::llround(1e9 * time));
      sample.source = fmt::format("{}:{}", path_, samples.size());
      sample.conditions["time"] = time;
      const auto set = [&](const auto& track, std::vector<const char*> names) {
        if (track.empty()) return;
        const auto at = track.at(time);
        for (std::size_t k = 0; k < names.size(); ++k) {
          sample.conditions[names[k]] = at ? (*at)[k] : kMissing;
        }
      };
      set(odom_, {"odom_x", "odom_y", "odom_yaw"});
      set(gyro_, {"gyro_yaw"});
      for (const auto& [wheel, track] : wheels_) set(track, {wheel.c_str()});
      for (const std::string wheel : {"left_wheel", "right_wheel"}) {  // of four wheels
        const auto front = sample.conditions.find("front_" + wheel),
                   rear = sample.conditions.find("rear_" + wheel);
        if (front == sample.conditions.end() || rear == sample.conditions.end()) continue;
        sample.conditions.emplace(wheel, 0.5 * (front->second + rear->second));
      }
      set(tracked_, {"track_x", "track_y", "track_yaw"});
      return sample;
    };
    for (const SeenWall& wall : walls_) {
      Sample& sample = add(wall.time);
      sample.conditions["wall_angle"] = side * wall.angle;
      sample.conditions["wall_distance"] = wall.distance;
    }
    for (const double time : walls_.empty() ? tracked_.times() : std::vector<double>()) {
      (void)add(time);
    }
    check_gyro(samples);
    return samples;
  }
  /// A gyroscope that turns against the odometry, or about another axis.
  void check_gyro(const std::vector<Sample>& samples) {
    if (odom_.empty() || gyro_.empty()) return;
    double product = 0.0, of_odom = 0.0;
    for (std::size_t i = 1; i < samples.size(); ++i) {
      const auto moved = [&](const char* name) {
        return samples[i].conditions.at(name) - samples[i - 1].conditions.at(name);
      };
      const double odom = moved("odom_yaw"), gyro = moved("gyro_yaw");
      if (!std::isfinite(odom + gyro) || lacks_rates(samples[i - 1], samples[i])) continue;
      product += odom * gyro;
      of_odom += odom * odom;
    }
    if (!(of_odom > 0.01)) return;
    const double slope = product / of_odom;
    if (slope > 0.5 && slope < 2.0) return;
    diagnostics_.doubt(
        {path_, 0},
        fmt::format("the gyroscope turns by {:.2f} rad about z where the odometry turns by one: {}",
                    slope,
                    slope < -0.5 ? "its z axis points down?" : "its z axis is not vertical?"));
  }

  /// Numbers runs, and leaves out samples that are near to others or stand still.
  [[nodiscard]] std::vector<Sample> thinned(std::vector<Sample> samples) const {
    constexpr double kSpeed = 0.01, kStill = 0.5, kFar = 0.05;  // m/s or rad/s, s, m or rad
    std::vector<std::string> names;
    for (const auto& [wheel, track] : wheels_) names.push_back(wheel);
    if (names.empty()) names = {"gyro_yaw"};
    if (!tracked_.empty()) names = {"track_x", "track_y", "track_yaw"};
    if (!odom_.empty()) names = {"odom_x", "odom_y", "odom_yaw"};
    const auto apart = [&](const Sample& a, const Sample& b) {
      double most = 0.0;
      for (const std::string& name : names) {
        const double by = std::abs(b.conditions.at(name) - a.conditions.at(name));
        if (!std::isfinite(by)) return by;
        most = std::max(most, by);
      }
      return most;
    };
    std::vector<Sample> kept;
    int run = 0;
    double still_since = 0.0;  // of the last sample that moved
    bool moves = false;
    const auto keep = [&](const Sample& sample) {
      kept.push_back(sample);
      kept.back().conditions[kRun] = run;
    };
    for (std::size_t i = 1; i < samples.size(); ++i) {
      const Sample &last = samples[i - 1], &sample = samples[i];
      if (lacks_rates(last, sample)) {  // nothing compares the samples of two runs
        moves = false;
        continue;
      }
      const double time = sample.conditions.at("time"),
                   speed = apart(last, sample) / (time - last.conditions.at("time"));
      if (!std::isfinite(speed)) continue;
      if (speed > kSpeed) {
        if (!moves) ++run, keep(last);
        moves = true;
        still_since = time;
        if (apart(kept.back(), sample) >= kFar) keep(sample);
      } else if (moves && time - still_since >= kStill) {
        keep(sample);
        moves = false;
      }
    }
    return kept;
  }

  std::string path_;
  Diagnostics& diagnostics_;
  MessageDecoder decoder_;
  int number_ = 0;
  std::map<std::string, std::string> topics_;  ///< name of the chosen one, by type
  std::optional<Stamp> start_;
  std::map<std::string, std::vector<double>> late_;  ///< recorded after its stamp, s, by topic
  Track<3> odom_, tracked_;                          ///< x, y, metres, yaw, radians
  Track<1> gyro_;                                    ///< integral of its rate, radians
  std::map<std::string, Track<1>> wheels_;           ///< by condition, radians
  double rate_ = 0.0;                                ///< of the gyroscope, last, rad/s
  std::vector<double> gyro_gaps_;                    ///< when it was read again, seconds
  std::size_t without_numbers_ = 0;                  ///< messages left out
  std::vector<SeenWall> walls_;                      ///< one of each scan
  int without_wall_ = 0;                             ///< scans
  std::string refusal_, base_, scanner_;             ///< of the first of them; frames
  std::string urdf_;
};

}  // namespace
}  // namespace detail

bool shows_base(const BagTopic& topic) {
  return topic.type == "sensor_msgs/LaserScan" || topic.type == "geometry_msgs/PoseStamped" ||
         topic.type == "geometry_msgs/PoseWithCovarianceStamped";
}

BaseDrive read_base_drive(const std::string& path, Diagnostics& diagnostics) {
  detail::BaseMessages messages(path, diagnostics);
  messages.read();
  return messages.drive();
}

}  // namespace kinecal
