// Names of what a base's drive has: definitions of base_conditions.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/files/recordings/base_conditions.hpp"

#include <algorithm>
#include <cctype>
#include <initializer_list>
#include <vector>

namespace kinecal {

namespace detail {
namespace {

/// The words of a name, small letters: "leftWheel_pos" is left wheel pos.
class NameWords {
 public:
  explicit NameWords(std::string_view name) {
    bool was_small = false, is_inside = false;
    for (const char c : name) {
      const auto u = static_cast<unsigned char>(c);
      const bool is_letter = std::isalpha(u) != 0;
      if (is_letter && (!is_inside || (was_small && std::isupper(u) != 0))) words_.emplace_back();
      if (is_letter) {
        words_.back() += static_cast<char>(std::tolower(u));
        all_ += words_.back().back();
      }
      is_inside = is_letter;
      was_small = std::islower(u) != 0;
    }
  }
  [[nodiscard]] bool empty() const { return words_.empty(); }
  /// One of the words.
  [[nodiscard]] bool has(std::initializer_list<std::string_view> any) const {
    return std::any_of(words_.begin(), words_.end(), [&](const std::string& word) {
      return std::find(any.begin(), any.end(), word) != any.end();
    });
  }
  /// A long word anywhere, as in "leftwheel".
  [[nodiscard]] bool contains(std::string_view word) const {
    return all_.find(word) != std::string::npos;
  }
  /// Takes words off.
  void take(std::initializer_list<std::string_view> any) {
    std::erase_if(words_, [&](const std::string& word) {
      return std::find(any.begin(), any.end(), word) != any.end();
    });
  }
  /// The word, if it is the only one.
  [[nodiscard]] std::string only() const { return words_.size() == 1 ? words_.front() : ""; }

 private:
  std::vector<std::string> words_;
  std::string all_;  ///< of them, joined
};

/// @param is_wheel  that the name is of a wheel is known
[[nodiscard]] std::string wheel_of(const NameWords& name, bool is_wheel) {
  if (name.contains("caster") || name.contains("castor")) return "";
  const bool left = name.contains("left") || name.has({"l", "fl", "rl", "bl"}),
             right = name.contains("right") || name.has({"r", "fr", "rr", "br"}),
             front = name.contains("front") || name.has({"f", "fl", "fr"}),
             rear = name.contains("rear") || name.contains("back") ||
                    name.has({"rl", "rr", "bl", "br"});
  if (name.contains("steer")) return left || right ? "" : "steering";
  if (!is_wheel || (left && right) || (front && rear)) return "";
  const std::string side = left ? "left_wheel" : right ? "right_wheel" : "";
  if (side.empty()) return "wheel";
  return front ? "front_" + side : rear ? "rear_" + side : side;
}

/// x, y or yaw of what is left of a name; empty if it is something else.
[[nodiscard]] std::string planar(const NameWords& name) {
  const std::string word = name.only();
  if (word == "x" || word == "y") return word;
  return word == "yaw" || word == "theta" || word == "th" || word == "heading" ? "yaw" : "";
}

}  // namespace
}  // namespace detail

std::string wheel_condition(std::string_view joint) {
  const detail::NameWords name(joint);
  return detail::wheel_of(name, name.contains("wheel"));
}

std::string base_condition(std::string_view text) {
  detail::NameWords name(text);
  if (name.empty()) return "";
  if (name.contains("wheel") || name.contains("steer") ||
      name.has({"enc", "encoder", "tick", "ticks"}) || name.only() == "left" ||
      name.only() == "right") {
    return detail::wheel_of(name, true);
  }
  name.take({"rad", "deg", "degrees", "m", "mm", "s"});  // units
  if (const std::string word = name.only();
      word == "time" || word == "t" || word == "stamp" || word == "timestamp" || word == "run") {
    return word == "run" ? word : "time";
  }
  if (name.has({"wall"})) {
    return name.has({"angle", "bearing"})            ? "wall_angle"
           : name.has({"distance", "dist", "range"}) ? "wall_distance"
                                                     : "";
  }
  if (name.has({"gyro", "imu"})) {
    name.take({"gyro", "imu", "angle"});
    const std::string axis = name.only();
    return axis == "yaw" || axis == "z" ? "gyro_yaw" : "";
  }
  const bool is_odometry = name.has({"odom", "odometry"});
  name.take({"odom", "odometry", "track", "tracked", "tracker", "mocap", "scan", "matched", "laser",
             "lidar", "sensor", "truth", "true", "gt", "vicon", "optitrack", "pose", "position"});
  const std::string axis = detail::planar(name);
  if (axis.empty()) return "";
  return (is_odometry ? "odom_" : "track_") + axis;
}

}  // namespace kinecal
