// Fits poses of frames only, with everything else held: searches from an even grid of orientations.
//
// Each start is fitted by Levenberg-Marquardt.  After each step, the translations are solved again,
// a linear problem for points and lines of sight.
//
// A grid covers two frames, not five.  So frames are searched for in stages: those of one error block, such as a camera and the
// board that it sees; then, with these known, those of the next, such as another camera that sees the board.
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
#include "kinecal/solve/pose_search.hpp"

namespace kinecal {

/// A free frame whose pose may be unknown: see unknown_frame().
struct UnknownFrame {
  std::string name;  ///< joint of the robot or virtual frame
  /// Table indices of x y z a b c; -1: this axis is held.
  std::array<int, 6> axes = {-1, -1, -1, -1, -1, -1};
  /// URDF or configuration give a pose.  It is searched for only if solving from that pose ends
  /// badly.
  bool has_guess = false;

  /// True if some rotation is free.
  [[nodiscard]] bool turns() const { return axes[3] >= 0 || axes[4] >= 0 || axes[5] >= 0; }
};

namespace detail {

/// A frame with the indices of its free axes.
[[nodiscard]] UnknownFrame unknown_frame(const std::string& name, const ParameterTable& table,
                                         const FreeSet& free, bool has_guess);

/// A minimum that fits of frames reached.
struct FittedFrames {
  double cost = 0.0;       ///< of the excerpt
  Eigen::VectorXd values;  ///< of all parameters of the table
  int starts = 0;          ///< number of starts that ended there
};

/// The rotation vector of a frame; held components count as zero.
/// @param values  of all parameters of the table
/// @returns       (3) radians
[[nodiscard]] Vector3<double> rotation_of(const UnknownFrame& frame, const Eigen::VectorXd& values);

/// The angle between a frame's rotations at two sets of values, radians.
[[nodiscard]] double turn_between(const UnknownFrame& frame, const Eigen::VectorXd& from,
                                  const Eigen::VectorXd& to);

/// True if a frame, of those with or those without a guess, is turned by more than 30 degrees, the
/// limit for a bracket that is mounted as drawn.
[[nodiscard]] bool any_turned(std::span<const UnknownFrame> frames, bool has_guess,
                              const Eigen::VectorXd& from, const Eigen::VectorXd& to);

/// All fits from a grid.
struct FrameFits {
  std::vector<FittedFrames> minima;  ///< distinct, lowest cost first
  int starts = 0;                    ///< of all of them
};

/// A minimum is worth finishing below this many times the least cost: ten times the error.
inline constexpr double kWorthFinishing = 100.0;

/// Frames that are fitted at once.
struct SearchStage {
  std::vector<UnknownFrame> frames;  ///< of unknown pose
  std::vector<int>
      terms;  ///< error blocks that need them and no frame of a later stage; empty: all
};

/// The order in which frames are searched for: next is the error block of two sensors with the fewest unknown frames; of these,
/// the one with the most samples.
[[nodiscard]] std::vector<SearchStage> search_stages(const AnyProblem& excerpt,
                                                     std::span<const UnknownFrame> frames);

/// True if one of these frames rotates: a search begins with rotations.
[[nodiscard]] bool any_turns(std::span<const UnknownFrame> frames);

/// Fits frames to a few samples from a grid of orientations, stage by stage: in each, a round at a time, until five fits have
/// ended at the lowest minimum.
/// @param excerpt  the problem with a few of its samples
/// @param values   of all parameters of the problem's table
/// @param threads  number of threads; zero: one per core.  Does not affect the result
/// @returns        no minima if the cost is finite nowhere
[[nodiscard]] FrameFits fit_frames(const AnyProblem& excerpt, std::span<const UnknownFrame> frames,
                                   const Eigen::VectorXd& values, int threads,
                                   const PoseSearch& search = {});

/// The lowest cost of fit_frames(); infinite without minima.
[[nodiscard]] double cost_of_frames(const AnyProblem& excerpt, std::span<const UnknownFrame> frames,
                                    ParameterValues values, const PoseSearch& search);

/// The cost after a few iterations with all free parameters of an evaluator; infinite if it is not defined.
/// @param values  of all parameters of the problem's table: where to start
[[nodiscard]] double cost_after(AnyEvaluator& evaluator, ParameterValues values, int iterations);

}  // namespace detail

}  // namespace kinecal

#ifdef KINECAL_HEADER_ONLY
#include "kinecal/solve/fit_frames.ipp"
#endif
