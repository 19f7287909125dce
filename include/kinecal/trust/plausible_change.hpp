// Plausible changes of parameters.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/sensors/lens_camera.hpp"
#include "kinecal/trust/judge.hpp"

namespace kinecal::detail {

/// Two limits of a figure: from the first, use with care; from the second, do not use.
struct Limits {
  double care, refuse;

  [[nodiscard]] bool exceeded(double figure) const { return !(figure < care); }
  [[nodiscard]] Grade grade(double figure) const;
  /// The grade of any figure.
  [[nodiscard]] Grade judged(double figure) const;
};

/// Length of the longest chain from the base to a sensor, metres: sum of its links.  A pose that a controller reports
/// stands for the arm that reaches it, about a metre.
[[nodiscard]] double robot_size(const AnyProblem& problem);

/// The largest plausible change of the frame of a joint that moves, metres: a seventh of the link before it.
/// Robots are built more precisely than their mounts.
[[nodiscard]] Limits plausible_length_change(const AnyProblem& problem, const Joint& joint);

/// True for a coefficient of a camera's lens; where a target has a pose of its own in each sample, for all
/// intrinsics, too: nobody knows them then.
[[nodiscard]] bool is_unknown_lens(const AnyProblem& problem, int parameter);

/// The largest plausible change of a parameter; a frame that is not in the URDF may be anywhere, and so may the coefficients of a
/// lens, and a length of an error block that begins at zero: nobody said it.
[[nodiscard]] Limits plausible_change(const AnyProblem& problem, int parameter);

/// True for a parameter that is never negative: sag, play.
[[nodiscard]] bool is_never_negative(const AnyProblem& problem, int parameter);

/// plausible_change() in a step: a frame that was searched for may be anywhere, too.
[[nodiscard]] Limits plausible_change(const CalibrationStep& step, int parameter);

}  // namespace kinecal::detail
