// Drift over weeks: how the changes grow that check_drift() finds in one recording after another.
//
// Recording i says that a mover has changed by c_i, with covariance V_i (drift.hpp, all_movers).  If it drifts,
//
//   c(t) = a + b t      min over a, b of  Q = sum_i (c_i - c(t_i))^T V_i^-1 (c_i - c(t_i))
//
// V_i contains the error of the calibration, which all recordings share: a takes it up.  What recordings really differ by
// is measured about the line, s^2 = Q / freedom, and errors that are alike from one recording to the next (a warm week,
// correlation rho) count as fewer: s^2 (1 + rho) / (1 - rho).  The fall of Q by b is compared with F, for the largest rho
// that n recordings allow, rho + 2 / sqrt(n): a wandering zero and a drift look alike at first.  So with fewer than about
// eight recordings nothing is found.
// Lines of several movers are compared by the X that they leave, plus 2 rank, less the X of nothing moved: not every mover is in all
// recordings, and what it is not in it leaves as it is.
// A drift of any of n movers of all robots is found if its probability is below level / n (Bonferroni).
// Source: Bartlett, On the Theoretical Specification and Sampling Properties of Autocorrelated Time-Series, 1946 (rho).
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <vector>

namespace kinecal {

/// The change of a mover in one recording, since the calibration.
struct TimedChange {
  double time = 0.0;               ///< of the recording, seconds
  std::vector<double> change;      ///< (k) of its parameters, in their units
  std::vector<double> covariance;  ///< (k x k) row after row
  double score = 0.0;              ///< X that is left + 2 rank (Mover::score) - X if nothing moved
};

/// The line through the changes of a mover.
struct DriftLine {
  double origin = 0.0;             ///< time of a, seconds: the mean of the recordings
  double last = 0.0;               ///< time of the last recording, seconds
  int recordings = 0;              ///< number of them
  std::vector<double> level;       ///< (k) a, in the units of the parameters
  std::vector<double> slope;       ///< (k) b, units per second
  std::vector<double> covariance;  ///< (2k x 2k) of a and b, row after row
  double scatter = 0.0;            ///< s: 1 if recordings differ as their covariances say
  double memory = 0.0;             ///< rho
  double probability = 1.0;        ///< of a larger slope by chance
  double score = 0.0;  ///< X that the line leaves + 2 rank - X if nothing moved; the least is best

  /// The change of a parameter at some time.
  [[nodiscard]] double change_at(std::size_t parameter, double time) const {
    return level[parameter] + slope[parameter] * (time - origin);
  }
  /// Standard deviation of the slope of a parameter, units per second.
  [[nodiscard]] double slope_deviation(std::size_t parameter) const;
};

/// Fits the line.  Directions of the change that no recording determines stay at zero.
/// @param changes  of one mover, each with k parameters; in the order of their times
/// @returns  nullopt for fewer than four recordings, or none at another time
/// @throws std::invalid_argument  if sizes differ
[[nodiscard]] std::optional<DriftLine> drift_line(std::span<const TimedChange> changes);

/// A line by mover and robot, and which are no chance.
struct MoverLine {
  int robot = 0;   ///< by number
  int mover = 0;   ///< by number, in its robot
  DriftLine line;  ///< of it
};

/// A robot that drifts.
struct DriftingRobot {
  int robot = 0;           ///< by number
  int mover = 0;           ///< the one whose line explains its recordings best
  std::vector<int> alike;  ///< others that explain them as well: scores that differ by less than 6
  double probability = 1.0;  ///< of such a slope, somewhere, by chance
};

/// The robots with a slope that is no chance.
/// @param lines  of all movers of all robots
/// @param level  probability of naming any robot if none drifts
[[nodiscard]] std::vector<DriftingRobot> drifting_robots(std::span<const MoverLine> lines,
                                                         double level);

/// The size of a change, such as the shift of a tool: sqrt(c^T G c).
struct ChangeSize {
  std::vector<double>
      effect;  ///< (k x k) G, row after row: metres^2 by the units of the parameters

  /// Of some changes.
  [[nodiscard]] double of(std::span<const double> change) const;
};

/// When something happens.
struct When {
  double time = 0.0;       ///< seconds
  double deviation = 0.0;  ///< its standard deviation
};

/// When the size of the change passes a limit; the time of the last recording if it has.
/// @param limit  in the unit of the size, positive
/// @returns  nullopt: never
[[nodiscard]] std::optional<When> passes(const DriftLine& line, const ChangeSize& size,
                                         double limit);

}  // namespace kinecal
