// Selects a few of many candidate poses so that a calibration with them is as good as possible.
//
//   gripper  trace(G C)   mean variance of the wanted pose; usually what matters
//   a        trace(C)     mean variance of the parameters
//   d        log det C    volume of their uncertainty
//   e        max eig C    variance of the worst combination
//
// C = H^+ V H^+ is the covariance of the calibration with the selected samples: see
// sample_design.hpp; V = H if no scores are given.  Criteria a, d and e use units in which H of all
// candidates together has a unit diagonal.  Directions that not even all candidates determine are
// left out.
//
// First, the pose that helps most is added, again and again; then each chosen pose is exchanged for
// the best other one, until nothing improves.  Poses whose joints all differ by less than a given
// share of the range count as one.  If poses may fail, a set is valued without the ones it would
// miss most.
// Source: Fedorov, Theory of Optimal Experiments, 1972, 3 (exchange); Pukelsheim, Optimal Design of
// Experiments, 6 (criteria).
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "kinecal/samples/progress_meter.hpp"
#include "kinecal/trust/plain_matrix.hpp"

namespace kinecal {

/// The criterion for a set of poses.
enum class PoseCriterion { gripper, a, d, e };

/// Poses to choose from.
struct PoseCandidates {
  std::vector<PlainMatrix> information;  ///< (n x n) H of each pose
  std::vector<PlainMatrix> scores = {};  ///< (n x n) V of each pose; empty: as the information
  PlainMatrix before = {};               ///< (n x n) H of prior knowledge; empty: none
  PlainMatrix before_scores = {};        ///< (n x n) V of it; empty: none
  PlainMatrix prior = {};                ///< (n x n) H that priors add per pose; empty: nothing
  PlainMatrix goal = {};                 ///< (n x n) G, square metres: see position_goal()
  /// Joint positions of each pose in their ranges, from 0 to 1; empty: no poses count as near.
  std::vector<std::vector<double>> shares = {};
};

/// How to choose.
struct SelectOptions {
  int count = 25;
  PoseCriterion criterion = PoseCriterion::gripper;
  double least_distance = 0.02;  ///< of the joint that differs most, as a share of its range
  int failures = 0;              ///< number of poses that may fail
  ProgressMeter meter = {};      ///< called for each pose that is looked for
};

/// Poses that were chosen.
struct PoseSelection {
  std::vector<int> chosen;  ///< candidates, the most useful first: any first few are a good set
  std::vector<double>
      values;          ///< of the criterion with the first 1, 2, ... of them; infinite while
                       ///< they determine less than all candidates do
  double value = 0.0;  ///< of all of them, without those that may fail
};

/// Chooses poses.
/// @throws std::invalid_argument  if sizes do not fit, a number is not finite, or there are no
///                                candidates
[[nodiscard]] PoseSelection select_poses(const PoseCandidates& candidates,
                                         const SelectOptions& options);

/// A goal for PoseCandidates: the sum of the variances of some parameters, all others being free, each in units of what
/// a mean pose alone gives if all others are known.  Of two parameters that explain the same, it is least for the poses
/// that tell them apart: the inverse variance of one is the information in the part of its effect that the other
/// parameters do not explain.
/// Source: Pukelsheim, Optimal Design of Experiments, 2 (c-optimality).
/// @param columns  of the information
[[nodiscard]] PlainMatrix goal_of_parameters(const PoseCandidates& candidates,
                                             const std::vector<int>& columns);

/// The criterion of a set; infinite if it determines less than all candidates do.
[[nodiscard]] double design_value(const PoseCandidates& candidates, const std::vector<int>& chosen,
                                  PoseCriterion criterion);

/// Values of random sets, the best first, and the best set: the selection of the Fetch paper.
struct RandomSets {
  std::vector<double> values;
  std::vector<int> best;
};

/// Draws sets of different candidates.
[[nodiscard]] RandomSets random_sets(const PoseCandidates& candidates, int count, int sets,
                                     PoseCriterion criterion, std::uint64_t seed = 1);

}  // namespace kinecal
