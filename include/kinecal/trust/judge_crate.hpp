// Calibrating and judging with a crate: samples in; values, their +- and a verdict out.
//
//   const JudgedCrate<HandEye> judged = calibrate_and_judge(HandEye(), samples);
//   const double elbow = judged.value<JointOffset<"elbow_flex_joint">>();
//   const double plus_minus = judged.deviation<JointOffset<"elbow_flex_joint">>();
//   for (const LeftOutSample& sample : judged.left_out) ...
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>

#include "kinecal/solve/calibrate_crate.hpp"
#include "kinecal/trust/calibrate_and_judge.hpp"

namespace kinecal {

/// A judged result of a crate.
/// @tparam C  the crate
template <class C>
struct JudgedCrate : JudgedResult {
  /// The calibrated value of a free parameter: a number, or (N) in the order of its names.
  template <FreeParameter P>
  [[nodiscard]] auto value() const {
    return detail::numbers_of<C, P>(
        [&](const std::string& name) { return result.table[name].value; });
  }
  /// Its standard deviation; infinite where the samples do not determine it.
  template <FreeParameter P>
  [[nodiscard]] auto deviation() const {
    return detail::numbers_of<C, P>([&](const std::string& name) {
      return JudgedResult::deviation(result.table.index(name))
          .value_or(std::numeric_limits<double>::infinity());
    });
  }
};

/// Makes the calibration of a crate, calibrates and judges.
/// @param table  Crate().table(samples), perhaps with other initial values or bounds
/// @throws SampleError, std::invalid_argument  as make_calibration()
template <class... Parts>
[[nodiscard]] JudgedCrate<Crate<Parts...>> calibrate_and_judge(
    const Crate<Parts...>& crate, const ParameterTable& table, std::span<const Sample> samples,
    const ProcedureOptions& options = {}) {
  Calibration calibration = make_calibration(crate, table, samples);
  calibration.steps.front().max_num_iterations = options.solving.max_num_iterations;
  return {calibrate_and_judge(calibration, samples, options)};
}
/// The same with the initial values and bounds of Crate().table(samples).
template <class... Parts>
[[nodiscard]] JudgedCrate<Crate<Parts...>> calibrate_and_judge(
    const Crate<Parts...>& crate, std::span<const Sample> samples,
    const ProcedureOptions& options = {}) {
  return calibrate_and_judge(crate, crate.table(samples), samples, options);
}

}  // namespace kinecal
