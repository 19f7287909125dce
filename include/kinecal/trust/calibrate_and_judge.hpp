// The numbers of a calibration: solve, estimate the noise, leave out bad samples, assess, judge.  What a robot and its
// configuration show beyond them is added by procedure/calibrate_robot.hpp.
//
//   Calibration calibration = make_calibration(HandEye(), samples);      // or assemble(config, ...)
//   const JudgedResult judged = calibrate_and_judge(calibration, samples);
//   if (judged.judgement.verdict != Grade::do_not_use) use(judged.result.table);
//
// 1. All steps are solved, from several starts where a pose is unknown (calibrate.hpp), and assessed.
// 2. An error block without a sigma gets the noise that its residuals show, if it has a loss, or shares a
//    step with another such block.  The calibration is solved again until no noise changes by more
//    than 1 %.
// 3. Samples that no noise explains are left out (ruined.hpp), and it begins again at 2, until there are
//    none.
// 4. The verdict counts what was left out; a cause is added to bad samples where one is recognised.
//
// The problem is changed in place, by numbers: no sample is read or added a second time.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <span>
#include <string>
#include <vector>

#include "kinecal/solve/calibrate.hpp"
#include "kinecal/trust/assess.hpp"
#include "kinecal/trust/judge.hpp"

namespace kinecal {

/// A sample that the result does not use.
struct LeftOutSample {
  int number = 0;      ///< from 1, among all samples
  std::string source;  ///< source location: "samples.yaml:4711"
  std::string why;     ///< "error block 'hand_eye': feature 2 is 48 mm off, ..."
};

/// A result, how good it is, and what was left out.
struct JudgedResult {
  CalibrationResult result;             ///< of the samples that were not left out
  std::vector<Assessment> assessments;  ///< of its steps
  Judgement judgement;                  ///< the verdict
  std::vector<LeftOutSample> left_out;  ///< those that the caller excluded first
  /// What it does not use of the other samples, as sentences: judge_input(); empty for samples in shards.
  std::vector<std::string> unused;
  /// Source location of each sample of the problems; empty for samples in shards.
  std::vector<std::string> sources;
  std::vector<int> numbers;           ///< from 1, among all samples, of each of these
  std::map<int, std::string> causes;  ///< likely ones of bad samples, by number in the problem

  /// Standard deviation of a parameter in the last step that frees it; nullopt if none does.
  /// @param parameter  index in the table
  [[nodiscard]] std::optional<double> deviation(int parameter) const;
};

/// How calibrate_and_judge() works.
struct ProcedureOptions {
  SolveOptions solving = {};             ///< of all steps
  int folds = 5;                         ///< of held-out errors; 0: as many as samples; 1: none
  bool keep_outliers = false;            ///< no sample is left out
  std::map<int, std::string> exclude;    ///< samples to leave out, from 0, and why
  std::vector<std::string> doubts = {};  ///< about the input, as sentences: reasons of the verdict
  std::vector<std::string> refutable = {};  ///< those of the doubts that a fit to the noise refutes
  Progress progress = {};                   ///< called in each iteration
  std::vector<std::string> between = {};    ///< see AssessOptions::between
};

/// Calibrates and judges.
/// @param calibration  in: all samples; out: with the sigmas that were estimated, without the samples
///                     that were left out: the problems of the result
/// @param samples      those of the calibration, in their order
/// @throws std::invalid_argument  if too few samples are left, or one to exclude does not exist
[[nodiscard]] JudgedResult calibrate_and_judge(Calibration& calibration,
                                               std::span<const Sample> samples,
                                               const ProcedureOptions& options = {});

/// Assesses and judges a calibration that has run.
/// @param samples  those of the calibration, in their order; their numbers are 1, 2, 3 ...
/// @param doubts     about the input, as sentences
/// @param refutable  those of the doubts that do not count if the result fits to the noise
[[nodiscard]] JudgedResult judge_result(const Calibration& calibration, CalibrationResult result,
                                        std::span<const Sample> samples,
                                        const AssessOptions& options = {},
                                        const std::vector<std::string>& doubts = {},
                                        const std::vector<std::string>& refutable = {});

/// The samples that a result uses.
/// @param all  those that were given to calibrate_and_judge()
[[nodiscard]] std::vector<Sample> used_samples(const JudgedResult& judged,
                                               std::span<const Sample> all);

/// How far a sample is off: "error block 'hand_eye': feature 2 is 48 mm off, all others at most 3 mm, 12.1 times
/// the noise".
[[nodiscard]] std::string capture_text(const CaptureError& error, const Assessment& assessment);

}  // namespace kinecal
