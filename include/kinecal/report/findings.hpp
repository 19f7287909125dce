// All that is reported of a calibration: the result, what it is worth, what was left out.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "kinecal/report/recorded_poses.hpp"
#include "kinecal/report/text.hpp"
#include "kinecal/solve/calibrate.hpp"
#include "kinecal/trust/assess.hpp"
#include "kinecal/trust/judge.hpp"

namespace kinecal {

/// A sample that the fit does not use.
struct LeftOutSample {
  int number = 0;      ///< from 1, in the order of the files
  std::string source;  ///< source location: "samples.yaml:4711"
  std::string why;     ///< "error block 'hand_eye', feature 2 is 48 mm off, ..."
};

/// What is reported of a calibration.
struct Findings {
  std::string robot;                    ///< its name
  CalibrationResult result;             ///< of the samples that were not left out
  std::vector<Assessment> assessments;  ///< of its steps
  Judgement judgement;                  ///< the verdict
  std::vector<LeftOutSample> left_out;  ///< by the rule of trust/captures.hpp, or by the user
  std::vector<std::string> sources;     ///< source location of each sample of the problems
  std::vector<int> numbers;             ///< from 1, in the order of the files, of each of them
  std::map<int, std::string> causes;    ///< likely ones of bad samples, by number in the problem
  std::map<std::string, std::string>
      images;                ///< "raw" or "rectified", of cameras where it was chosen
  RecordedPoses poses = {};  ///< of the samples that were used
};

/// What is wrong with a sample: "error block 'hand_eye': feature 2 is 48 mm off, all others below 3 mm".
[[nodiscard]] std::string capture_text(const CaptureError& error, const Assessment& assessment);

/// Assesses and judges a calibration that has run.
/// @param samples  those of the calibration, in their order; their numbers are 1, 2, 3 ...
/// @param doubts   about the input, as sentences
[[nodiscard]] Findings find(const Robot& robot, const Calibration& calibration,
                            CalibrationResult result, std::span<const Sample> samples,
                            const AssessOptions& options = {},
                            const std::vector<std::string>& doubts = {});

namespace detail {

/// The last assessment's entry for an error block; nullptr if there is none.
template <class T>
[[nodiscard]] const T* of_block(const std::vector<Assessment>& assessments,
                                std::vector<T> Assessment::*list, const std::string& name) {
  for (auto a = assessments.rbegin(); a != assessments.rend(); ++a) {
    for (const T& item : (*a).*list) {
      if (item.block == name) return &item;
    }
  }
  return nullptr;
}
/// Standard deviation of a parameter in the last step that frees it.
[[nodiscard]] std::optional<double> deviation_of(const Findings& findings, int parameter);
/// "; likely cause: ...", or nothing.
/// @param sample  by number in the problem
[[nodiscard]] std::string cause_text(const Findings& findings, int sample);
/// "not determined", "hardly determined", "not significant" or nothing.
[[nodiscard]] std::string note_on(const Parameter& parameter, double deviation);

}  // namespace detail

/// The report for people, in this order: verdict, fit, parameters, what cannot be determined, the worst
/// samples, what to do next.  Distances in millimetres or pixels, angles in degrees.
[[nodiscard]] std::string findings_text(const Findings& findings);

/// The same, then what each step did and how long it took.
[[nodiscard]] inline std::string summary_text(const Findings& findings) {
  return findings_text(findings) + "\n" + step_lines(findings.result);
}

}  // namespace kinecal

#ifdef KINECAL_HEADER_ONLY
#include "kinecal/report/findings.ipp"
#endif
