// Calibrating with a crate: samples in, values with the names of its types out.
//
//   const CrateResult<HandEye> result = calibrate(HandEye(), samples);
//   const double elbow = result.value<JointOffset<"elbow_flex_joint">>();
//
//   ParameterTable table = HandEye::table(samples);     // initial values and bounds, where zero
//   table["elbow_flex_joint"].upper = 0.05;             // and none do not do
//   const CrateResult<HandEye> bounded = calibrate(HandEye(), table, samples);
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/crate/crate.hpp"
#include "kinecal/solve/calibrate.hpp"

namespace kinecal {

template <class C>
struct CrateResult : CalibrationResult {
  /// What was found for a free parameter: a number, or (N) in the order of its names.
  template <FreeParameter P>
  [[nodiscard]] auto value() const {
    using Owner = LookedUp<P::kOwner, typename C::Free>;
    constexpr bool kIsFree = C::Free::template have<P>();
    [[maybe_unused]] constexpr detail::Unless<kIsFree, detail::ValueOf<P, Owner>> kCheck = {};
    if constexpr (!kIsFree) {
      return 0.0;
    } else if constexpr (P::kIds.size() == 1) {
      return table[P::kIds[0].name()].value;
    } else {
      Eigen::Matrix<double, static_cast<int>(P::kIds.size()), 1> all;
      for (std::size_t i = 0; i < P::kIds.size(); ++i) {
        all(static_cast<Eigen::Index>(i)) = table[P::kIds[i].name()].value;
      }
      return all;
    }
  }
};

/// The calibration of one step that solves a problem with these samples.  Free parameters on which
/// no residual of them depends keep their initial values.
/// @param problem  without samples
/// @throws SampleError  naming the sample and what is missing or wrong in it
/// @throws std::invalid_argument  if there are no samples that a block could take
[[nodiscard]] inline Calibration make_calibration(Problem problem, const FreeSet& free,
                                                  std::span<const Sample> samples,
                                                  const std::string& step = "calibration") {
  for (const Sample& sample : samples) problem.add_sample(sample);
  const std::vector<int> touched = problem.touched_parameters();
  if (touched.empty()) {
    throw std::invalid_argument("no sample has usable features of all sensors of an error block");
  }
  std::vector<int> told = free.parameters();
  std::erase_if(told,
                [&](int p) { return !std::binary_search(touched.begin(), touched.end(), p); });
  Calibration calibration{problem.table(), {}};
  FreeSet columns(std::move(told), calibration.table.size());
  calibration.steps.push_back(
      {step, SolveOptions{}.max_num_iterations, std::move(problem), std::move(columns), {}});
  return calibration;
}

/// The calibration that a crate stands for; with it, reports and result files are made as those of
/// the program.
/// @param table  C::table(samples), perhaps with other initial values or bounds
/// @throws  as above
template <class... Parts>
[[nodiscard]] Calibration make_calibration(const Crate<Parts...>& crate,
                                           const ParameterTable& table,
                                           std::span<const Sample> samples,
                                           const std::string& step = "calibration") {
  return make_calibration(crate.problem(table), Crate<Parts...>::free(table), samples, step);
}
template <class... Parts>
[[nodiscard]] Calibration make_calibration(const Crate<Parts...>& crate,
                                           std::span<const Sample> samples,
                                           const std::string& step = "calibration") {
  return make_calibration(crate, Crate<Parts...>::table(samples), samples, step);
}

/// Makes the calibration of a crate and solves it.
/// @param table  as above
/// @throws  as make_calibration()
template <class... Parts>
[[nodiscard]] CrateResult<Crate<Parts...>> calibrate(const Crate<Parts...>& crate,
                                                     const ParameterTable& table,
                                                     std::span<const Sample> samples,
                                                     const SolveOptions& options = {}) {
  Calibration calibration = make_calibration(crate, table, samples);
  calibration.steps.front().max_num_iterations = options.max_num_iterations;
  return {calibrate(calibration, {}, options)};
}
template <class... Parts>
[[nodiscard]] CrateResult<Crate<Parts...>> calibrate(const Crate<Parts...>& crate,
                                                     std::span<const Sample> samples,
                                                     const SolveOptions& options = {}) {
  return calibrate(crate, Crate<Parts...>::table(samples), samples, options);
}

}  // namespace kinecal
