// The procedure of calibrate_robot.hpp for a crate: samples in; values, their +-, a verdict and its causes out.
//
//   const JudgedCrate<HandEye> judged = calibrate_and_judge(HandEye(), samples);
//   const double elbow = judged.value<JointOffset<"elbow_flex_joint">>();
//   const double plus_minus = judged.deviation<JointOffset<"elbow_flex_joint">>();
//   puts(findings_text(judged).c_str());
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "kinecal/files/urdf/read_urdf.hpp"
#include "kinecal/procedure/calibrate_robot.hpp"
#include "kinecal/procedure/crate_config.hpp"
#include "kinecal/solve/calibrate_crate.hpp"

namespace kinecal {

/// A judged result of a crate.
/// @tparam C  the crate
template <class C>
struct JudgedCrate : CalibratedRobot {
  /// The calibrated value of a free parameter: a number, or (N) in the order of its names.
  template <FreeParameter P>
  [[nodiscard]] auto value() const {
    return detail::numbers_of<C, P>(
        [&](const std::string& name) { return this->result.table[name].value; });
  }
  /// Its standard deviation; infinite where the samples do not determine it.
  template <FreeParameter P>
  [[nodiscard]] auto deviation() const {
    return detail::numbers_of<C, P>([&](const std::string& name) {
      return JudgedResult::deviation(this->result.table.index(name))
          .value_or(std::numeric_limits<double>::infinity());
    });
  }
};

namespace detail {

/// Where a calibration begins, in the order of another table.
[[nodiscard]] inline std::vector<double> begin_of(const Calibration& calibration,
                                                  const ParameterTable& table) {
  std::vector<double> begin;
  for (int p = 0; p < table.size(); ++p) {
    const int from = calibration.table.find(table[p].name);
    begin.push_back(from < 0 ? table[p].value : calibration.begin[static_cast<std::size_t>(from)]);
  }
  return begin;
}

}  // namespace detail

/// Prepares the calibration of a crate: its own problem, and the configuration of the same for what finds mistakes.
/// @param table      Crate().table(samples), perhaps with other initial values or bounds
/// @param urdf_text  of the robot, with the limits of its joints and its meshes; empty: the robot as the crate knows it
/// @param urdf       its file, beside which its meshes are
/// @throws InputError  as make_calibration(), whose sentence it has
template <class... Parts>
[[nodiscard]] PreparedCalibration prepare(const Crate<Parts...>& crate, const ParameterTable& table,
                                          std::span<const Sample> samples,
                                          const CalibrationOptions& options = {},
                                          const std::string& urdf_text = "",
                                          const std::string& urdf = CalibrationSetup{}.urdf) {
  CalibrationOptions as_given = options;
  as_given.search = Search::never;
  CalibrationSetup setup{
      .robot = urdf_text.empty() ? Crate<Parts...>::robot() : parse_urdf(urdf_text, urdf),
      .config = config_of(crate, table),
      .samples = {samples.begin(), samples.end()},
      .urdf_text = urdf_text,
      .urdf = urdf};
  detail::keep_associations(setup.samples, *setup.config);
  PreparedCalibration prepared = prepare(std::move(setup), as_given);
  if (!prepared.diagnostics.errors.empty()) return prepared;
  const Calibration assembled = std::move(prepared.calibration);
  prepared.calibration =
      detail::as_input_error([&] { return make_calibration(crate, table, prepared.samples); });
  if (!assembled.begin.empty()) {  // association has found where to begin
    prepared.calibration.begin = detail::begin_of(assembled, table);
    prepared.calibration.steps.front().unknown_frames = assembled.steps.front().unknown_frames;
  }
  prepared.calibration.steps.front().max_num_iterations = options.solving.max_num_iterations;
  return prepared;
}

/// Calibrates and judges a crate.
/// @param table  Crate().table(samples), perhaps with other initial values or bounds
/// @throws InputError  as calibrate_robot()
template <class... Parts>
[[nodiscard]] JudgedCrate<Crate<Parts...>> calibrate_and_judge(
    const Crate<Parts...>& crate, const ParameterTable& table, std::span<const Sample> samples,
    const CalibrationOptions& options = {}, const std::string& urdf_text = "",
    const std::string& urdf = CalibrationSetup{}.urdf) {
  return {calibrate_robot(prepare(crate, table, samples, options, urdf_text, urdf), options)};
}
/// The same with the initial values and bounds of Crate().table(samples).
template <class... Parts>
[[nodiscard]] JudgedCrate<Crate<Parts...>> calibrate_and_judge(
    const Crate<Parts...>& crate, std::span<const Sample> samples,
    const CalibrationOptions& options = {}, const std::string& urdf_text = "",
    const std::string& urdf = CalibrationSetup{}.urdf) {
  return calibrate_and_judge(crate, crate.table(samples), samples, options, urdf_text, urdf);
}

}  // namespace kinecal
