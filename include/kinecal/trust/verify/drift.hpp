// Drift: does a calibration still hold for a few new samples, and if not, what has moved?
//
// If nothing has moved, the weighted residuals of new samples are noise plus the error of the
// calibrated parameters: r ~ N(0, S + J C J^T), S the noise, C the covariance.  So
//
//   X = r^T (S + J C J^T)^-1 r = min over u of |S^-1/2 r(B u)|^2 + |u|^2      C = B B^T
//
// is chi-square with the number of residuals as degrees of freedom.  Features of a pose share the errors
// of the joints and of the model, which are in S (common_noise.hpp); if the calibration could not separate
// them, all features of a pose count as one.  S and C are estimates, so X / freedom is compared with F.
// S reproduces the sums of squares of the calibration's poses, so X needs no other correction.
// Undetermined directions cost nothing.
// The hypothesis "the elbow has moved" frees its parameters; if it is false, X falls only by
// chi-square of their number, times the effect of S on gradients (common_noise.hpp).  Half of the false
// alarms are for X itself, half for the largest of these falls.  Hypotheses are compared by X + 2 rank;
// those that move all features alike are one.
// If the calibration holds, the same distributions with the mean of a change say which one would have
// been found: noncentral chi-square, with the squared length of the whitened change.
// One new sample in five may be a bad capture: it is left out if the others hold without it and it
// is further off than chance at the level, unless the slip of one joint explains all samples better.
// Source: Akaike, A New Look at the Statistical Model
// Identification, 1974; Welch, The Generalization of Student's Problem, 1947 (freedom of S).
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

#include "kinecal/problem/any_problem.hpp"
#include "kinecal/trust/assess.hpp"

namespace kinecal {

/// A finished calibration.
struct CalibratedState {
  std::vector<double> values;             ///< of all parameters of the table
  std::vector<int> parameters;            ///< table indices: columns of the covariance
  PlainMatrix covariance;                 ///< (parameters x parameters), units of the parameters
  std::vector<Combination> undetermined;  ///< what neither samples nor priors determined
  std::vector<BlockNoise> noise;          ///< of each error block, by name
  CommonNoise common = {};                ///< that features of a pose share
};

/// The state of a calibration from its assessment.
/// @param values  of all parameters of the table: its result
[[nodiscard]] CalibratedState calibrated_state(const Assessment& assessment,
                                               ParameterValues values);

/// A sample that does not fit while the others do.
struct MissedSample {
  int sample = 0;      ///< by number in the problem
  int rows = 0;        ///< its residuals
  double times = 0.0;  ///< root mean square, in standard deviations
};

/// A joint, frame or sensor that may have moved.
struct Mover {
  std::string owner;                      ///< "elbow_flex_joint"
  bool is_frame = false;                  ///< its frame, not the offset of the joint
  std::vector<int> parameters;            ///< table indices
  std::vector<std::string> same = {};     ///< other owners with the same effect on all new samples
  std::vector<double> change = {};        ///< of each parameter, since the calibration
  std::vector<double> deviation = {};     ///< standard deviation of each change
  std::vector<double> covariance = {};    ///< (k x k) of the k changes, row after row
  double statistic = 0.0;                 ///< remaining X
  double freedom = 0.0;                   ///< its degrees of freedom
  double probability = 0.0;               ///< of a larger X by chance
  double score = 0.0;                     ///< X + 2 rank, plus 14 for each sample left out
  bool explains = false;                  ///< the remaining X is within chance
  std::vector<MissedSample> missed = {};  ///< samples left out for this
};

/// The smallest change of a joint or frame that is found 9 times of 10.
struct SmallestChange {
  std::string owner;      ///< "elbow_flex_joint"
  bool is_frame = false;  ///< a shift of its frame, along the axis along which it shows least
  std::string unit;       ///< of its size: "rad" or "m"
  double size = 0.0;      ///< infinite if these samples do not show it
};

/// Whether a calibration still holds.
struct Drift {
  bool holds = true;           ///< X is within chance, at the level of the options
  double statistic = 0.0;      ///< X, of all samples but those of `missed`
  double freedom = 0.0;        ///< its degrees of freedom
  double noise_freedom = 0.0;  ///< those of the noise
  double probability = 1.0;    ///< of a larger X, or of a larger fall by a mover, by chance
  double score = 0.0;          ///< of the best explanation: that nothing or one mover has moved
  std::vector<MissedSample> missed;  ///< bad captures, if the others hold
  /// The most likely one first; empty if the calibration holds, unless DriftOptions::all_movers.
  std::vector<Mover> movers;
  /// How many of the first movers are indistinguishable: scores that differ by less than 6.  The
  /// one with the fewest parameters comes first.
  int alike = 0;
  /// If the calibration holds: what would have been found in these samples, the smallest first.
  std::vector<SmallestChange> visible;
};

/// How to decide.
struct DriftOptions {
  double level = 0.01;      ///< share of false alarms
  bool all_movers = false;  ///< also of a calibration that holds: how far each may have moved
};

/// Checks a calibration with new samples.
/// @param problem  with the new samples; its table may have more parameters than were calibrated:
///                 each of its joints, frames and sensors is a hypothesis
/// @param samples  those of the problem, in their order
/// @throws std::invalid_argument  if the noise of an error block is unknown
/// @throws std::domain_error      if a residual is undefined
[[nodiscard]] Drift check_drift(const AnyProblem& problem, std::span<const Sample> samples,
                                const CalibratedState& state, const DriftOptions& options = {});

}  // namespace kinecal
