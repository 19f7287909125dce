// Poses of frames alone, everything else held: a search from an even grid of orientations.
//
// Each start is fitted by the method of Levenberg and Marquardt.  After each step the frames are
// placed anew by their translations, which is a linear problem for points and lines of sight.
// Source: Nocedal, Wright, Numerical Optimization, 10.3; Golub, Pereyra, Separable Nonlinear Least
// Squares: the Variable Projection Method, 2003.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <span>
#include <string>
#include <vector>

#include "kinecal/evaluation/any_evaluator.hpp"
#include "kinecal/linkage.hpp"
#include "kinecal/problem/any_problem.hpp"

namespace kinecal {

/// A free frame whose pose may not be known.
struct UnknownFrame {
  std::string name;  ///< joint of the robot or virtual frame
  /// Table indices of x y z a b c; -1: this axis is held.
  std::array<int, 6> axes = {-1, -1, -1, -1, -1, -1};
  /// URDF or configuration have a pose for it.  It is searched for only if a start there ends badly.
  bool has_guess = false;

  /// True if some rotation is free.
  [[nodiscard]] bool turns() const { return axes[3] >= 0 || axes[4] >= 0 || axes[5] >= 0; }
};

namespace detail {

/// Where fits of frames ended.
struct FittedFrames {
  double cost = 0.0;       ///< of the excerpt
  Eigen::VectorXd values;  ///< of all parameters of the table
  int starts = 0;          ///< that ended there
};

/// The rotation vector of a frame; components that are held count as zero.
/// @param values  of all parameters of the table
/// @returns       (3) radians
[[nodiscard]] Vector3<double> rotation_of(const UnknownFrame& frame, const Eigen::VectorXd& values);

/// How far a frame turns from one set of values to another, radians.
[[nodiscard]] double turn_between(const UnknownFrame& frame, const Eigen::VectorXd& from,
                                  const Eigen::VectorXd& to);

/// Fits from a grid.
struct FrameFits {
  std::vector<FittedFrames> minima;  ///< distinct, lowest cost first
  int starts = 0;                    ///< of all of them
};

/// Least number of starts for these frames: 60 if one of them turns, else none.
[[nodiscard]] int grid_size(std::span<const UnknownFrame> frames);

/// Fits frames to a few samples from a grid of orientations: 60 at a time, up to 300, until five of
/// them have ended at the lowest minimum.
/// @param excerpt  the problem with a few of its samples
/// @param values   of all parameters of the problem's table
/// @param threads  number of threads; zero: one per core.  The result does not depend on it
/// @returns        no minima if the cost is finite nowhere
[[nodiscard]] FrameFits fit_frames(const AnyProblem& excerpt, std::span<const UnknownFrame> frames,
                                   const Eigen::VectorXd& values, int threads);

}  // namespace detail

}  // namespace kinecal

#ifdef KINECAL_HEADER_ONLY
#include "kinecal/solve/fit_frames.ipp"
#endif
