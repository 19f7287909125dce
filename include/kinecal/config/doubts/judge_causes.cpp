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
  if (!camera.empty()) {
    judged.judgement.verdict = Grade::do_not_use;
    judged.judgement.reasons.insert(judged.judgement.reasons.begin(), camera);
  }
  Diagnostics offsets;
  check_offsets(input, table, offsets);
  for (const std::string& error : offsets.errors) judged.judgement.add(Grade::do_not_use, error);
}

}  // namespace
}  // namespace detail

void judge_causes(const CalibrationInput& input, JudgedResult& judged) {
  const bool converged = judged.result.converged;
  if (converged) detail::judge_impossible(input, judged);
  if (!converged || judged.assessments.empty() || fits_badly(judged.assessments.back())) {
    for (const std::string& cause : likely_causes(input.config, input.robot, input.samples)) {
      judged.judgement.add(Grade::do_not_use, "likely cause: " + cause);
    }
    return;
  }
  if (judged.assessments.back().change) return;  // lengths have absorbed that, too
  if (const auto held = detail::held_frame(input, judged)) {
    judged.judgement.add(Grade::use_with_care, *held);
  }
  for (const std::string& scale : wrong_scales(input.config, input.robot, input.samples,
                                               judged.result.table, judged.assessments.back())) {
    judged.judgement.add(Grade::use_with_care, scale + "; are its lengths right?");
  }
}

}  // namespace kinecal
