// Definitions of judge_causes.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/config/doubts/judge_causes.hpp"

#include "kinecal/config/doubts/check_offsets.hpp"
#include "kinecal/config/doubts/held_frame.ipp"
#include "kinecal/config/doubts/likely_causes.hpp"
#include "kinecal/files/results/result_files.hpp"

namespace kinecal {

namespace detail {
namespace {

/// Values that cannot be, whatever the fit.
void judge_impossible(const CalibrationInput& input, JudgedResult& judged) {
  const ParameterTable& table = judged.result.table;
  const std::string camera = impossible_camera(input.calibration, table, input.samples);
  if (!camera.empty()) judged.judgement.add_causes(Grade::do_not_use, {camera});
  Diagnostics offsets;
  check_offsets(input, table, offsets);
  for (const std::string& error : offsets.errors) judged.judgement.add(Grade::do_not_use, error);
}

/// Mistakes that explain a bad fit; of a good one, a held frame and scales.
void judge_likely(const CalibrationInput& input, JudgedResult& judged) {
  if (!judged.result.converged || judged.assessments.empty() ||
      fits_badly(judged.assessments.back())) {
    std::vector<std::string> causes = likely_causes(input.config, input.robot, input.samples);
    for (std::string& cause : causes) cause = "likely cause: " + cause;
    judged.judgement.add_causes(Grade::do_not_use, causes);
    return;
  }
  if (judged.assessments.back().change) return;  // lengths have absorbed that, too
  if (const auto held = held_frame(input, judged)) {
    judged.judgement.add_causes(Grade::use_with_care, {*held});
  }
  std::vector<std::string> scales = wrong_scales(input.config, input.robot, input.samples,
                                                 judged.result.table, judged.assessments.back());
  for (std::string& scale : scales) scale += "; are its lengths right?";
  judged.judgement.add_causes(Grade::use_with_care, scales);
}

}  // namespace
}  // namespace detail

void judge_causes(const CalibrationInput& input, JudgedResult& judged) {
  detail::judge_likely(input, judged);
  if (judged.result.converged) detail::judge_impossible(input, judged);
}

}  // namespace kinecal
