// Computes covariances.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/trust/uncertainty/uncertainty.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "kinecal/trust/uncertainty/loss_curvature.ipp"
#include "kinecal/trust/uncertainty/observability.hpp"
#include "kinecal/trust/uncertainty/weak_parameters.hpp"

namespace kinecal {

namespace detail {

/// Hessian of a robust cost, and the sum of squared gradients of its features.
struct RobustSums {
  Eigen::MatrixXd hessian, gradients;
};

[[nodiscard]] inline RobustSums robust_sums(const AnyProblem& problem, const LinearFit& fit) {
  const Eigen::Index n = fit.size();
  RobustSums sums{fit.prior_hessian, Eigen::MatrixXd::Zero(n, n)};
  for (const RowBlock& block : fit.blocks) {
    const Term& term = problem.term(block.term);
    const int size = term.feature_size;
    for (Eigen::Index row = block.first; row < block.first + block.size; row += size) {
      const auto j = fit.jacobian.middleRows(row, size);
      const auto r = fit.residual.segment(row, size);
      const Eigen::VectorXd g = j.transpose() * r;
      const double slope = fit.loss(row);
      const double curvature = curvature_of(term.options.loss, r.squaredNorm());
      sums.hessian.noalias() += slope * j.transpose() * j + 2.0 * curvature * g * g.transpose();
      sums.gradients.noalias() += slope * slope * g * g.transpose();
    }
  }
  const double rows = static_cast<double>(fit.residual.size());
  sums.gradients *= rows / std::max(1.0, rows - static_cast<double>(n));
  return sums;
}

/// V of the cost without losses and priors.
[[nodiscard]] inline Eigen::MatrixXd noise_information(const LinearFit& fit,
                                                       const std::vector<BlockNoise>& noise) {
  Eigen::VectorXd variances(fit.residual.size());
  for (const RowBlock& block : fit.blocks) {
    const double s = noise[static_cast<std::size_t>(block.term)].weighted();
    variances.segment(block.first, block.size).setConstant(s * s);
  }
  return information(fit, variances, 0.0);
}

PlainMatrix deviations(const PlainMatrix& covariance, const PlainMatrix& lost) {
  constexpr double kLost = 0.03;
  Eigen::VectorXd of = covariance.matrix().diagonal().cwiseMax(0.0).cwiseSqrt();
  for (Eigen::Index i = 0; i < of.size(); ++i) {
    if (lost(i) > kLost) of(i) = std::numeric_limits<double>::infinity();
  }
  return of;
}

void mark_undetermined(const AnyProblem& problem, const FreeSet& free, const Coordinates& by,
                       Uncertainty& known) {
  constexpr double kOff = 0.4;  // of useful_deviation()
  if (by.null.cols() == 0) return;
  Eigen::VectorXd deviation = known.deviation.matrix();
  for (Eigen::Index i = 0; i < deviation.size(); ++i) {
    // Of all undetermined combinations, the one that moves this parameter most.
    const Eigen::VectorXd along = by.null * (by.scale(i) * by.null.row(i).transpose());
    double most = 0.0;
    for (int c = 0; c < free.size(); ++c) {
      const Parameter& p = problem.table()[free.parameters()[static_cast<std::size_t>(c)]];
      most = std::max(most, std::abs(along(c)) / (kOff * useful_deviation(p)));
    }
    if (std::abs(along(i)) > most * deviation(i)) {
      deviation(i) = std::numeric_limits<double>::infinity();
    }
  }
  known.deviation = deviation;
}

}  // namespace detail

Uncertainty uncertainty(const AnyProblem& problem, const LinearFit& fit,
                        const std::vector<BlockNoise>& noise, const PoseGroups& poses,
                        const FeatureLinks& links, const Eigen::MatrixXd& of_priors) {
  const bool robust = (fit.loss.array() != 1.0).any();
  Eigen::MatrixXd hessian, middle;
  if (robust) {
    detail::RobustSums sums = detail::robust_sums(problem, fit);
    hessian = std::move(sums.hessian);
    middle = std::move(sums.gradients);
  } else {
    hessian = fit.hessian;
    middle = detail::noise_information(fit, noise);
  }
  middle += of_priors;
  const Eigen::MatrixXd inverse = detail::Spectrum(hessian).pseudo_inverse();
  const Coordinates& by = fit.coordinates;
  const GradientVariance grouped = gradient_variance(problem, fit, poses, links, middle, of_priors);
  const Eigen::MatrixXd coordinates = inverse * grouped.variance * inverse;
  const Eigen::MatrixXd covariance = by.basis * coordinates * by.basis.transpose();
  return {static_cast<int>(coordinates.rows()), covariance, detail::deviations(covariance, by.lost),
          grouped.effect, grouped.by_links};
}

std::vector<Correlation> high_correlations(const Uncertainty& known, double limit) {
  std::vector<Correlation> pairs;
  const Eigen::Index n = known.covariance.rows();
  for (Eigen::Index a = 0; a < n; ++a) {
    for (Eigen::Index b = a + 1; b < n; ++b) {
      const double product = known.covariance(a, a) * known.covariance(b, b);
      if (!(product > 0.0) || !std::isfinite(known.deviation(a) * known.deviation(b))) continue;
      const double coefficient = known.covariance(a, b) / std::sqrt(product);
      if (std::abs(coefficient) <= limit) continue;
      pairs.push_back({static_cast<int>(a), static_cast<int>(b), coefficient});
    }
  }
  std::sort(pairs.begin(), pairs.end(), [](const Correlation& x, const Correlation& y) {
    const double cx = std::abs(x.coefficient), cy = std::abs(y.coefficient);
    return cx != cy ? cx > cy : (x.a != y.a ? x.a < y.a : x.b < y.b);
  });
  return pairs;
}

}  // namespace kinecal
