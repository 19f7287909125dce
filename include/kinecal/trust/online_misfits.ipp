// Samples that do not fit the others: the new one, or earlier ones.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "kinecal/geometry/median.hpp"
#include "kinecal/trust/f_distribution.hpp"
#include "kinecal/trust/online_impl.ipp"

namespace kinecal {

namespace detail {

inline constexpr std::size_t kFewestToTest = 8;  ///< samples; with fewer, none is tested

/// True if a sample is too far off for chance.  Its features share the errors of its joints, so
/// their number means little: it must also be off by several times the noise.
/// @param ratio  mean square of its residuals over that of the noise
/// @param tests  how many samples are tested
inline bool is_misfit(double ratio, double rows, double freedom, double tests) {
  constexpr double kTimes = 3.0, kOnceIn = 1e-6;
  return ratio > kTimes * kTimes && f_tail(ratio, rows, freedom) < kOnceIn / tests;
}

/// The mean square of weighted residuals that the stated sigmas allow, however small the noise is; 0 if one was
/// not stated.
inline double stated_square(const AnyProblem& problem) {
  double most = 0.0;
  for (int t = 0; t < problem.num_terms(); ++t) {
    const TermOptions& options = problem.term(t).options;
    if (!options.sigma) return 0.0;
    most = std::max(most, options.scale * options.scale);
  }
  return most;
}

}  // namespace detail

/// The worst sample, if it does not fit the others.
inline std::optional<std::size_t> OnlineCalibration::Impl::misfit(AnyEvaluator& evaluator) const {
  if (samples.size() < detail::kFewestToTest || freedom <= 0) return std::nullopt;
  std::vector<double> squares(samples.size(), 0.0), rows(samples.size(), 0.0);
  double all = problem->num_residuals();
  (void)evaluator.evaluate(values, false, [&](int term, int sample, const TermResiduals& of_term) {
    const double weight = problem->term(term).weight;
    squares[static_cast<std::size_t>(sample)] += weight * weight * of_term.residual.squaredNorm();
    const double used = of_term.used.size() > 0 ? of_term.used.sum() : 0.0;
    rows[static_cast<std::size_t>(sample)] += static_cast<double>(of_term.residual.size()) - used;
    all -= used;
  });
  std::vector<double> means;
  std::size_t worst = 0;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (!(rows[i] > 0.0)) continue;
    means.push_back(squares[i] / rows[i]);
    if (squares[i] * rows[worst] > squares[worst] * rows[i]) worst = i;
  }
  if (means.empty()) return std::nullopt;
  // The median of chi-square is about n (1 - 2 / (9 n))^3; residuals of a fit are smaller than
  // noise.
  const double n = rows[worst];
  const double usual =
      median_of(std::move(means)) / std::pow(1.0 - 2.0 / (9.0 * n), 3.0) * (all / freedom);
  if (!(usual > 0.0) || !(squares[worst] / n > detail::stated_square(*problem))) {
    return std::nullopt;
  }
  if (!detail::is_misfit(squares[worst] / n / usual, n, freedom,
                         static_cast<double>(samples.size()))) {
    return std::nullopt;
  }
  return worst;
}

/// A problem cannot drop a sample, so it is built again.
inline void OnlineCalibration::Impl::leave_out(std::size_t sample) {
  samples.erase(samples.begin() + static_cast<std::ptrdiff_t>(sample));
  numbers.erase(numbers.begin() + static_cast<std::ptrdiff_t>(sample));
  std::vector<std::vector<Pose<double>>> poses = problem->poses_of_samples();
  if (!poses.empty()) poses.erase(poses.begin() + static_cast<std::ptrdiff_t>(sample));
  problem = make();
  for (const Sample& kept : samples) problem->add_sample(kept);
  problem->set_poses_of_samples(std::move(poses));
}

inline bool OnlineCalibration::Impl::add_if_it_fits(const Sample& sample, OnlineState& state) {
  problem->add_sample(sample);
  samples.push_back(sample);
  numbers.push_back(++added);
  auto evaluator = problem->evaluator(free, 1);
  if (!std::isfinite(evaluator->normal_equations(values, false).cost)) {
    leave_out(samples.size() - 1);  // a residual is undefined: a point behind a camera
    return false;
  }
  if (samples.size() > detail::kFewestToTest && noise2 > 0.0) {
    int rows = 0;
    const double x = innovation(*evaluator, rows);
    state.times = std::sqrt(std::max(0.0, x));
    const bool is_off =
        detail::is_misfit(x, rows, freedom, 1.0) && x * noise2 > detail::stated_square(*problem);
    if (rows > 0 && (!std::isfinite(x) || is_off)) {
      leave_out(samples.size() - 1);
      return false;
    }
  }
  step_to_minimum(*evaluator);
  while (const auto worst = misfit(*evaluator)) {
    state.dropped.push_back(numbers[*worst]);
    leave_out(*worst);
    evaluator = problem->evaluator(free, 1);
    step_to_minimum(*evaluator);
  }
  std::erase(state.dropped, added);
  return !numbers.empty() && numbers.back() == added;
}

}  // namespace kinecal
