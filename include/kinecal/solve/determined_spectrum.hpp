// The spectrum of what samples determine, at both error-free and measured points.
//
// The error-free problem moves a measured point to where the model predicts it.  If the point is
// known, not measured, this overstates the information: sockets on one line, moved off it by the
// residuals, seem to determine the rotation about it.  So a direction without effect on the
// measured points counts as undetermined, too.
// points is not determined either.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <span>

#include "kinecal/evaluation/any_evaluator.hpp"
#include "kinecal/geometry/eigenpairs.hpp"
#include "kinecal/solve/spectrum.hpp"

namespace kinecal::detail {

[[nodiscard]] inline std::span<const double> numbers(const Eigen::VectorXd& values) {
  return {values.data(), static_cast<std::size_t>(values.size())};
}

/// The information that remains in other directions if some directions are open, in the worst case.
/// @param open  (n x k) orthonormal
[[nodiscard]] inline Eigen::MatrixXd beside(const Eigen::MatrixXd& information,
                                            const Eigen::MatrixXd& open) {
  if (open.cols() == 0) return information;
  const Eigen::MatrixXd across = information * open;
  const Eigenpairs pairs = eigenpairs(open.transpose() * across);
  constexpr double kNothing = 1e-10;  // of the largest: residuals are 1e-5 of the robot's size
  const double least = kNothing * information.diagonal().maxCoeff();
  const Eigen::VectorXd inverse =
      pairs.values.unaryExpr([&](double value) { return value > least ? 1.0 / value : 0.0; });
  const Eigen::MatrixXd by = across * pairs.vectors;
  return information - by * inverse.asDiagonal() * by.transpose();
}

/// Removes directions without effect on the measured points from those that a spectrum determines.
/// @param error_free  (n x n) information that the spectrum is of
/// @param measured    (n x n) information at the measured points
inline void take_away_null_of(const Eigen::MatrixXd& error_free, const Eigen::MatrixXd& measured,
                              Spectrum& spectrum) {
  const Eigen::Index rank = spectrum.singular.size() - spectrum.null;
  if (rank == 0) return;
  const Eigen::MatrixXd basis = spectrum.vectors.rightCols(rank);
  const Eigen::VectorXd units = spectrum.scale.cwiseInverse();
  const auto scaled = [&](const Eigen::MatrixXd& information) {
    return Eigen::MatrixXd(units.asDiagonal() * information * units.asDiagonal());
  };
  const Eigen::MatrixXd left = beside(scaled(measured), spectrum.vectors.leftCols(spectrum.null));
  const Eigenpairs pairs = eigenpairs(basis.transpose() * left * basis);
  const double least = kUnobservable * kUnobservable * pairs.values.maxCoeff();
  const Eigen::Index lost = (pairs.values.array() <= least).count();
  if (lost == 0 || lost == rank) return;
  const Eigen::MatrixXd kept = basis * pairs.vectors.rightCols(rank - lost);
  const Eigenpairs of_kept = eigenpairs(kept.transpose() * scaled(error_free) * kept);
  spectrum.vectors.middleCols(spectrum.null, lost) = basis * pairs.vectors.leftCols(lost);
  spectrum.vectors.rightCols(rank - lost) = kept * of_kept.vectors;
  spectrum.singular.segment(spectrum.null, lost).setZero();
  spectrum.singular.tail(rank - lost) = of_kept.values.cwiseMax(0.0).cwiseSqrt();
  spectrum.null += lost;
}

/// Gradient and Hessian of a problem's priors.
[[nodiscard]] inline NormalEquations prior_equations(const AnyProblem& problem, const FreeSet& free,
                                                     ParameterValues values) {
  NormalEquations sums(free.size());
  TermResiduals rows;
  for (const PriorTerm& prior : problem.priors()) {
    prior.evaluate(problem.table(), values, &free, rows);
    sums.add_prior(prior, rows, problem.num_samples(), Losses::as_given);
  }
  return sums;
}

/// The spectrum of what samples determine.
[[nodiscard]] inline Spectrum determined_spectrum(const SampleInformation& samples, Priors priors) {
  const double counted = priors == Priors::count ? 1.0 : 0.0;
  const Eigen::MatrixXd error_free = samples.error_free + counted * samples.priors;
  Spectrum spectrum(error_free);
  if (std::isfinite(samples.measured.cost)) {  // else a residual is undefined
    take_away_null_of(error_free, samples.measured.hessian - (1.0 - counted) * samples.priors,
                      spectrum);
  }
  return spectrum;
}

/// The information of a problem's samples.
[[nodiscard]] inline SampleInformation sample_information(const AnyProblem& problem,
                                                          const FreeSet& free,
                                                          ParameterValues values) {
  return {problem.evaluator(free, 1)->normal_equations(values),
          error_free_information(problem, free, values),
          prior_equations(problem, free, values).hessian};
}

}  // namespace kinecal::detail
