// Definitions of assess_shards.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/trust/assess_shards.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "kinecal/trust/compared_frames.hpp"
#include "kinecal/trust/inside_bounds.ipp"
#include "kinecal/trust/shard_sums.ipp"

namespace kinecal {

namespace detail {

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
  if (const auto frames = compared_frames(drawn, samples)) {
    const LinearFit fit = linear_fit(*drawn.evaluator(inside, 1), after, by);
    of.pose = pose_uncertainty(drawn, inside, after, fit, of.uncertainty, samples, frames->first,
                               frames->second);
  }
  return found;
}

}  // namespace kinecal
