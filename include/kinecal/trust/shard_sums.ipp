// Sums over the features of a shard for the assessment of a result.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <span>
#include <stdexcept>
#include <vector>

#include "kinecal/evaluation/any_evaluator.hpp"
#include "kinecal/solve/determined_spectrum.ipp"
#include "kinecal/solve/statistics.hpp"
#include "kinecal/trust/loss_curvature.ipp"

namespace kinecal::detail {

/// Distances of features, in bins of equal ratio: their median to 0.3 %.
struct DistanceBins {
  static constexpr double kLeast = 1e-12, kPerDecade = 500.0;
  static constexpr Eigen::Index kBins = 8500;  ///< up to 1e5

  [[nodiscard]] static Eigen::Index of(double distance) {
    if (!(distance > kLeast)) return 0;
    const auto bin = static_cast<Eigen::Index>(kPerDecade * std::log10(distance / kLeast));
    return std::min(bin, kBins - 1);
  }
  [[nodiscard]] static double median(const Eigen::Ref<const Eigen::VectorXd>& counts) {
    const double half = 0.5 * counts.sum();
    double below = 0.0;
    Eigen::Index bin = 0;
    while (bin + 1 < counts.size() && below + counts(bin) < half) below += counts(bin++);
    return bin == 0 ? 0.0 : kLeast * std::pow(10.0, (static_cast<double>(bin) + 0.5) / kPerDecade);
  }
};

/// Sums of one error block.
struct BlockSums {
  Eigen::MatrixXd information;  ///< (free x free) sum of rho' w^2 J^T J
  Eigen::MatrixXd bins;         ///< (bins x 3) distances before, after, and after over sigma
  /// Number of features; sums of distances, squared components and the largest distance, before and
  /// after; squares of weighted residuals with their losses, and the largest, not squared; rows that samples' own poses use
  /// up.
  Eigen::VectorXd figures;

  enum Figure {
    features,
    mean_before,
    squares_before,
    max_before,
    mean_after,
    squares_after,
    max_after,
    weighted,
    max_weighted,
    used,
    kFigures
  };

  explicit BlockSums(int parameters)
      : information(Eigen::MatrixXd::Zero(parameters, parameters)),
        bins(Eigen::MatrixXd::Zero(DistanceBins::kBins, 3)),
        figures(Eigen::VectorXd::Zero(kFigures)) {}

  /// False for the largest distances, which are not sums.
  [[nodiscard]] static bool is_sum(Eigen::Index figure) {
    return figure != max_before && figure != max_after && figure != max_weighted;
  }
  [[nodiscard]] Statistics statistics(Figure mean, Eigen::Index column) const {
    const double count = std::max(1.0, figures(features));
    return {std::sqrt(figures(mean + 1) / count), figures(mean) / count,
            DistanceBins::median(bins.col(column)), figures(mean + 2)};
  }
};

/// Sums over the features of a shard, or of several.
struct ShardSums {
  Eigen::MatrixXd hessian;        ///< (free x free) of the cost, priors included
  Eigen::MatrixXd scores;         ///< (free x free) of g_s g_s^T
  Eigen::MatrixXd priors;         ///< (free x free)
  std::vector<BlockSums> blocks;  ///< of each term
  double cost = 0.0;              ///< of the features, without priors

  ShardSums(int parameters, int terms)
      : hessian(Eigen::MatrixXd::Zero(parameters, parameters)),
        scores(hessian),
        priors(hessian),
        blocks(static_cast<std::size_t>(terms), BlockSums(parameters)) {}

  /// Calls a function with each matrix.
  template <class Sums, class Call>
  static void for_each(Sums& sums, Call&& call) {
    call(sums.hessian);
    call(sums.scores);
    call(sums.priors);
    for (auto& block : sums.blocks) {
      call(block.information);
      call(block.bins);
    }
  }

