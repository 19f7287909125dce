// Decides when a capture session may end.
//
// The last few poses that a robot needs are those at which its calibration is wrong.  So an
// accuracy is reached only if
//
//   - the samples measure half as many numbers again as there are free parameters
//     (measured_numbers.hpp),
//   - the calibration of all samples is usable, and more poses would cure none of the reasons of its verdict,
//   - no parameter is hardly determined that the remaining poses would determine,
//   - the pose is determined and as accurate as requested at the captured poses, at each sample's
//     pose from the other samples, and at the remaining poses (pose_elsewhere.hpp).  If held-out
//     samples are further off than fitted ones, the uncertainty grows by that factor.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>

#include "kinecal/procedure/session_follower.hpp"
#include "kinecal/trust/assess.hpp"
#include "kinecal/trust/judge.hpp"

namespace kinecal {

/// The calibration of all samples of a session so far.
struct SessionResult {
  const AnyProblem& problem;        ///< of its last step
  std::span<const double> values;   ///< of all parameters of the table
  const Assessment& step;           ///< of the last step
  const Judgement& judgement;       ///< of the calibration
  std::span<const Sample> samples;  ///< of the problem, in their order
};

/// Why a session must continue, as a sentence; empty if the accuracy is reached.
/// @param ahead  remaining poses; uses only their joint positions
[[nodiscard]] std::string why_go_on(const Accuracy& wanted, const SessionResult& result,
                                    std::span<const Sample> ahead);

/// The same of a session.  Looks for causes only where nothing else is a reason to go on.
/// @throws InputError  if its samples do not suffice
[[nodiscard]] std::string why_go_on(const Accuracy& wanted, const SessionFollower& session,
                                    std::span<const Sample> ahead);

}  // namespace kinecal
