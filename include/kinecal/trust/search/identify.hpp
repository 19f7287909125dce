// Finds out which parameters of a robot are wrong, as far as samples tell.
//
// The problem has the parameters of all candidates; a base, such as the unknown pose of a tracker, is always
// free.  Solving and searching (parameter_search.hpp) alternate, so that large errors are found, too: each search
// is at the solution of the one before.  The noise of each error block is estimated on the way, robustly.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <utility>
#include <vector>

#include "kinecal/samples/sample.hpp"
#include "kinecal/solve/calibrate.hpp"

namespace kinecal {

/// What may be wrong.
struct IdentifyCandidate {
  std::string name;             ///< for people: "elbow_joint", "wrist_joint: z"
  std::vector<int> parameters;  ///< table indices, freed together
  int rank = 0;                 ///< of candidates that explain the same, the lowest is taken
  bool in_part = false;  ///< freed without what samples do not determine, as the axes of a frame
};

/// Turns of zeros: candidates, and radians.
using Turns = std::vector<std::pair<int, double>>;

/// What one parameter buys, in the order of what they explain.  Errors are of the error block, in its unit; of several,
/// in units of their noise.
struct IdentifyStep {
  int candidate = -1;     ///< by number; -1: the base alone
  double fitted = 0.0;    ///< root of the mean squared distance after it
  double held_out = 0.0;  ///< the same, of poses held out
  double region = 0.0;    ///< the same, of regions held out; 0: too few poses
  double certainty =
      0.0;  ///< rise of the error on held-out poses without it alone, in its standard errors
  std::vector<int> alike;  ///< other candidates that explain the same
  double deviation = 0.0;  ///< standard error of held_out
  int parameters = 0;      ///< that are free
  std::vector<int> inseparable =
      {};  ///< those of `alike` that no sample like these tells from it: either is as good
};

/// Parameters of a candidate that the base absorbs: these samples do not separate them from it.
struct AbsorbedParameters {
  int candidate = -1;
  std::vector<int> parameters;  ///< table indices
  std::vector<std::string> by;  ///< joints, frames, sensors or error blocks of the base
};

/// What was found.
struct Identified {
  std::vector<int> chosen;  ///< candidates
  Turns turned;             ///< zeros that are a quarter or half turn off: their values begin there
  std::vector<IdentifyStep> steps;  ///< the first one is the base alone
  /// What the next candidates would have bought, if they were freed after these: they were not, because noise explains it.
  std::vector<IdentifyStep> beyond;
  std::vector<AbsorbedParameters> absorbed;
  CalibrationResult result;  ///< with the chosen parameters free
  std::string unit;          ///< of the errors: that of the error block; "1": there are several
};

/// The one or two held candidates that lower the error on held-out poses most, tested by another solve.  Without
/// steps if it fails.
/// @param calibration  of one step, whose problem has all parameters, at its solution; it changes
/// @param base         table indices of the parameters that are free
/// @param candidates   as of identify()
/// @throws std::invalid_argument  as identify()
[[nodiscard]] Identified most_helpful(Calibration& calibration, std::span<const Sample> samples,
                                      const std::vector<int>& base,
                                      std::vector<IdentifyCandidate>& candidates);

/// Searches for the parameters that samples support.
/// @param calibration  of one step, whose problem has all parameters; its free set, sigmas and values change
/// @param samples      those of the problem, in their order
/// @param base         table indices that are always free
/// @param candidates   lose the parameters that samples do not determine beside the base, if `in_part`
/// @param likely       turns of zeros that something suggests: tried first if the samples do not fit at the start
/// @throws std::invalid_argument  if the calibration has not one step, or samples of too few poses
[[nodiscard]] Identified identify(Calibration& calibration, std::span<const Sample> samples,
                                  const std::vector<int>& base,
                                  std::vector<IdentifyCandidate>& candidates,
                                  const Turns& likely = {});

}  // namespace kinecal
