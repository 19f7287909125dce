// Leaves out ruined captures: samples that no noise explains.
//
// A sample is ruined if it is bad (captures.hpp) in the fit of the samples that are not.  Ruined
// samples are left out and the others fitted again, until none is found.  If more than a quarter of
// a fit's samples would be ruined, or if a change during the recording or the error of a joint or lens
// explains as much, the model is more likely wrong, and none is left out.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "kinecal/trust/assess.hpp"

namespace kinecal {

/// Ratio of the noise without the bad samples to that of all; 1 if none is bad.
[[nodiscard]] double noise_without_bad(const LinearFit& fit,
                                       const std::vector<CaptureError>& captures);

/// True if a change during the recording, a pattern of residuals or a lens explains more than leaving out bad samples
/// does: they are no matter of single samples.
[[nodiscard]] bool explains_more(const Assessment& last);

/// The ruined samples of a fit, in their order; empty if absent, or too many.
[[nodiscard]] std::vector<CaptureError> ruined_captures(const Assessment& last);

/// Fits repeatedly, without ruined samples, until none is found.
/// @param fit        the fit of the remaining samples, of any type
/// @param last       assessment of a fit's last step; nullptr if there is nothing to judge
/// @param leave_out  takes a fit and those of its samples that are to be left out of the next one
/// @returns  the last fit
template <class Fit, class Last, class LeaveOut>
[[nodiscard]] auto fit_without_ruined(const Fit& fit, const Last& last, const LeaveOut& leave_out) {
  constexpr int kRounds = 5;
  for (int round = 0;; ++round) {
    auto fitted = fit();
    const Assessment* assessment = last(fitted);
    if (round == kRounds || assessment == nullptr) return fitted;
    const std::vector<CaptureError> ruined = ruined_captures(*assessment);
    if (ruined.empty()) return fitted;
    leave_out(fitted, ruined);
  }
}

}  // namespace kinecal
