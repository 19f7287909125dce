// Definitions of another_robot.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/tools/identify/another_robot.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "kinecal/text/reading.hpp"
#include "kinecal/tools/identify/candidates.ipp"

namespace kinecal {

namespace detail {
namespace {

/// Errors that no wrong zero or mount leaves.
[[nodiscard]] bool is_too_much(double error, const std::string& unit) {
  constexpr double kMetresLeft = 0.01, kPixelsLeft = 30.0;
  return (unit == "m" && error > kMetresLeft) || (unit == "px" && error > kPixelsLeft);
}

/// "shoulder_lift_joint_z by 24.2 mm, wrist_2_joint_a by 12 deg": of the geometry between joints.
[[nodiscard]] std::string wrong_lengths(const RobotSearch& search) {
  constexpr double kLength = 0.02, kTurned = 10.0 * std::numbers::pi / 180.0;
  std::string text;
  for (const int k : search.found.chosen) {
    const IdentifyCandidate& of = search.task.candidates[static_cast<std::size_t>(k)];
    if (of.rank != kGeometry) continue;
    for (const int p : of.parameters) {
      const Parameter& parameter = search.found.result.table[p];
      const double change = parameter.value - parameter.initial;
      if (!(std::abs(change) >= (parameter.unit == "m" ? kLength : kTurned))) continue;
      text +=
          (text.empty() ? "" : ", ") + parameter.name + " by " + reading(change, parameter.unit);
    }
  }
  return text;
}

}  // namespace
}  // namespace detail

std::string another_robot(const RobotSearch& search) {
  const std::vector<IdentifyStep>& steps = search.found.steps;
  if (!steps.empty() && detail::is_too_much(steps.back().fitted, search.found.unit)) {
    return fmt::format(
        "{} are left whatever is freed: the URDF is that of another robot, or the samples' joints, "
        "frames and features are not what the configuration says",
        reading(steps.back().fitted, search.found.unit));
  }
  const std::string wrong = detail::wrong_lengths(search);
  if (wrong.empty()) return "";
  return "the URDF is that of another robot, or of another version of it: these samples change " +
         wrong + "; give the URDF of this robot, or correct it there";
}

}  // namespace kinecal
