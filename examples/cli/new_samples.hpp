// New samples of a robot that has been calibrated, held against the result.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "kinecal/config/doubts/rising.hpp"
#include "kinecal/files/json/json_text.hpp"
#include "kinecal/report/findings.hpp"
#include "kinecal/tools/install/stored_result.hpp"

namespace kinecal::cli {

/// Why no misfit of new samples is finite.
inline constexpr const char* kBehindCamera =
    "with this result, a recorded point is behind a camera";

/// New samples and how they fit a result.
struct NewSamples {
  std::vector<Sample> samples;
  Calibration calibration;     ///< of the result's configuration, with all that may have moved
  std::vector<double> values;  ///< of the result
  double misfit = 0.0;  ///< mean square of all residuals, in standard deviations of the noise
  std::string assumed;  ///< which URDF was in force, if that matters; a sentence
  /// Blocks of the robot's own surface whose points do not lie on it where the result puts it: sentences.
  std::vector<std::string> off_robot;
  Diagnostics diagnostics;  ///< errors: nothing else is filled in

  /// The last step: the one that a result is held against.
  [[nodiscard]] const AnyProblem& problem() const { return *calibration.steps.back().problem; }
};

/// Where new samples come from.
struct NewSampleOptions {
  std::vector<std::string> samples, cameras;  ///< files; NAME=FILE
  /// before, after: without or with calibrated.urdf and the calibrated cameras in force; nullopt: what
  /// explains the samples better.
  std::optional<Recorded> recorded = {};
  double level = 0.01;                       ///< share of false alarms
  std::vector<std::string> mesh_paths = {};  ///< where the URDF's packages may be
};

/// The file beside which a result's meshes are: the URDF that was calibrated, or the copy if it is gone.
[[nodiscard]] std::string urdf_beside_meshes(const StoredResult& result);

/// Takes the result off what was recorded with it in force: offsets in <calibration rising>, and cameras.
/// @param problem  has the sensors
/// @returns  false if it changes nothing
bool take_off(const StoredResult& result, const AnyProblem& problem, std::vector<Sample>& samples);

/// The same if options say so, for results of the robot's own surface: nearest points fit before and after.
/// @returns  a sentence if it matters and options do not say it; else empty
[[nodiscard]] std::string take_off_if_after(const StoredResult& result,
                                            const NewSampleOptions& options,
                                            std::vector<Sample>& samples);

/// Reads new samples of any format; an error if there are none.
[[nodiscard]] std::vector<Sample> read_new_recordings(const NewSampleOptions& options,
                                                      Diagnostics& diagnostics);
/// The same, held against a result, and doubted.
[[nodiscard]] NewSamples read_new_samples(const StoredResult& result,
                                          const NewSampleOptions& options);
/// The same of samples that have been read.
/// @param diagnostics  of their reader
[[nodiscard]] NewSamples hold_against(const StoredResult& result, std::vector<Sample> samples,
                                      const NewSampleOptions& options,
                                      Diagnostics diagnostics = {});

/// Whether a result still holds for new samples, and what has moved.
[[nodiscard]] Drift drift_of(const StoredResult& result, const NewSamples& fresh,
                             const DriftOptions& options);

/// A result's configuration with all that may have moved, without samples.
[[nodiscard]] Calibration with_movers(const StoredResult& result);

/// Noise of the calibration and the worst feature of each new sample, by error block of the problem.
[[nodiscard]] Assessment assess_new(const StoredResult& result, const NewSamples& fresh);

/// A line for each error block: distances now, and in the calibration.
[[nodiscard]] std::string fit_text(const StoredResult& result, const NewSamples& fresh);
/// The same as a JSON list.
[[nodiscard]] detail::Json fit_json(const StoredResult& result, const NewSamples& fresh);

/// Distances of an error block: of samples that the calibration had not seen, and of new ones.
struct FitChange {
  std::string block, unit;
  /// Root of the mean square, in `unit`; of the robot's surface the noise from the median, as background counts, too.
  double then = 0.0, now = 0.0;

  [[nodiscard]] double times() const { return then > 0.0 ? now / then : 1.0; }
};
/// Those of each error block that has new features.
[[nodiscard]] std::vector<FitChange> fit_changes(const StoredResult& result,
                                                 const NewSamples& fresh);

/// The worst samples, by file and line.
[[nodiscard]] std::string worst_text(const StoredResult& result, const NewSamples& fresh);

}  // namespace kinecal::cli
