// Definitions of assess_shards.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/trust/assess_shards.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <map>
#include <span>
#include <stdexcept>
#include <utility>
#include <vector>

#include "kinecal/evaluation/any_evaluator.hpp"
#include "kinecal/solve/determined_spectrum.hpp"
#include "kinecal/solve/statistics.hpp"
#include "kinecal/trust/inside_bounds.ipp"
#include "kinecal/trust/uncertainty/compared_frames.hpp"
#include "kinecal/trust/uncertainty/loss_curvature.ipp"

namespace kinecal {

namespace detail {

// Sums over the features of a shard for the assessment of a result.

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

/// Noise of each error block.
/// @param inverse  (free x free) of the information
[[nodiscard]] inline std::vector<BlockNoise> noise_of(const AnyProblem& problem,
                                                      const ShardSums& sums,
                                                      const Eigen::MatrixXd& inverse) {
  std::vector<BlockNoise> noise;
  for (int t = 0; t < problem.num_terms(); ++t) {
    const Term& term = problem.term(t);
    const BlockSums& block = sums.blocks[static_cast<std::size_t>(t)];
    const double median = DistanceBins::median(block.bins.col(2)) * term.weight;
    noise.push_back(
        block_noise(term, static_cast<std::int64_t>(block.figures(BlockSums::features)),
                    block.figures(BlockSums::weighted),
                    inverse.cwiseProduct(block.information).sum() + block.figures(BlockSums::used),
                    robust_sigma({median}, term.feature_size)));
  }
  return noise;
}

[[nodiscard]] inline std::vector<BlockStatistics> statistics_of_blocks(const AnyProblem& problem,
                                                                       const ShardSums& sums) {
  std::vector<BlockStatistics> all;
  for (int t = 0; t < problem.num_terms(); ++t) {
    const Term& term = problem.term(t);
    const BlockSums& block = sums.blocks[static_cast<std::size_t>(t)];
    all.push_back({term.name, term.options.type, term.options.unit,
                   static_cast<std::int64_t>(block.figures(BlockSums::features)),
                   block.statistics(BlockSums::mean_before, 0),
                   block.statistics(BlockSums::mean_after, 1)});
  }
  return all;
}

/// Number of residuals, without priors.
[[nodiscard]] inline double rows_of(const AnyProblem& problem, const ShardSums& sums) {
  double rows = 0.0;
  for (int t = 0; t < problem.num_terms(); ++t) {
    rows += sums.blocks[static_cast<std::size_t>(t)].figures(BlockSums::features) *
            problem.term(t).feature_size;
  }
  return rows;
}

/// Of these, how many samples' own poses use up.
[[nodiscard]] inline double used_of(const ShardSums& sums) {
  double used = 0.0;
  for (const BlockSums& block : sums.blocks) used += block.figures(BlockSums::used);
  return used;
}

/// What is known of each shard by itself.
struct EachShard {
  std::vector<double> misfits;            ///< see ShardAssessment
  std::vector<Eigen::VectorXd> farthest;  ///< largest weighted residual, by term
  std::vector<double> costs;              ///< without priors
};

/// Adds the sums of all shards.
/// @param each  out
[[nodiscard]] inline ShardSums all_sums(const Shards& shards, const FreeSet& free,
                                        ParameterValues before, ParameterValues after,
                                        EachShard& each) {
  const AnyProblem& problem = *shards.problem;
  const auto numbers_of = [&](int shard) {
    return sums_of(*shards.read(shard), free, before, after).packed();
  };
  const std::string what = name_at(name_at("sums", free, before), free, after);
  ShardSums sums(free.size(), problem.num_terms());
  for (const std::vector<double>& one : numbers_of_shards(shards, what, numbers_of)) {
    ShardSums of(free.size(), problem.num_terms());
    of.add(one);
    sums.add(one);
    each.costs.push_back(of.cost);
    const double checked = rows_of(problem, of) - used_of(of);
    each.misfits.push_back(std::sqrt(2.0 * of.cost / std::max(1.0, checked)));
    Eigen::VectorXd& farthest = each.farthest.emplace_back(problem.num_terms());
    for (int t = 0; t < problem.num_terms(); ++t) {
      farthest(t) = of.blocks[static_cast<std::size_t>(t)].figures(BlockSums::max_weighted);
    }
  }
  return sums;
}

/// Shards whose costs are the same to the last bit.
[[nodiscard]] inline std::vector<std::pair<int, int>> copies_among(
    const std::vector<double>& costs) {
  std::map<double, int> first;
  std::vector<std::pair<int, int>> copies;
  for (int shard = 0; shard < std::ssize(costs); ++shard) {
    const double cost = costs[static_cast<std::size_t>(shard)];
    const auto [known, is_new] = first.emplace(cost, shard);
    if (!is_new && cost > 0.0) copies.emplace_back(shard, known->second);
  }
  return copies;
}

[[nodiscard]] inline std::vector<FarFeature> far_features(const EachShard& each,
                                                          const ShardSums& sums,
                                                          const std::vector<BlockNoise>& noise) {
  constexpr double kFar = 20.0, kShare = 0.05;
  std::vector<FarFeature> far;
  for (std::size_t shard = 0; shard < each.farthest.size(); ++shard) {
    for (std::size_t t = 0; t < noise.size(); ++t) {
      const double largest = each.farthest[shard](static_cast<Eigen::Index>(t));
      const double times = largest * noise[t].unit_sigma / noise[t].robust;
      const double squares = sums.blocks[t].figures(BlockSums::weighted);
      if (!(times > kFar) || largest * largest <= kShare * squares) continue;
      far.push_back(
          {static_cast<int>(shard), noise[t].block, noise[t].unit, times * noise[t].robust, times});
    }
  }
  return far;
}

/// Inverse of a Hessian in the directions that samples and priors determine; zero in others.
/// @returns  (free x free)
[[nodiscard]] inline Eigen::MatrixXd inverse_in(const Coordinates& by,
                                                const Eigen::MatrixXd& hessian) {
  return by.basis * Spectrum(by.basis.transpose() * hessian * by.basis).pseudo_inverse() *
         by.basis.transpose();
}

/// C, from the sums.  A sample's gradient does not feel that its own poses are fitted, as J' is across them; only the
/// other parameters make gradients smaller.
/// @param of_priors  variance of their weighted residuals
[[nodiscard]] inline Uncertainty shard_uncertainty(const AnyProblem& problem, const FreeSet& free,
                                                   ParameterValues values, const ShardSums& sums,
                                                   const Coordinates& by, double of_priors) {
  const double rows = rows_of(problem, sums) - used_of(sums);
  const double freedom = rows / std::max(1.0, rows - static_cast<double>(by.basis.cols()));
  const Eigen::MatrixXd inverse = inverse_in(by, sums.hessian);
  const Eigen::MatrixXd covariance =
      inverse * (freedom * sums.scores + prior_scatter(problem, free, values, inverse, of_priors)) *
      inverse;
  return {static_cast<int>(by.basis.cols()), covariance, deviations(covariance, by.lost), 1.0};
}

}  // namespace detail

ShardAssessment assess_shards(const Shards& shards, const FreeSet& free, ParameterValues before,
                              ParameterValues after, const AnyProblem& drawn,
                              std::span<const Sample> samples) {
  const AnyProblem& problem = *shards.problem;
  ShardAssessment found;
  Assessment& of = found.assessment;
  of.observability =
      detail::observability_of(problem, free, detail::shard_information(shards, free, after));
  const FreeSet inside = detail::inside_bounds(problem, free, after, of.at_bound);
  of.parameters = inside.parameters();
  const Coordinates by = detail::coordinates_of(detail::shard_information(shards, inside, after));
  detail::EachShard each;
  const detail::ShardSums sums = detail::all_sums(shards, inside, before, after, each);
  of.rows = static_cast<std::int64_t>(detail::rows_of(problem, sums));
  of.used = detail::used_of(sums);
  of.samples = of.views = shards.samples;
  Eigen::MatrixXd information = sums.priors;
  for (const detail::BlockSums& block : sums.blocks) information += block.information;
  of.noise = detail::noise_of(problem, sums, detail::inverse_in(by, information));
  of.uncertainty =
      detail::shard_uncertainty(problem, inside, after, sums, by, prior_variance(of.noise));
  detail::mark_undetermined(problem, inside, by, of.uncertainty);
  of.weak = weak_parameters(problem, inside, of.uncertainty);
  found.blocks = detail::statistics_of_blocks(problem, sums);
  found.far = detail::far_features(each, sums, of.noise);
  found.copies = detail::copies_among(each.costs);
  found.misfits = std::move(each.misfits);
  const std::vector<ComparedFrames> compared = compared_frames(drawn, samples);
  if (compared.empty()) return found;
  const LinearFit fit = linear_fit(*drawn.evaluator(inside, 1), after, by);
  for (const ComparedFrames& frames : compared) {
    of.compared.push_back(pose_uncertainty(drawn, inside, after, fit, of.uncertainty, samples,
                                           frames.frame, frames.in));
  }
  return found;
}

}  // namespace kinecal
