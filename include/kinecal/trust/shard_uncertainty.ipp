// Definitions of shard_uncertainty.hpp.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "kinecal/evaluation/evaluate.hpp"
#include "kinecal/solve/determined_spectrum.ipp"
#include "kinecal/trust/loss_curvature.ipp"
#include "kinecal/trust/shard_uncertainty.hpp"

namespace kinecal {

namespace detail {

/// Sums over the features of a shard, or of several.
struct ShardSums {
  Eigen::MatrixXd hessian;  ///< (free x free) of the cost, priors included
  Eigen::MatrixXd scores;   ///< (free x free) of g_s g_s^T
  Eigen::MatrixXd priors;   ///< (free x free)
  Eigen::ArrayXXd blocks;   ///< (terms x 4) features, components, squares before and after
  double cost = 0.0;        ///< of the features, without priors

  ShardSums(int parameters, int terms)
      : hessian(Eigen::MatrixXd::Zero(parameters, parameters)),
        scores(hessian),
        priors(hessian),
        blocks(Eigen::ArrayXXd::Zero(terms, 4)) {}

  /// As numbers.
  [[nodiscard]] std::vector<double> packed() const {
    std::vector<double> all;
    for (const Eigen::MatrixXd* matrix : {&hessian, &scores, &priors}) {
      all.insert(all.end(), matrix->reshaped().begin(), matrix->reshaped().end());
    }
    all.insert(all.end(), blocks.reshaped().begin(), blocks.reshaped().end());
    all.push_back(cost);
    return all;
  }
  /// Adds what packed() gave.
  void add(const std::vector<double>& all) {
    const double* next = all.data();
    for (Eigen::MatrixXd* matrix : {&hessian, &scores, &priors}) {
      *matrix += Eigen::Map<const Eigen::MatrixXd>(next, matrix->rows(), matrix->cols());
      next += matrix->size();
    }
    blocks += Eigen::Map<const Eigen::ArrayXXd>(next, blocks.rows(), blocks.cols());
    cost += all.back();
  }
};

/// Adds the features of a term in a sample, and their gradient to that of the sample.
inline void add_features(const AnyTerm& term, const TermResiduals& rows, ShardSums& sums,
                         Eigen::Ref<Eigen::VectorXd> score) {
  const TermOptions& options = term.options();
  const int size = term.feature_size();
  for (Eigen::Index row = 0; row < rows.residual.size(); row += size) {
    const double weight = options.weight * rows.factor(row);
    const Eigen::VectorXd r = weight * rows.residual.segment(row, size);
    const Eigen::MatrixXd j = weight * rows.jacobian.middleRows(row, size);
    const Eigen::VectorXd g = j.transpose() * r;
    const auto [rho, slope] = options.loss(r.squaredNorm());
    const double curvature = curvature_of(options.loss, r.squaredNorm());
    sums.hessian += slope * j.transpose() * j + 2.0 * curvature * g * g.transpose();
    score += slope * g;
    sums.cost += 0.5 * rho;
  }
}

[[nodiscard]] inline ShardSums sums_of(const AnyProblem& problem, const FreeSet& free,
                                       std::span<const double> before,
                                       std::span<const double> after) {
  ShardSums sums(free.size(), problem.num_terms());
  (void)evaluate(problem, before, nullptr, [&](int t, int, const TermResiduals& rows) {
    sums.blocks(t, 2) += rows.residual.squaredNorm();
  });
  Eigen::MatrixXd scores = Eigen::MatrixXd::Zero(free.size(), problem.num_samples());
  (void)evaluate(problem, after, &free, [&](int t, int sample, const TermResiduals& rows) {
    const AnyTerm& term = problem.term(t);
    const auto components = static_cast<double>(rows.residual.size());
    sums.blocks(t, 0) += components / term.feature_size();
    sums.blocks(t, 1) += components;
    sums.blocks(t, 3) += rows.residual.squaredNorm();
    add_features(term, rows, sums, scores.col(sample));
  });
  sums.scores = scores * scores.transpose();
  sums.priors = prior_equations(problem, free, after).hessian;
  sums.hessian += sums.priors;
  return sums;
}

[[nodiscard]] inline std::vector<ShardBlock> blocks_of(const AnyProblem& problem,
                                                       const ShardSums& sums) {
  std::vector<ShardBlock> blocks;
  for (int t = 0; t < problem.num_terms(); ++t) {
    const double components = std::max(1.0, sums.blocks(t, 1));
    blocks.push_back({problem.term(t).name(), problem.term(t).options().unit, sums.blocks(t, 0),
                      std::sqrt(sums.blocks(t, 2) / components),
                      std::sqrt(sums.blocks(t, 3) / components)});
  }
  return blocks;
}

}  // namespace detail

KINECAL_INLINE ShardUncertainty shard_uncertainty(const Shards& shards, const FreeSet& free,
                                                  std::span<const double> before,
                                                  std::span<const double> after, int threads) {
  const auto numbers_of = [&](int shard) {
    return detail::sums_of(*shards.read(shard), free, before, after).packed();
  };
  detail::ShardSums sums(free.size(), shards.problem->num_terms());
  const std::string what = detail::name_at(detail::name_at("sums", free, before), free, after);
  std::vector<double> misfits;
  for (const auto& one : numbers_of_shards(shards, what, numbers_of)) {
    const double rows = sums.blocks.col(1).sum(), cost = sums.cost;
    sums.add(one);
    misfits.push_back(
        std::sqrt(2.0 * (sums.cost - cost) / std::max(1.0, sums.blocks.col(1).sum() - rows)));
  }
  const detail::ShardInformation information =
      detail::shard_information(shards, free, after, threads);
  detail::Spectrum spectrum(information.error_free);
  detail::take_away_null_of(information.error_free, information.measured.hessian, spectrum);
  const Eigen::Index rank = free.size() - spectrum.null;
  const Eigen::MatrixXd basis =
      spectrum.scale.cwiseInverse().asDiagonal() * spectrum.vectors.rightCols(rank);
  const double rows = sums.blocks.col(1).sum();
  const double freedom = rows / std::max(1.0, rows - static_cast<double>(rank));
  const Eigen::MatrixXd inverse =
      detail::Spectrum(basis.transpose() * sums.hessian * basis).pseudo_inverse();
  const Eigen::MatrixXd middle = basis.transpose() * (freedom * sums.scores + sums.priors) * basis;
  const Eigen::MatrixXd covariance = basis * inverse * middle * inverse * basis.transpose();
  ShardUncertainty known{
      static_cast<int>(rank), covariance, {}, detail::blocks_of(*shards.problem, sums), misfits};
  constexpr double kLost = 0.03;  // more than this of a parameter is not determined
  for (int i = 0; i < free.size(); ++i) {
    const bool lost = spectrum.vectors.row(i).head(spectrum.null).norm() > kLost;
    known.deviation.push_back(lost ? std::numeric_limits<double>::infinity()
                                   : std::sqrt(std::max(0.0, covariance(i, i))));
  }
  return known;
}

}  // namespace kinecal