  /// As numbers.
  [[nodiscard]] std::vector<double> packed() const {
    std::vector<double> all;
    for_each(*this, [&](const Eigen::MatrixXd& matrix) {
      all.insert(all.end(), matrix.reshaped().begin(), matrix.reshaped().end());
    });
    for (const BlockSums& block : blocks) {
      all.insert(all.end(), block.figures.begin(), block.figures.end());
    }
    all.push_back(cost);
    return all;
  }
  /// Adds the result of packed().
  /// @throws std::invalid_argument  if the number of values is wrong
  void add(const std::vector<double>& all) {
    if (all.size() != packed().size()) throw std::invalid_argument("sums of another problem");
    const double* next = all.data();
    for_each(*this, [&](Eigen::MatrixXd& matrix) {
      matrix += Eigen::Map<const Eigen::MatrixXd>(next, matrix.rows(), matrix.cols());
      next += matrix.size();
    });
    for (BlockSums& block : blocks) {
      for (Eigen::Index i = 0; i < block.figures.size(); ++i, ++next) {
        double& figure = block.figures(i);
        figure = BlockSums::is_sum(i) ? figure + *next : std::max(figure, *next);
      }
    }
    cost += all.back();
  }
};

/// Adds the sizes of residuals.
inline void add_distances(const Term& term, const TermResiduals& rows, BlockSums::Figure mean,
                          Eigen::Index column, BlockSums& block) {
  const int size = term.feature_size;
  for (Eigen::Index row = 0; row < rows.residual.size(); row += size) {
    const double distance = rows.residual.segment(row, size).norm();
    block.figures(mean) += distance;
    block.figures(mean + 1) += distance * distance;
    block.figures(mean + 2) = std::max(block.figures(mean + 2), distance);
    block.bins(DistanceBins::of(distance), column) += 1.0;
  }
}

/// Adds the features of a term in a sample, and their gradient to that of the sample.
inline void add_features(const Term& term, const TermResiduals& rows, ShardSums& sums,
                         BlockSums& block, Eigen::Ref<Eigen::VectorXd> score) {
  const Loss& loss = term.options.loss;
  const int size = term.feature_size;
  block.figures(BlockSums::used) += rows.used.sum();
  for (Eigen::Index row = 0; row < rows.residual.size(); row += size) {
    const double weight = term.weight * rows.factor(row);
    const Eigen::VectorXd r = weight * rows.residual.segment(row, size);
    const Eigen::MatrixXd j = weight * rows.jacobian.middleRows(row, size);
    const Eigen::VectorXd g = j.transpose() * r;
    const auto [rho, slope] = loss(r.squaredNorm());
    const Eigen::MatrixXd information = slope * j.transpose() * j;
    block.information += information;
    sums.hessian += information + 2.0 * curvature_of(loss, r.squaredNorm()) * g * g.transpose();
    score += slope * g;
    sums.cost += 0.5 * rho;
    block.figures(BlockSums::features) += 1.0;
    const double weighted = slope * r.squaredNorm();
    double& largest = block.figures(BlockSums::max_weighted);
    block.figures(BlockSums::weighted) += weighted;
    largest = std::max(largest, std::sqrt(weighted));
    block.bins(DistanceBins::of(r.norm() / term.weight), 2) += 1.0;
  }
}

[[nodiscard]] inline ShardSums sums_of(const AnyProblem& problem, const FreeSet& free,
                                       ParameterValues before, ParameterValues after) {
  ShardSums sums(free.size(), problem.num_terms());
  const auto block = [&](int t) -> BlockSums& { return sums.blocks[static_cast<std::size_t>(t)]; };
  (void)evaluate(problem, before, nullptr, [&](int t, int, const TermResiduals& rows) {
    add_distances(problem.term(t), rows, BlockSums::mean_before, 0, block(t));
  });
  Eigen::MatrixXd scores = Eigen::MatrixXd::Zero(free.size(), problem.num_samples());
  (void)evaluate(problem, after, &free, [&](int t, int sample, const TermResiduals& rows) {
    add_distances(problem.term(t), rows, BlockSums::mean_after, 1, block(t));
    add_features(problem.term(t), rows, sums, block(t), scores.col(sample));
  });
  sums.scores = scores * scores.transpose();
  sums.priors = prior_equations(problem, free, after).hessian;
  sums.hessian += sums.priors;
  return sums;
}

}  // namespace kinecal::detail
