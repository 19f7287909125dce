// Definitions of judge_causes.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/explain/judge_causes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "kinecal/config/doubts/check_offsets.hpp"
#include "kinecal/explain/explain_fit.hpp"
#include "kinecal/files/results/result_files.hpp"
#include "kinecal/trust/judge_values.hpp"

namespace kinecal {

namespace detail {
namespace {

/// Values that cannot be, whatever the fit.
/// @param is_explained  a cause of the bad fit is known: then cameras that began right are wrong for the same one
void judge_impossible(const CalibrationInput& input, bool is_explained, JudgedResult& judged) {
  const ParameterTable& table = judged.result.table;
  const auto impossible = [&](const ParameterTable& values) {
    return impossible_camera(input.calibration, values, input.samples);
  };
  if (const std::string camera = impossible(table); !camera.empty()) {
    is_explained&& impossible(input.calibration.table).empty()
        ? judged.judgement.add(Grade::do_not_use, camera)
        : judged.judgement.add_causes(Grade::do_not_use, {camera});
  }
  Diagnostics offsets;
  check_offsets(input, table, offsets);
  for (const std::string& error : offsets.errors)
    judged.judgement.add(Grade::do_not_use, error, {Remedy::Kind::mend});
}

/// True if so many samples were left out, or are bad, that something is wrong with more than single captures.
/// @param used  samples of the fit
/// @param all   samples that were given
[[nodiscard]] bool many_are_bad(std::size_t used, std::size_t all,
                                const std::vector<Assessment>& steps) {
  constexpr std::size_t kFewest = 5, kTenth = 10;
  std::size_t bad = all - used;
  if (!steps.empty()) {
    const std::vector<CaptureError>& captures = steps.back().captures;
    bad += static_cast<std::size_t>(std::count_if(
        captures.begin(), captures.end(), [](const CaptureError& error) { return error.bad; }));
  }
  return bad >= kFewest && kTenth * bad >= all;
}

/// True if nothing says how large the residuals may be: those of poses, without a sigma.
[[nodiscard]] bool has_unknown_noise(const Assessment& step) {
  constexpr int kOfPose = 6;
  return std::any_of(step.noise.begin(), step.noise.end(), [](const BlockNoise& noise) {
    return noise.components == kOfPose && !(noise.given > 0.0);
  });
}

/// True if a value is such that a result is refused, however well it fits.
[[nodiscard]] bool is_implausible(const CalibrationStep& step, const ParameterTable& solution) {
  const std::vector<int>& free = step.free.parameters();
  return std::any_of(free.begin(), free.end(), [&](int p) {
    return !(std::abs(change_of(solution[p])) < plausible_change(step, p).refuse);
  });
}

/// What explains a bad fit.
void judge_fit(const CalibrationInput& input, std::span<const Sample> all,
               std::span<const Suspect> own, JudgedResult& judged) {
  constexpr double kThird = 1.0 / 9.0;  // of the noise, in squares
  const bool is_solved = judged.result.converged && !judged.assessments.empty();
  const bool is_bad = !is_solved || fits_badly(judged.assessments.back()) ||
                      is_implausible(input.calibration.steps.back(), judged.result.table);
  const bool has_bad = many_are_bad(input.samples.size(), all.size(), judged.assessments);
  if (!is_bad && !has_bad && !has_unknown_noise(judged.assessments.back())) return;
  const Explained found = explain_fit(input.config, input.robot, has_bad ? all : input.samples,
                                      {.own = own, .combines = is_bad || has_bad, .solve = {}});
  if (!found.cause.empty()) {
    const bool refuse = is_bad || found.left < kThird;
    if (is_solved && judged.assessments.back().systematic) {  // of residuals that the mistake made
      judged.judgement.take_back_cause(sentence(*judged.assessments.back().systematic));
    }
    judged.judgement.add_causes(refuse ? Grade::do_not_use : Grade::use_with_care,
                                {"likely cause: " + found.cause});
    return;
  }
  if (!is_bad || judged.judgement.verdict != Grade::do_not_use) return;
  if (!found.helps.empty()) {
    judged.judgement.add_causes(Grade::do_not_use,
                                {found.helps + ": that helps, and is not all that is wrong"});
  }
  judged.judgement.add(
      Grade::do_not_use,
      fmt::format("none of {} possible mistakes explains that: signs, names and order of "
                  "joints, quarter turns of zeros, couplings, units, axes and scale of points, "
                  "order of features, rows of neighbours, and two or three of them together",
                  found.tried));
}

}  // namespace
}  // namespace detail

void judge_causes(const CalibrationInput& input, std::span<const Sample> all, JudgedResult& judged,
                  std::span<const Suspect> own) {
  const int causes = judged.judgement.causes;
  detail::judge_fit(input, all, own, judged);
  if (!judged.result.converged) return;
  detail::judge_impossible(input, judged.judgement.causes > causes, judged);
}

void judge_scales(const CalibrationInput& input, JudgedResult& judged) {
  if (!judged.result.converged || judged.assessments.empty()) return;
  const Assessment& last = judged.assessments.back();
  if (fits_badly(last)) return;
  if (last.systematic && is_change(last.systematic->course))
    return;  // lengths have absorbed it, too
  std::vector<std::string> scales =
      wrong_scales(input.config, input.robot, input.samples, judged.result.table, last);
  for (std::string& scale : scales) scale += "; are its lengths right?";
  judged.judgement.add_causes(Grade::use_with_care, scales);
}

}  // namespace kinecal
