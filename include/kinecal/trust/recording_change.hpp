// A change while samples were recorded: a tracker was touched, a joint slipped; a drift: it warmed up; samples of two
// robots in turn.
//
// Let a joint, frame or sensor, or the zeros of all joints, have other parameters in some samples:
//
//   from sample k on                          k: 64 places
//   from sample k until sample l              16 places
//   in proportion to the number of the sample
//   in some samples, here and there           those that fit better so, in turn with the parameters
//
// The sum of squares falls by the share x.  Without a change, x has the beta distribution (q / 2, (freedom - q) / 2), q the
// number of its parameters; all features of a pose err together, so that freedom counts at most six residuals of it.
// A change is reported if chance is excluded over all owners and places, and if the noise falls to 75 %: deflection and
// the like also vary over the workspace.  For a part in the
// middle and samples here and there the noise must fall to a half: errors of a lens look like that, and a joint that
// scatters can be split in two as well.  Samples here and there cost a degree of freedom each.
// Source: Chow, Tests of Equality Between Sets of Coefficients in Two Linear Regressions, 1960.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "kinecal/samples/sample.hpp"
#include "kinecal/solve/linear_fit.hpp"
#include "kinecal/trust/pose_groups.hpp"

namespace kinecal {

/// A change during the recording.
struct RecordingChange {
  std::string
      owner;  ///< joint, frame, sensor or error block that changed; empty: the zeros of all joints
  int sample = 0;           ///< first one after the change, by number in the problem
  int end = 0;              ///< first one that is as before again; 0: all that follow have changed
  double noise_left = 1.0;  ///< ratio of the noise with the change to that without
  std::vector<int> here_and_there =
      {};                ///< samples with other parameters, if they are no part in one piece
  bool drifts = false;   ///< it changes evenly from the first sample to the last
  double metres = 0.0;   ///< length of the change of its parameters in metres, in all
  double radians = 0.0;  ///< the same of those in radians
  bool by_pose = false;  ///< the order of samples follows their poses: the pose may explain it
};

/// Whether the course of a change follows the joint positions: then an error that depends on the pose explains
/// it as well.
/// @param samples  those of the problem, in their order
[[nodiscard]] bool follows_poses(const AnyProblem& problem, const RecordingChange& change,
                                 std::span<const Sample> samples);

/// The change that explains the residuals best; nullopt if none does.  Samples must be in recording
/// order.
/// @param free   the parameters of `fit`, at its solution
/// @param poses  of the samples
[[nodiscard]] std::optional<RecordingChange> recording_change(const AnyProblem& problem,
                                                              const FreeSet& free,
                                                              const LinearFit& fit,
                                                              const PoseGroups& poses);

}  // namespace kinecal
