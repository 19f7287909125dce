// Definitions of check_offsets.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/config/doubts/check_offsets.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "kinecal/config/doubts/exchanged_joints.hpp"
#include "kinecal/config/doubts/used_joints.hpp"
#include "kinecal/files/urdf/urdf_places.hpp"

namespace kinecal {

namespace detail {
namespace {

/// "12.3 deg" or "45.6 mm".
[[nodiscard]] std::string offset_text(const Joint& joint, double offset) {
  return turns(joint.type) ? fmt::format("{:.1f} deg", offset * 180.0 / std::numbers::pi)
                           : fmt::format("{:.1f} mm", 1e3 * offset);
}

/// The offset between half a turn and minus half a turn, for rotating joints.
[[nodiscard]] double as_angle(const Joint& joint, double offset) {
  return turns(joint.type) ? std::remainder(offset, 2 * std::numbers::pi) : offset;
}

/// The recorded position furthest outside its limits after the offset.
struct FurthestOutside {
  double position = 0.0;  ///< with the offset
  double excess = 0.0;  ///< 0 if none is further outside than before, by more than offsets explain
};

[[nodiscard]] FurthestOutside furthest_outside(const UsedJoint& joint, double offset) {
  FurthestOutside most;
  for (const double recorded : joint.positions) {
    const double position = recorded + offset, excess = excess_of(joint, position);
    const bool is_driven = excess > excess_of(joint, recorded) && is_outside(joint, position);
    if (is_driven && excess > most.excess) most = {position, excess};
  }
  return most;
}

}  // namespace
}  // namespace detail

void check_offsets(const CalibrationInput& input, const ParameterTable& calibrated,
                   Diagnostics& diagnostics) {
  constexpr double kHalfTurn = 2.8;  // radians: to 20 degrees
  std::optional<detail::UrdfPlaces> source;
  if (!input.urdf_text.empty()) source.emplace(input.urdf_text, input.urdf);
  for (const detail::UsedJoint& used :
       detail::used_joints(input.config, input.robot, input.samples)) {
    const Joint& joint = used.joint;
    const int parameter = calibrated.find(joint.name);
    if (parameter < 0) continue;
    const double offset = detail::as_angle(joint, calibrated[parameter].value);
    const double change =
        detail::as_angle(joint, calibrated[parameter].value - calibrated[parameter].initial);
    SourceLocation place{input.urdf, 0};
    if (source) place = source->place_or_joint(joint.name, "limit");
    const std::string subject =
        fmt::format("the offset of '{}' is {}", joint.name, detail::offset_text(joint, offset));
    const detail::FurthestOutside most = detail::furthest_outside(used, offset);
    const double travel = used.limits ? used.limits->upper - used.limits->lower : HUGE_VAL;
    if (std::abs(offset) > travel) {
      diagnostics.error(place,
                        fmt::format("{}, but the joint can only travel {}; the result cannot "
                                    "be right",
                                    subject, detail::offset_text(joint, travel)));
    } else if (most.excess > 0.0) {
      diagnostics.error(place,
                        fmt::format("{}: with it, the joint was at {:.4g}, but its limits are "
                                    "{}; the result cannot be right",
                                    subject, most.position, used.limits_text()));
    } else if (turns(joint.type) && std::abs(change) > kHalfTurn) {
      diagnostics.error(place, subject +
                                   ", half a turn: this is what the wrong sign of a joint, or a "
                                   "URDF with other zeros, looks like; if it is known to be, "
                                   "give it as an initial value");
    } else if (std::abs(change) > (turns(joint.type) ? 0.35 : 0.1)) {
      diagnostics.doubt(place, subject +
                                   "; zeros of joints are seldom so far off; if it is known to "
                                   "be, give it as an initial value");
    }
  }
}

}  // namespace kinecal
