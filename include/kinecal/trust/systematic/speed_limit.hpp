// How fast a robot may move while samples are recorded: what a jitter of the stamps adds to the noise.
//
// An error of the stamp of t seconds changes all residuals of a sample by c t, c being the sum of their
// derivatives by the lags of all sensors: camera and target are both where they were at another time.
// So the lags of all that moves have to be in the table, free or held.  With residuals in standard deviations
// of their noise, along u = c / |c|
//
//   (u r)^2 / (1 - h)  =  tau^2 + jitter^2 |c|^2    in the mean        h: leverage of u
//
// tau^2 is what all samples share, whether they move or not: noise, and joints that do not repeat.  It and
// jitter^2 are the fit of squares with weights 1 / (2 v^2), v being the right side; squares beyond 3.5
// standard deviations do not count.  At a speed w of the fastest joint, a coordinate gets
// k w sqrt(jitter^2 + s^2) more, k being |c| per coordinate and rad/s and s the +- of the lag; where that is
// a third of the noise, the noise grows by 5 %.
// Source: Searle, Casella, McCulloch, Variance Components, 1992, 12 (iterated weighted least squares).
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

#include "kinecal/problem/any_problem.hpp"
#include "kinecal/samples/sample.hpp"

namespace kinecal {

/// What the stamps of the samples of an error block allow.
struct SpeedLimit {
  std::string sensors;         ///< those with a lag: "camera", "camera and arm"
  int samples = 0;             ///< in which the lag matters
  double jitter = 0.0;         ///< standard deviation of the stamps, seconds; 0: none is seen
  double jitter_most = 0.0;    ///< with 95 %, at most so much, seconds
  double lag_deviation = 0.0;  ///< of the least known lag, seconds; 0 if all are held
  double fastest = 0.0;        ///< speed of the fastest joint in all samples, rad/s
  double speed = 0.0;  ///< up to which motion adds less than a third of the noise, rad/s; with the
                       ///< jitter, or the most that it may be if none is seen

  /// "camera: stamps jitter by 2.1 ms: up to 0.15 rad/s motion adds less than a third of the noise".
  [[nodiscard]] std::string text() const;
};

/// The limit of each error block whose sensors have a lag, from a calibration at its solution.
/// @param values   of all parameters of the table
/// @param samples  those of the problem; with joint velocities
/// @returns  none of a block with fewer than ten samples that move, or with a sensor that moves and has no lag
/// @throws std::domain_error  if a residual is undefined
[[nodiscard]] std::vector<SpeedLimit> speed_limits(const AnyProblem& problem, const FreeSet& free,
                                                   ParameterValues values,
                                                   std::span<const Sample> samples);

}  // namespace kinecal
