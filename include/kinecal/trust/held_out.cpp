// Cross-validation.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/trust/held_out.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>

namespace kinecal {

namespace detail {
namespace {

/// Sums of squared distances over selected rows, by error block, in their units.
struct SquaredDistances {
  std::vector<double> sum;
  std::vector<int> features;

  explicit SquaredDistances(const AnyProblem& problem)
      : sum(static_cast<std::size_t>(problem.num_terms()), 0.0), features(sum.size(), 0) {}

  /// @param left  share of the rows that poses of the sample's own do not use up
  void add(const AnyProblem& problem, const Eigen::VectorXd& residual, const RowBlock& block,
           double left) {
    const Term& term = problem.term(block.term);
    const double unit = 1.0 / term.weight;
    const auto t = static_cast<std::size_t>(block.term);
    sum[t] += unit * unit * residual.segment(block.first, block.size).squaredNorm() / left;
    features[t] += static_cast<int>(block.size) / term.feature_size;
  }
};

/// Fits without each fold, and visits its rows.
/// @param visit  callable: block, all residuals without its fold, and what poses of the sample's own leave of its rows; these
///               are fitted to all features of the sample
template <class Visit>
void hold_out(AnyEvaluator& evaluator, ParameterValues values, const LinearFit& fit,
              const std::vector<int>& fold, const ProgressMeter& meter, const Visit& visit) {
  const std::vector<RowSums> sums = sums_without_parts(fit, fit.loss, fold);
  const int folds = static_cast<int>(std::ssize(sums));
  const auto in = [&](const RowBlock& block, int k) {
    return fold[static_cast<std::size_t>(block.sample)] == k;
  };
  for (int k = 0; k < folds; ++k) {
    Eigen::VectorXd weights = fit.loss;
    for (const RowBlock& block : fit.blocks) {
      if (in(block, k)) weights.segment(block.first, block.size).setZero();
    }
    const auto kept = std::count_if(fold.begin(), fold.end(), [&](int f) { return f != k; });
    const double priors = static_cast<double>(kept) / static_cast<double>(fold.size());
    const Eigen::VectorXd first = step_to_minimum(fit, sums[static_cast<std::size_t>(k)], priors);
    const Refit without = refit(evaluator, values, fit, weights, first, priors);
    for (const RowBlock& block : fit.blocks) {
      if (!in(block, k)) continue;
      const double used = fit.used.segment(block.first, block.size).mean();
      visit(block, without.residual, std::max(0.1, 1.0 - used));
    }
    if (meter) meter((k + 1.0) / folds, "fitting without each fold");
  }
}

}  // namespace
}  // namespace detail

std::vector<int> folds_of(std::span<const Sample> samples, const PoseGroups& poses, int folds) {
  std::vector<std::size_t> order(samples.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  const auto key = [&](std::size_t i) {
    const Sample& s = samples[i];
    double sum = 0.0;
    for (const Observation& seen : s.observations) {
      for (const Feature& feature : seen.features) {
        if (feature.point.allFinite()) sum += feature.point.sum();
      }
    }
    return std::pair(s.joint_positions, sum);
  };
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return key(a) < key(b); });
  std::vector<int> of_pose(static_cast<std::size_t>(poses.count), -1), fold(samples.size());
  int dealt = 0;
  for (const std::size_t i : order) {
    int& of = of_pose[static_cast<std::size_t>(poses.of_sample[i])];
    if (of < 0) of = dealt++ % folds;
    fold[i] = of;
  }
  return fold;
}

std::vector<HeldOutError> held_out_errors(AnyEvaluator& evaluator, ParameterValues values,
                                          const LinearFit& fit, const std::vector<int>& fold,
                                          const ProgressMeter& meter) {
  const AnyProblem& problem = evaluator.problem();
  detail::SquaredDistances fitted(problem), held_out(problem);
  for (const RowBlock& block : fit.blocks) fitted.add(problem, fit.residual, block, 1.0);
  const auto add = [&](const RowBlock& block, const Eigen::VectorXd& residual, double left) {
    held_out.add(problem, residual, block, left);
  };
  detail::hold_out(evaluator, values, fit, fold, meter, add);
  std::vector<HeldOutError> errors;
  for (std::size_t t = 0; t < fitted.sum.size(); ++t) {
    const Term& term = problem.term(static_cast<int>(t));
    const auto root = [&](const detail::SquaredDistances& of) {
      return of.features[t] > 0 ? std::sqrt(of.sum[t] / of.features[t]) : 0.0;
    };
    errors.push_back(
        {term.name, term.options.unit, fitted.features[t], root(fitted), root(held_out)});
  }
  return errors;
}

std::vector<std::vector<double>> held_out_distances(const AnyProblem& problem, const FreeSet& free,
                                                    ParameterValues values,
                                                    std::span<const Sample> samples,
                                                    const std::string& sensor, int folds) {
  const auto evaluator = problem.evaluator(free, 1);
  const LinearFit fit =
      linear_fit(*evaluator, values, determined_coordinates(problem, free, values));
  const PoseGroups poses = pose_groups(problem, samples);
  std::vector<std::vector<double>> distances(samples.size());
  const auto add = [&](const RowBlock& block, const Eigen::VectorXd& residual, double left) {
    const Term& term = problem.term(block.term);
    const bool is_of_sensor = std::any_of(term.sensors.begin(), term.sensors.end(), [&](int s) {
      return problem.sensors()[static_cast<std::size_t>(s)].mount().name == sensor;
    });
    if (!is_of_sensor) return;
    const double unit = 1.0 / (term.weight * std::sqrt(left));
    for (Eigen::Index row = block.first; row < block.first + block.size; row += term.feature_size) {
      distances[static_cast<std::size_t>(block.sample)].push_back(
          unit * residual.segment(row, term.feature_size).norm());
    }
  };
  const std::vector<int> fold = folds_of(samples, poses, std::min(folds, poses.count));
  detail::hold_out(*evaluator, values, fit, fold, {}, add);
  return distances;
}

}  // namespace kinecal
