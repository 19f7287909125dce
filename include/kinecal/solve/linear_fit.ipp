// Linearizing a problem.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <stdexcept>

#include "kinecal/evaluation/any_evaluator.hpp"
#include "kinecal/solve/determined_spectrum.hpp"
#include "kinecal/solve/linear_fit.hpp"
#include "kinecal/solve/spectrum.hpp"

namespace kinecal {

namespace detail {

/// Visits all rows in the order of LinearFit, by free parameters.
inline void collect(AnyEvaluator& evaluator, ParameterValues values, bool derivatives,
                    std::vector<RowBlock>& blocks, std::vector<TermResiduals>& all) {
  const auto visit = [&](int term, int sample, const TermResiduals& rows) {
    if (rows.residual.size() == 0) return;
    blocks.push_back({term, sample, std::ssize(all), rows.residual.size()});
    all.push_back(rows);
  };
  if (const auto undefined = evaluator.evaluate(values, derivatives, visit)) {
    throw std::domain_error("the residual of '" + undefined->term +
                            "' is not defined for the sample at " + undefined->source);
  }
  std::sort(blocks.begin(), blocks.end(), [](const RowBlock& a, const RowBlock& b) {
    return a.sample != b.sample ? a.sample < b.sample : a.term < b.term;
  });
}

/// Weighted residuals of a block, and rho' of its features.
inline void weigh(const Term& term, const TermResiduals& rows, Eigen::Ref<Eigen::VectorXd> r,
                  Eigen::Ref<Eigen::VectorXd> loss) {
  r = term.weight * rows.factor.cwiseProduct(rows.residual);
  const int size = term.feature_size;
  for (Eigen::Index row = 0; row < r.size(); row += size) {
    loss.segment(row, size).setConstant(
        term.options.loss(r.segment(row, size).squaredNorm()).derivative);
  }
}

KINECAL_INLINE Coordinates coordinates_of(const SampleInformation& samples) {
  const Spectrum spectrum = determined_spectrum(samples, Priors::count);
  const auto in_units = spectrum.scale.cwiseInverse().asDiagonal();
  return {in_units * spectrum.vectors.rightCols(spectrum.singular.size() - spectrum.null),
          in_units * spectrum.vectors.leftCols(spectrum.null),
          spectrum.vectors.leftCols(spectrum.null).rowwise().norm(), spectrum.scale};
}

}  // namespace detail

KINECAL_INLINE Coordinates determined_coordinates(const AnyProblem& problem, const FreeSet& free,
                                                  ParameterValues values) {
  return detail::coordinates_of(detail::sample_information(problem, free, values));
}

KINECAL_INLINE LinearFit linear_rows(AnyEvaluator& evaluator, ParameterValues values,
                                     const Coordinates& coordinates, bool derivatives) {
  LinearFit fit;
  fit.coordinates = coordinates;
  const Eigen::MatrixXd& basis = coordinates.basis;
  std::vector<TermResiduals> all;
  detail::collect(evaluator, values, derivatives, fit.blocks, all);
  Eigen::Index rows = 0;
  for (const RowBlock& block : fit.blocks) rows += block.size;
  fit.residual.resize(rows);
  fit.loss.resize(rows);
  fit.used.setZero(rows);
  fit.jacobian.resize(derivatives ? rows : 0, derivatives ? basis.cols() : 0);
  Eigen::Index first = 0;
  for (RowBlock& block : fit.blocks) {
    const TermResiduals& from = all[static_cast<std::size_t>(block.first)];
    const Term& term = evaluator.problem().term(block.term);
    detail::weigh(term, from, fit.residual.segment(first, block.size),
                  fit.loss.segment(first, block.size));
    if (from.used.size() > 0) fit.used.segment(first, block.size) = from.used;
    if (derivatives) {
      const Eigen::VectorXd weights = term.weight * from.factor;
      const std::vector<int> columns = detail::nonzero_columns(from.jacobian);
      const Eigen::MatrixXd weighted = weights.asDiagonal() * from.jacobian(Eigen::all, columns);
      const Eigen::MatrixXd by = basis(columns, Eigen::all);
      fit.jacobian.middleRows(first, block.size).noalias() = weighted * by;
    }
    block.first = first;
    first += block.size;
  }
  const NormalEquations priors =
      detail::prior_equations(evaluator.problem(), evaluator.free(), values);
  fit.prior_gradient = basis.transpose() * priors.gradient;
  fit.prior_hessian = basis.transpose() * priors.hessian * basis;
  return fit;
}

KINECAL_INLINE LinearFit linear_fit(AnyEvaluator& evaluator, ParameterValues values,
                                    const Coordinates& coordinates, bool derivatives) {
  LinearFit fit = linear_rows(evaluator, values, coordinates, derivatives);
  if (derivatives) fit.hessian = information(fit, fit.loss);
  return fit;
}

KINECAL_INLINE Eigen::MatrixXd information(const LinearFit& fit, const Eigen::VectorXd& weights,
                                           double priors) {
  constexpr Eigen::Index kAtOnce = 256;  // weighted rows that stay in the cache
  Eigen::MatrixXd sum = priors * fit.prior_hessian;
  LinearFit::RowMajor weighted;
  for (Eigen::Index first = 0; first < weights.size(); first += kAtOnce) {
    const Eigen::Index size = std::min(kAtOnce, weights.size() - first);
    weighted = weights.segment(first, size).cwiseSqrt().asDiagonal() *
               fit.jacobian.middleRows(first, size);
    sum.selfadjointView<Eigen::Lower>().rankUpdate(weighted.transpose());
  }
  return sum.selfadjointView<Eigen::Lower>();
}

KINECAL_INLINE RowSums::RowSums(Eigen::Index coordinates)
    : information(Eigen::MatrixXd::Zero(coordinates, coordinates)),
      gradient(Eigen::VectorXd::Zero(coordinates)) {}

KINECAL_INLINE RowSums& RowSums::operator+=(const RowSums& other) {
  information += other.information;
  gradient += other.gradient;
  return *this;
}

KINECAL_INLINE RowSums row_sums(const LinearFit& fit, const RowBlock& block,
                                const Eigen::VectorXd& weights, const Eigen::VectorXd& residual) {
  const auto rows = fit.jacobian.middleRows(block.first, block.size);
  const auto of_rows = weights.segment(block.first, block.size);
  RowSums sums(fit.size());
  const LinearFit::RowMajor weighted = of_rows.cwiseSqrt().asDiagonal() * rows;
  Eigen::MatrixXd lower = sums.information;
  lower.selfadjointView<Eigen::Lower>().rankUpdate(weighted.transpose());
  sums.information = lower.selfadjointView<Eigen::Lower>();
  sums.gradient.noalias() =
      rows.transpose() * of_rows.cwiseProduct(residual.segment(block.first, block.size));
  return sums;
}

KINECAL_INLINE std::vector<RowSums> sums_without_parts(const LinearFit& fit,
                                                       const Eigen::VectorXd& weights,
                                                       const std::vector<int>& part) {
  const int last = part.empty() ? -1 : *std::max_element(part.begin(), part.end());
  const auto parts = static_cast<std::size_t>(last + 1);
  std::vector<RowSums> own(parts, RowSums(fit.size()));
  RowSums before(fit.size());  // of rows in no part, then of the parts before one, too
  for (const RowBlock& block : fit.blocks) {
    const int of = part[static_cast<std::size_t>(block.sample)];
    RowSums& sums = of < 0 ? before : own[static_cast<std::size_t>(of)];
    sums += row_sums(fit, block, weights, fit.residual);
  }
  std::vector<RowSums> without(parts, RowSums(fit.size()));
  for (std::size_t p = parts; p-- > 1;) {  // of the parts after one
    without[p - 1] = without[p];
    without[p - 1] += own[p];
  }
  for (std::size_t p = 0; p < parts; ++p) {
    without[p] += before;
    before += own[p];
  }
  return without;
}

KINECAL_INLINE Eigen::VectorXd step_to_minimum(const LinearFit& fit, const RowSums& sums,
                                               double priors) {
  const detail::Spectrum spectrum(sums.information + priors * fit.prior_hessian);
  return -spectrum.pseudo_inverse() * (sums.gradient + priors * fit.prior_gradient);
}

KINECAL_INLINE Eigen::VectorXd step_to_minimum(const LinearFit& fit, const Eigen::VectorXd& weights,
                                               double priors) {
  RowSums sums(fit.size());
  sums.information = information(fit, weights, 0.0);
  sums.gradient = fit.jacobian.transpose() * weights.cwiseProduct(fit.residual);
  return step_to_minimum(fit, sums, priors);
}

KINECAL_INLINE Eigen::VectorXd stepped(const LinearFit& fit, const FreeSet& free,
                                       ParameterValues values, const Eigen::VectorXd& step) {
  Eigen::VectorXd all =
      Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
  const Eigen::VectorXd change = fit.coordinates.basis * step;
  for (int c = 0; c < free.size(); ++c) {
    all(free.parameters()[static_cast<std::size_t>(c)]) += change(c);
  }
  return all;
}

namespace detail {

/// Halves the step until the weighted cost falls.
/// @returns  false if it does not fall
inline bool descend(AnyEvaluator& evaluator, const LinearFit& fit, const Eigen::VectorXd& weights,
                    double priors, double settled, Eigen::VectorXd step, Refit& at) {
  const auto cost = [&](const LinearFit& of, const Eigen::VectorXd& values) {
    const double of_priors =
        prior_equations(evaluator.problem(), evaluator.free(), numbers(values)).cost;
    return 0.5 * weights.dot(of.residual.cwiseAbs2()) + priors * of_priors;
  };
  const double before = cost(fit, at.values);
  constexpr int kHalvings = 12;
  for (int i = 0; i < kHalvings; ++i, step *= 0.5) {
    const Eigen::VectorXd values = stepped(fit, evaluator.free(), numbers(at.values), step);
    try {
      const LinearFit there = linear_rows(evaluator, numbers(values), fit.coordinates, false);
      const double after = cost(there, values);
      if (!(after <= before)) continue;
      at = {values, there.residual};
      return before - after > settled * before;
    } catch (const std::domain_error&) {  // a point behind a camera
    }
  }
  return false;
}

}  // namespace detail

KINECAL_INLINE Refit refit(AnyEvaluator& evaluator, ParameterValues values, const LinearFit& fit,
                           const Eigen::VectorXd& weights, const Eigen::VectorXd& first,
                           double priors, double settled) {
  Refit at{Eigen::Map<const Eigen::VectorXd>(values.data(), std::ssize(values)), fit.residual};
  bool falls = detail::descend(evaluator, fit, weights, priors, settled, first, at);
  constexpr int kSteps = 10;
  for (int i = 1; falls && i < kSteps; ++i) {
    // The linearization predicted this result well: no further step is needed.
    const Eigen::VectorXd promised = fit.residual + fit.jacobian * first;
    const double off = (promised - at.residual).squaredNorm();
    if (i == 1 && off < settled * at.residual.squaredNorm()) break;
    const LinearFit next =
        linear_rows(evaluator, detail::numbers(at.values), fit.coordinates, true);
    falls = detail::descend(evaluator, next, weights, priors, settled,
                            step_to_minimum(next, weights, priors), at);
  }
  return at;
}

}  // namespace kinecal
