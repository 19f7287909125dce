// Whether a capture session may end.
//
// The last few poses that a robot needs are those in which its calibration is wrong.  So an accuracy is
// reached only if
//
//   - the samples measure half as many numbers again as there are free parameters (measured_numbers.hpp),
//   - the calibration of all samples is usable,
//   - the pose is determined and known as well as asked for at the captured poses, at the pose of each
//     sample by the other samples, and at the poses that are left (pose_elsewhere.hpp); where samples held
//     out are further off than fitted ones, by as many times less well.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>

#include "kinecal/config/capture/session_follower.hpp"
#include "kinecal/linkage.hpp"
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

/// Why a session must go on, as a sentence; empty if the accuracy is reached.
/// @param ahead  poses that are left; of these, only joint positions count
[[nodiscard]] std::string why_go_on(const Accuracy& wanted, const SessionResult& result,
                                    std::span<const Sample> ahead);

}  // namespace kinecal

#ifdef KINECAL_HEADER_ONLY
#include "kinecal/config/capture/session_end.ipp"
#endif
