// Reports positions of a joint that are outside its limits.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <span>
#include <string>

#include "kinecal/config/doubts/exchanged_joints.ipp"
#include "kinecal/config/doubts/joint_limits.ipp"
#include "kinecal/config/doubts/occurrences.hpp"
#include "kinecal/files/diagnostics.hpp"

namespace kinecal::detail {

/// What a turn into the limits means; the other sign may explain the same.
[[nodiscard]] inline std::string turned_text(double turn, bool or_negated) {
  return fmt::format(
      fmt::runtime(
          or_negated
              ? "; with {:+.3g} rad, or with the other sign, they are inside: is its zero or its "
                "direction another one than the URDF's?"
              : "; with {:+.3g} rad they are inside: is its zero another one than the URDF's?"),
      turn);
}

/// Reports positions outside the limits: far (doubt), slightly or by a turn (warning).
inline void report_outside(const UsedJoint& joint, std::span<const Sample> samples,
                           Diagnostics& diagnostics) {
  if (!joint.limits) return;
  constexpr double kRounding = 1e-3;  // of limits in a URDF, radians or metres
  Occurrences far, near;
  double most_far = 0.0, most_near = 0.0;
  for (std::size_t i = 0; i < joint.positions.size(); ++i) {
    const double excess = excess_of(joint, joint.positions[i]);
    if (excess <= kRounding) continue;
    const bool is_far = is_outside(joint, joint.positions[i]);
    (is_far ? far : near).add(joint.samples[i]);
    double& most = is_far ? most_far : most_near;
    most = std::max(most, excess);
  }
  const auto text = [&](const Occurrences& found, double most) {
    return fmt::format("position of '{}' is outside its limits {}{}, by up to {:.3g} {}",
                       joint.joint.name, joint.limits_text(), found.others(), most,
                       position_unit(joint.joint.type));
  };
  if (far.count > 0) {
    const std::optional<double> turn = turn_into_limits(joint);
    diagnostics.doubt(
        place_of(samples, far.first),
        text(far, most_far) +
            (turn ? turned_text(*turn, fits_negated(joint))
                  : "; is it the position of another joint, in another unit, or the URDF of "
                    "another robot?"));
  } else if (near.count > 0) {
    diagnostics.warning(place_of(samples, near.first), text(near, most_near));
  }
}

}  // namespace kinecal::detail
