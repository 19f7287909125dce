// Definitions of urdf_units.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/config/doubts/urdf_units.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "kinecal/config/doubts/used_joints.hpp"
#include "kinecal/files/urdf/urdf_places.hpp"

namespace kinecal::detail {

/// A number of a joint's origin, and where it is.
struct SuspectNumber {
  std::string joint;
  SourceLocation place;
  double value = 0.0;
};

[[nodiscard]] inline bool is_multiple(double value, double step) {
  return std::abs(std::remainder(value, step)) <= 1e-6 * step;
}

/// " (and of 3 more joints)"; empty for one.
[[nodiscard]] inline std::string more_joints(std::size_t count) {
  if (count < 2) return "";
  return fmt::format(" (and {} more like it)", count - 1);
}

/// Long origins: millimetres.  Error if there are several or a very long one, else doubt.
inline void check_lengths(const UrdfPlaces& source, const std::vector<const Joint*>& joints,
                          Diagnostics& diagnostics) {
  constexpr double kLong = 20.0, kVeryLong = 100.0, kTiny = 0.005;  // metres
  std::vector<SuspectNumber> long_ones;
  std::size_t nonzero = 0;
  double sum = 0.0;
  for (const Joint* joint : joints) {
    const double length = joint->origin.translation.norm();
    sum += length;
    if (length > 0.0) ++nonzero;
    if (length <= kLong) continue;
    long_ones.push_back({joint->name, source.place_or_joint(joint->name, "origin"), length});
  }
  if (long_ones.empty()) {
    if (nonzero < 2 || sum >= kTiny) return;
    diagnostics.error({source.file(), 0},
                      fmt::format("the origins between base link and models add up to {:.3g} m: "
                                  "are they in kilometres?  Lengths must be in metres",
                                  sum));
    return;
  }
  const SuspectNumber& most = *std::max_element(
      long_ones.begin(), long_ones.end(),
      [](const SuspectNumber& a, const SuspectNumber& b) { return a.value < b.value; });
  const std::string text = fmt::format(
      "origin of joint '{}' is {:.6g} m long{}; is it in millimetres?  Lengths must be in metres",
      most.joint, most.value, more_joints(long_ones.size()));
  if (long_ones.size() > 1 || most.value > kVeryLong) {
    diagnostics.error(most.place, text);
  } else {
    diagnostics.doubt(most.place, text);
  }
}

/// Roll, pitch or yaw beyond a turn: degrees.
inline void check_angles(const UrdfPlaces& source, const std::vector<const Joint*>& joints,
                         Diagnostics& diagnostics) {
  constexpr double kTurn = 2 * std::numbers::pi + 0.01;  // rounded in many files
  std::vector<SuspectNumber> large;
  bool are_whole = true;
  for (const Joint* joint : joints) {
    Diagnostics checked_before;
    double most = 0.0;
    for (const double angle : source.numbers(joint->name, "origin", "rpy", 3, checked_before)) {
      most = std::max(most, std::abs(angle));
    }
    if (most <= kTurn) continue;
    are_whole = are_whole && is_multiple(most, 0.5);
    large.push_back({joint->name, source.place(joint->name, "origin"), most});
  }
  if (large.empty()) return;
  const std::string text = fmt::format(
      "rpy of joint '{}' has the angle {:.6g}{}; is it in degrees?  Angles must be in "
      "radians",
      large[0].joint, large[0].value, more_joints(large.size()));
  if (are_whole || large.size() > 1) {
    diagnostics.error(large[0].place, text);
  } else {
    diagnostics.doubt(large[0].place, text);
  }
}

/// Limits such as ±180 of rotating joints: degrees.  1e2, 1e3, … stand for no limit.
inline void check_limits(const UrdfPlaces& source, const std::vector<const Joint*>& joints,
                         Diagnostics& diagnostics) {
  std::vector<SuspectNumber> large;
  std::size_t limited = 0;
  for (const Joint* joint : joints) {
    if (joint->type != JointType::revolute || !joint->limits) continue;
    ++limited;
    const double most = std::max(std::abs(joint->limits->lower), std::abs(joint->limits->upper));
    const bool no_limit = is_multiple(std::log10(std::max(most, 1.0)), 1.0);
    if (most < 30.0 || most > 1000.0 || !is_multiple(most, 0.5) || no_limit) continue;
    large.push_back({joint->name, source.place_or_joint(joint->name, "limit"), most});
  }
  if (large.empty() || 2 * large.size() < limited) return;
  diagnostics.doubt(
      large[0].place,
      fmt::format(
          "limit of joint '{}' is {:.6g} rad{}; is it in degrees?  Then look at the origins "
          "and the recorded positions as well: all angles must be in radians",
          large[0].joint, large[0].value, more_joints(large.size())));
}

/// Reversed limits.
inline void check_order_of_limits(const UrdfPlaces& source, const std::vector<const Joint*>& joints,
                                  Diagnostics& diagnostics) {
  for (const Joint* joint : joints) {
    if (!joint->limits || !(joint->limits->lower > joint->limits->upper)) continue;
    diagnostics.warning(
        source.place(joint->name, "limit"),
        fmt::format("the limits of joint '{}' are not used: lower {:.6g} is above upper {:.6g}; "
                    "are they exchanged?",
                    joint->name, joint->limits->lower, joint->limits->upper));
  }
}

void check_urdf_units(const Config& config, const Robot& robot, const std::string& text,
                      const std::string& name_for_messages, Diagnostics& diagnostics) {
  const UrdfPlaces source(text, name_for_messages);
  const std::vector<const Joint*> joints = joints_between(config, robot);
  check_lengths(source, joints, diagnostics);
  check_angles(source, joints, diagnostics);
  check_limits(source, joints, diagnostics);
  check_order_of_limits(source, joints, diagnostics);
}

}  // namespace kinecal::detail
