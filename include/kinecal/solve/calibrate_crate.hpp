// Calibrates with a crate: samples in, values by the names of its types out.
//
//   const CrateResult<HandEye> result = calibrate(HandEye(), samples);
//   const double elbow = result.value<JointOffset<"elbow_flex_joint">>();
//
//   ParameterTable table = HandEye().table(samples);     // for other initial values, or bounds
//   table["elbow_flex_joint"].value = 0.03;              // where it starts
//   table["elbow_flex_joint"].upper = 0.05;
//   const CrateResult<HandEye> bounded = calibrate(HandEye(), table, samples);
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/crate/crate.hpp"
#include "kinecal/solve/calibrate.hpp"

namespace kinecal {

namespace detail {

/// Numbers of a free parameter of the crate C: one, or (N) in the order of its names.
/// @param number_of  takes a name
template <class C, FreeParameter P, class NumberOf>
[[nodiscard]] auto numbers_of(const NumberOf& number_of) {
  using Owner = LookedUp<P::kOwner, typename C::Free>;
  constexpr bool kIsFree = C::Free::template have<P>();
  [[maybe_unused]] constexpr Unless<kIsFree, ValueOf<P, Owner>> kCheck = {};
  if constexpr (!kIsFree) {
    return 0.0;
  } else if constexpr (P::kIds.size() == 1) {
    return number_of(P::kIds[0].name());
  } else {
    Eigen::Matrix<double, static_cast<int>(P::kIds.size()), 1> all;
    for (std::size_t i = 0; i < P::kIds.size(); ++i) {
      all(static_cast<Eigen::Index>(i)) = number_of(P::kIds[i].name());
    }
    return all;
  }
}

}  // namespace detail

/// The result of calibrating a crate.
/// @tparam C  the crate
template <class C>
struct CrateResult : CalibrationResult {
  /// The calibrated value of a free parameter: a number, or (N) in the order of its names.
  template <FreeParameter P>
  [[nodiscard]] auto value() const {
    return detail::numbers_of<C, P>([&](const std::string& name) { return table[name].value; });
  }
};

/// The calibration that a crate describes.  You can make reports and result files from it, as the
/// program does.
/// @param table  Crate().table(samples), perhaps with other initial values or bounds
/// @throws SampleError, std::invalid_argument  as make_calibration() of a problem
template <class... Parts>
[[nodiscard]] Calibration make_calibration(const Crate<Parts...>& crate,
                                           const ParameterTable& table,
                                           std::span<const Sample> samples,
                                           const std::string& step = "calibration") {
  return make_calibration(std::make_unique<Problem>(crate.problem(table)),
                          Crate<Parts...>::free(table), samples, step);
}
/// The same with the initial values and bounds of Crate().table(samples).
template <class... Parts>
[[nodiscard]] Calibration make_calibration(const Crate<Parts...>& crate,
                                           std::span<const Sample> samples,
                                           const std::string& step = "calibration") {
  return make_calibration(crate, crate.table(samples), samples, step);
}

/// Makes the calibration of a crate and solves it.
/// @param table  Crate().table(samples), perhaps with other initial values or bounds
/// @throws SampleError, std::invalid_argument  as make_calibration()
template <class... Parts>
[[nodiscard]] CrateResult<Crate<Parts...>> calibrate(const Crate<Parts...>& crate,
                                                     const ParameterTable& table,
                                                     std::span<const Sample> samples,
                                                     const SolveOptions& options = {}) {
  Calibration calibration = make_calibration(crate, table, samples);
  calibration.steps.front().max_num_iterations = options.max_num_iterations;
  return {calibrate(calibration, {}, options)};
}
/// The same with the initial values and bounds of Crate().table(samples).
template <class... Parts>
[[nodiscard]] CrateResult<Crate<Parts...>> calibrate(const Crate<Parts...>& crate,
                                                     std::span<const Sample> samples,
                                                     const SolveOptions& options = {}) {
  return calibrate(crate, crate.table(samples), samples, options);
}

}  // namespace kinecal
