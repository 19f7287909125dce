// The findings of a calibration: the result, its quality, and the samples left out.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "kinecal/report/next_step.hpp"
#include "kinecal/report/read_back.hpp"
#include "kinecal/report/recorded_poses.hpp"
#include "kinecal/report/reported_search.hpp"
#include "kinecal/report/text.hpp"
#include "kinecal/trust/calibrate_and_judge.hpp"

namespace kinecal {

/// What is reported of a calibration.
struct Findings : JudgedResult {
  std::string robot = {};                          ///< its name
  std::map<std::string, std::string> images = {};  ///< "raw" or "rectified", where it was chosen,
                                                   ///< by camera
  std::map<std::string, std::string> lenses = {};  ///< of cameras of raw images: lens_names()
  std::vector<std::string> helps = {};  ///< what would lower the error on held-out poses: sentences
  double helps_leave = 1.0;             ///< what is left of that error then
  std::vector<std::string> speeds = {};  ///< how fast is still good, where samples moved: sentences
  std::vector<int> held = {};  ///< parameters of joints and sensors held at a value other than zero
  ReportedSearch search = {};  ///< that chose the free parameters; without steps: there was none
  ReadBack read_back = {};     ///< what those see who read the files
  RecordedPoses poses = {};    ///< of the samples that were used
  ProgramCall call = {};       ///< how the program was called
  /// The file of the results that a driver needs: for a base or a magnetometer without anything else, its own.
  std::string driver_file = "calibrated.urdf";
  bool has_sample_poses = false;  ///< a target has a pose of its own in each sample
  std::int64_t drawn =
      0;  ///< samples by which a log was judged where all at once are needed; 0: all

  /// Number of samples that the result uses: of a log those of all files, not of the draw.
  [[nodiscard]] std::int64_t used_count() const {
    return drawn > 0 && !result.steps.empty() ? result.steps.front().samples
                                              : static_cast<std::int64_t>(sources.size());
  }
};

/// What is reported of a judged calibration.
/// @param calibration  that of the result
/// @param samples      those of its problems, in their order
[[nodiscard]] Findings findings_of(const Robot& robot, const Calibration& calibration,
                                   JudgedResult judged, std::span<const Sample> samples);

namespace detail {

/// "; likely cause: ...", or nothing.
/// @param sample  by number in the problem
[[nodiscard]] std::string cause_text(const Findings& findings, int sample);
/// "not determined", "hardly determined", "not significant", or empty.
[[nodiscard]] std::string note_on(const Parameter& parameter, double deviation);
/// False if a pose on the way to a sensor of an error block was searched for: nobody gave it.
[[nodiscard]] bool has_before(const Findings& findings, const AnyProblem& problem,
                              const Term& term);

}  // namespace detail

/// Figures of parameters: in degrees and millimetres, or their values in radians and metres, too.
enum class Figures { readable, raw };

/// The report as text, in this order: verdict, fit, parameters, what cannot be determined, the
/// worst samples, what to do next.  Distances in millimetres or pixels, angles in degrees.
[[nodiscard]] std::string findings_text(const Findings& findings,
                                        Figures figures = Figures::readable);

/// The same with all detail, followed by what each step did and how long it took.
[[nodiscard]] inline std::string summary_text(const Findings& findings) {
  return findings_text(findings, Figures::raw) + "\n" + step_lines(findings.result);
}

/// The result in one line: "good · hand_eye 1.11 mm (held out 1.14) · 1 of 125 samples left out".
[[nodiscard]] std::string findings_line(const Findings& findings);

/// "fx 800.12 +- 0.05, fy 800.3 +- 0.05, cx ..., cy ... px; plumb_bob k1 -0.2501 +- 0.0003": as camera files have them; empty
/// if the camera has none.
[[nodiscard]] std::string camera_numbers(const ProjectionMap& map);

}  // namespace kinecal
