// Definitions of parameter_search.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/trust/search/parameter_search.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <set>
#include <utility>
#include <vector>

#include "kinecal/geometry/ldlt.hpp"
#include "kinecal/trust/f_distribution.hpp"

namespace kinecal {

namespace detail {
namespace {

/// Least share of a column's effect that the others must leave, or it is one of their combinations.
constexpr double kOwnShare = 1e-4;

/// Solves with a matrix of information; empty if it is singular.
/// @param scale  (columns) lengths of the columns before others were taken off
template <class Right>
[[nodiscard]] Right scaled_solution(const Eigen::MatrixXd& squared, const Eigen::VectorXd& scale,
                                    const Right& right) {
  const Eigen::VectorXd by = scale.cwiseInverse();
  const Ldlt ldlt(by.asDiagonal() * squared * by.asDiagonal());
  if (ldlt.least_pivot() <= 0.1 * kOwnShare) return {};
  const Right scaled = by.asDiagonal() * right;
  return by.asDiagonal() * Right(ldlt.solve(scaled));
}

/// The inverse of a matrix of information; empty if it is singular.
[[nodiscard]] Eigen::MatrixXd scaled_inverse(const Eigen::MatrixXd& squared,
                                             const Eigen::VectorXd& scale) {
  const Eigen::MatrixXd identity = Eigen::MatrixXd::Identity(squared.rows(), squared.cols());
  return scaled_solution(squared, scale, identity);
}

/// A change of some columns as one of all of them.
[[nodiscard]] Eigen::VectorXd spread(const Eigen::VectorXd& change, const std::vector<int>& columns,
                                     Eigen::Index all) {
  Eigen::VectorXd of_all = Eigen::VectorXd::Zero(all);
  of_all(columns) = change;
  return of_all;
}

[[nodiscard]] std::vector<int> joined(std::vector<int> columns, const std::vector<int>& more) {
  columns.insert(columns.end(), more.begin(), more.end());
  return columns;
}

}  // namespace
}  // namespace detail

ParameterSearch::ParameterSearch(const LinearFit& fit, const SearchPoses& poses,
                                 Eigen::VectorXd largest, Eigen::VectorXd smallest)
    : largest_(std::move(largest)), smallest_(std::move(smallest)), weight_(fit.loss.sum()) {
  if (smallest_.size() == 0) smallest_ = -largest_;
  const Eigen::VectorXd root = fit.loss.cwiseSqrt();
  jacobian_ = root.asDiagonal() * fit.jacobian;
  residual_ = root.cwiseProduct(fit.residual);
  const auto rows = static_cast<std::size_t>(residual_.size());
  pose_.resize(rows);
  for (const RowBlock& block : fit.blocks) {
    const int pose = poses.pose[static_cast<std::size_t>(block.sample)];
    std::fill_n(pose_.begin() + block.first, block.size, pose);
    poses_ = std::max(poses_, pose + 1);
  }
  set_parts(fit, poses);
  squared_ = fit.prior_hessian;
  gradient_ = fit.prior_gradient;
  for (const Part& part : folds_) {
    squared_ += part.squared;
    gradient_ += part.gradient;
  }
  scale_ = squared_.diagonal().cwiseSqrt();
}

namespace detail {
namespace {

/// The number of parts.
/// @param part  of each sample
[[nodiscard]] std::size_t number_of(const std::vector<int>& part) {
  return part.empty() ? 0
                      : static_cast<std::size_t>(*std::max_element(part.begin(), part.end())) + 1;
}

}  // namespace
}  // namespace detail

void ParameterSearch::set_parts(const LinearFit& fit, const SearchPoses& poses) {
  struct Parts {
    const std::vector<int>& of_sample;
    std::vector<Part>& all;
    std::vector<std::vector<Eigen::Index>> rows;
  };
  std::vector<Parts> both;
  both.push_back({poses.fold, folds_, {}});
  both.push_back({poses.region, regions_, {}});
  const Eigen::Index n = jacobian_.cols();
  for (Parts& parts : both) {
    parts.rows.resize(detail::number_of(parts.of_sample));
    parts.all.resize(parts.rows.size());
    for (Part& part : parts.all) {
      part.squared = Eigen::MatrixXd::Zero(n, n);
      part.gradient = Eigen::VectorXd::Zero(n);
    }
  }
  for (const RowBlock& block : fit.blocks) {
    const Eigen::MatrixXd all = jacobian_.middleRows(block.first, block.size);
    const std::vector<int> columns = detail::nonzero_columns(all);
    const Eigen::MatrixXd rows = all(Eigen::all, columns);
    const Eigen::MatrixXd squared = rows.transpose() * rows;
    const Eigen::VectorXd gradient = rows.transpose() * residual_.segment(block.first, block.size);
    for (Parts& parts : both) {
      if (parts.all.empty()) continue;
      const auto of =
          static_cast<std::size_t>(parts.of_sample[static_cast<std::size_t>(block.sample)]);
      parts.all[of].squared(columns, columns) += squared;
      parts.all[of].gradient(columns) += gradient;
      for (Eigen::Index i = 0; i < block.size; ++i) parts.rows[of].push_back(block.first + i);
    }
  }
  for (Parts& parts : both) {
    for (std::size_t i = 0; i < parts.all.size(); ++i) {
      Part& part = parts.all[i];
      part.jacobian = jacobian_(parts.rows[i], Eigen::all);
      part.residual = residual_(parts.rows[i]);
      for (const Eigen::Index row : parts.rows[i]) {
        part.pose.push_back(pose_[static_cast<std::size_t>(row)]);
      }
    }
    std::erase_if(parts.all, [](const Part& part) { return part.pose.empty(); });
  }
}

std::vector<int> ParameterSearch::independent(const std::vector<int>& columns) const {
  std::vector<int> kept;
  for (const int c : columns) {
    if (explains(kept, c)) continue;
    kept.push_back(c);
    if (detail::scaled_inverse(squared_(kept, kept), scale_(kept)).size() == 0) kept.pop_back();
  }
  return kept;
}

bool ParameterSearch::explains(const std::vector<int>& columns, int column) const {
  double left = squared_(column, column);
  if (!columns.empty()) {
    const Eigen::VectorXd cross = squared_(columns, std::vector<int>{column});
    const Eigen::VectorXd solution =
        detail::scaled_solution(squared_(columns, columns), scale_(columns), cross);
    if (solution.size() > 0) left -= cross.dot(solution);
  }
  return !(left > detail::kOwnShare * squared_(column, column));
}

std::vector<int> ParameterSearch::determined(const std::vector<int>& base,
                                             const std::vector<int>& columns) const {
  std::vector<int> all = independent(detail::joined(base, columns));
  while (all.size() > base.size()) {
    const Whole whole = whole_fit(all);
    const Eigen::VectorXd share = whole.deviation.cwiseQuotient(largest_(all));
    Eigen::Index weakest = 0;
    const Eigen::Index own = std::ssize(all) - std::ssize(base);
    if (share.tail(own).maxCoeff(&weakest) <= kHardly) break;
    all.erase(all.begin() + std::ssize(base) + weakest);
  }
  return {all.begin() + std::ssize(base), all.end()};
}

ParameterSearch::Whole ParameterSearch::whole_fit(const std::vector<int>& columns) const {
  Whole whole{columns, {}, residual_, 0.0, {}, {}, false};
  if (!columns.empty()) {
    whole.inverse = detail::scaled_inverse(squared_(columns, columns), scale_(columns));
    if (whole.inverse.size() == 0) return whole;
    whole.change = -whole.inverse * gradient_(columns);
    whole.residual += jacobian_ * detail::spread(whole.change, columns, jacobian_.cols());
  }
  whole.squares = whole.residual.squaredNorm();
  const double freedom = std::max(1.0, static_cast<double>(residual_.size() - std::ssize(columns)));
  whole.deviation = (whole.squares / freedom * whole.inverse.diagonal()).cwiseSqrt();
  whole.determined = true;
  return whole;
}

bool ParameterSearch::is_plausible(const Whole& whole, std::size_t from) const {
  for (std::size_t i = from; i < whole.columns.size(); ++i) {
    const double largest = largest_(whole.columns[i]);
    const auto at = static_cast<Eigen::Index>(i);
    const double change = whole.change(at);
    if (!(change <= largest && change >= smallest_(whole.columns[i]))) return false;
    if (!(whole.deviation(at) <= kHardly * largest)) return false;
  }
  return true;
}

Eigen::VectorXd ParameterSearch::predicted(const std::vector<int>& columns,
                                           const std::vector<Part>& parts) const {
  Eigen::VectorXd squares = Eigen::VectorXd::Zero(poses_);
  const Eigen::MatrixXd squared = squared_(columns, columns);
  const Eigen::VectorXd gradient = gradient_(columns), scale = scale_(columns);
  for (const Part& out : parts) {
    Eigen::VectorXd left = out.residual;
    if (!columns.empty()) {
      const Eigen::VectorXd change = detail::scaled_solution<Eigen::VectorXd>(
          squared - out.squared(columns, columns), scale, out.gradient(columns) - gradient);
      if (change.size() == 0) return {};
      left += out.jacobian * detail::spread(change, columns, out.jacobian.cols());
    }
    for (Eigen::Index i = 0; i < left.size(); ++i) {
      squares(out.pose[static_cast<std::size_t>(i)]) += left(i) * left(i);
    }
  }
  return squares;
}

double ParameterSearch::certainty(const Eigen::VectorXd& before,
                                  const Eigen::VectorXd& after) const {
  if (after.size() == 0) return -std::numeric_limits<double>::infinity();
  if (before.size() == 0) return std::numeric_limits<double>::infinity();
  const Eigen::VectorXd fall = before - after;
  const double mean = fall.mean(), n = static_cast<double>(fall.size());
  const double error = std::sqrt((fall.array() - mean).square().sum() / std::max(1.0, n - 1.0) / n);
  constexpr double kRounding = 1e-9;  // of fits that are the same
  return error > 0.0 && std::abs(mean) > kRounding * before.mean() ? mean / error : 0.0;
}

double ParameterSearch::certainty_of(const std::vector<int>& with,
                                     const std::vector<int>& without) const {
  const double sure = certainty(predicted(without, folds_), predicted(with, folds_));
  if (regions_.empty() || !(sure > kSure)) return sure;
  constexpr double kNotWorse = -1.0;  // what helps inside the poses must not harm beyond them
  const double beyond = certainty(predicted(without, regions_), predicted(with, regions_));
  return beyond > kNotWorse ? sure : beyond;
}

namespace detail {

// What candidates explain beside a subset.

[[nodiscard]] inline std::vector<int> columns_of(const std::vector<int>& base,
                                                 const std::vector<SearchCandidate>& candidates,
                                                 const std::vector<int>& chosen, int except = -1) {
  std::vector<int> columns = base;
  for (const int k : chosen) {
    if (k != except)
      columns = joined(std::move(columns), candidates[static_cast<std::size_t>(k)].columns);
  }
  return columns;
}

}  // namespace detail

double ParameterSearch::chance_by_poses(const Whole& whole,
                                        const SearchCandidate& candidate) const {
  const std::vector<int>& own = candidate.columns;
  const auto q = static_cast<Eigen::Index>(own.size());
  Eigen::MatrixXd rest = jacobian_(Eigen::all, own);
  if (!whole.columns.empty()) {
    rest -= jacobian_(Eigen::all, whole.columns) * (whole.inverse * squared_(whole.columns, own));
  }
  Eigen::MatrixXd slopes = Eigen::MatrixXd::Zero(q, poses_);  // each pose's share of the slope
  for (Eigen::Index row = 0; row < rest.rows(); ++row) {
    slopes.col(pose_[static_cast<std::size_t>(row)]) +=
        rest.row(row).transpose() * whole.residual(row);
  }
  const Eigen::VectorXd slope = slopes.rowwise().sum();
  const Eigen::MatrixXd spread = slopes * slopes.transpose();
  const Eigen::MatrixXd inverse = detail::scaled_inverse(spread, spread.diagonal().cwiseSqrt());
  const double freedom = static_cast<double>(poses_ - q);
  if (inverse.size() == 0 || freedom < 1.0) return 1.0;
  const double statistic = slope.dot(inverse * slope);  // at most the number of poses
  const double share = std::min(statistic / poses_, 1.0 - 1e-12);
  return f_tail(share / (1.0 - share) * freedom / static_cast<double>(q), static_cast<double>(q),
                freedom);
}

ParameterSearch::Gain ParameterSearch::gain_of(const Whole& whole, const SearchCandidate& candidate,
                                               int number) const {
  if (!whole.determined) return {number};
  const Eigen::MatrixXd cross = whole.inverse * squared_(whole.columns, candidate.columns);
  return gain_of(whole, candidate, number, cross);
}

ParameterSearch::Gain ParameterSearch::gain_of(const Whole& whole, const SearchCandidate& candidate,
                                               int number, const Eigen::MatrixXd& cross) const {
  Gain gain{number};
  const std::vector<int>& own = candidate.columns;
  const auto q = static_cast<double>(own.size());
  Eigen::MatrixXd rest = squared_(own, own);
  Eigen::VectorXd slope = gradient_(own);
  if (!whole.columns.empty()) {
    rest -= squared_(own, whole.columns) * cross;
    slope -= cross.transpose() * gradient_(whole.columns);
  }
  if ((rest.diagonal().array() <= detail::kOwnShare * squared_.diagonal()(own).array()).any())
    return gain;
  const Eigen::MatrixXd inverse = detail::scaled_inverse(rest, scale_(own));
  if (inverse.size() == 0) return gain;
  gain.squares = slope.dot(inverse * slope);
  const double freedom = static_cast<double>(residual_.size() - std::ssize(whole.columns)) - q;
  if (freedom < 2.0 * q || poses_ < 2 * static_cast<int>(own.size())) return gain;
  const double left = std::max(whole.squares - gain.squares, std::numeric_limits<double>::min());
  gain.chance = f_tail(gain.squares / q / (left / freedom), q, freedom);
  return gain;
}

std::vector<ParameterSearch::Gain> ParameterSearch::gains(
    const Whole& whole, const std::vector<SearchCandidate>& candidates,
    const std::vector<int>& chosen) const {
  std::vector<Gain> all;
  if (!whole.determined) return all;
  const Eigen::MatrixXd cross = whole.inverse * squared_(whole.columns, Eigen::all);
  for (int k = 0; k < static_cast<int>(candidates.size()); ++k) {
    if (std::find(chosen.begin(), chosen.end(), k) != chosen.end()) continue;
    const std::vector<int>& own = candidates[static_cast<std::size_t>(k)].columns;
    const auto is_free = [&](int c) {
      return std::find(whole.columns.begin(), whole.columns.end(), c) != whole.columns.end();
    };
    if (own.empty() || std::any_of(own.begin(), own.end(), is_free)) continue;
    all.push_back(
        gain_of(whole, candidates[static_cast<std::size_t>(k)], k, cross(Eigen::all, own)));
  }
  constexpr double kSame = 1e-6;  // of the residuals: rounding decides nothing
  const auto order = [&](const Gain& gain) {
    return std::pair(-std::round(gain.squares / (kSame * whole.squares)),
                     candidates[static_cast<std::size_t>(gain.candidate)].rank);
  };
  std::stable_sort(all.begin(), all.end(),
                   [&](const Gain& a, const Gain& b) { return order(a) < order(b); });
  return all;
}

// What the steps of a search buy.

SearchFit ParameterSearch::fit_of(const std::vector<int>& base, const Candidates& candidates,
                                  const std::vector<int>& chosen) const {
  const std::vector<int> columns = detail::columns_of(base, candidates, chosen);
  const auto root = [&](const Eigen::VectorXd& squares) {
    return squares.size() > 0 ? std::sqrt(squares.sum() / weight_)
                              : std::numeric_limits<double>::infinity();
  };
  SearchFit fit;
  fit.fitted = std::sqrt(whole_fit(columns).squares / weight_);
  const Eigen::VectorXd squares = predicted(columns, folds_);
  fit.held_out = root(squares);
  fit.region = regions_.empty() ? 0.0 : root(predicted(columns, regions_));
  fit.columns = static_cast<int>(columns.size());
  const auto n = static_cast<double>(squares.size());
  if (n > 1.0 && fit.held_out > 0.0) {  // d sqrt(s / w) = ds / (2 w sqrt(s / w))
    const double sum = std::sqrt(n / (n - 1.0) * (squares.array() - squares.mean()).square().sum());
    fit.deviation = sum / (2.0 * weight_ * fit.held_out);
  }
  return fit;
}

std::vector<SearchStep> ParameterSearch::path(const std::vector<int>& base,
                                              const Candidates& candidates,
                                              const std::vector<int>& chosen) const {
  std::vector<SearchStep> steps;
  std::vector<int> free, left = chosen;
  const Whole all = whole_fit(detail::columns_of(base, candidates, chosen));
  while (!left.empty()) {
    const Whole whole = whole_fit(detail::columns_of(base, candidates, free));
    const auto gain = [&](int k) {
      return gain_of(whole, candidates[static_cast<std::size_t>(k)], k).squares;
    };
    const auto next =
        std::max_element(left.begin(), left.end(), [&](int a, int b) { return gain(a) < gain(b); });
    SearchStep step{.candidate = *next};
    left.erase(next);
    free.push_back(step.candidate);
    const std::vector<int> without = detail::columns_of(base, candidates, chosen, step.candidate);
    step.fit = fit_of(base, candidates, free);
    step.certainty = certainty_of(detail::columns_of(base, candidates, chosen), without);
    step.alike = like(whole_fit(without), candidates, chosen, step.candidate);
    std::copy_if(step.alike.begin(), step.alike.end(), std::back_inserter(step.inseparable),
                 [&](int k) {
                   return gain_of(all, candidates[static_cast<std::size_t>(k)], k).squares <= 0.0;
                 });
    steps.push_back(std::move(step));
  }
  return steps;
}

std::vector<SearchStep> ParameterSearch::beyond(const std::vector<int>& base,
                                                const Candidates& candidates,
                                                const std::vector<int>& chosen, int most) const {
  std::vector<SearchStep> steps;
  std::vector<int> free = chosen;
  while (static_cast<int>(steps.size()) < most) {
    const Whole whole = whole_fit(detail::columns_of(base, candidates, free));
    const std::vector<Gain> all = gains(whole, candidates, free);
    const auto next = std::find_if(all.begin(), all.end(), [&](const Gain& gain) {
      const SearchCandidate& of = candidates[static_cast<std::size_t>(gain.candidate)];
      const Whole with = whole_fit(detail::joined(whole.columns, of.columns));
      return gain.squares > 0.0 && with.determined && is_plausible(with, base.size());
    });
    if (next == all.end()) break;
    SearchStep step{.candidate = next->candidate};
    const Whole with = whole_fit(detail::joined(
        whole.columns, candidates[static_cast<std::size_t>(step.candidate)].columns));
    free.push_back(step.candidate);
    step.fit = fit_of(base, candidates, free);
    step.certainty = certainty_of(with.columns, whole.columns);
    steps.push_back(std::move(step));
  }
  return steps;
}

// The steps of a search.

bool ParameterSearch::helps(const Whole& whole, const Gain& gain, const Candidates& candidates,
                            std::size_t base, const Evidence& evidence) const {
  if (!whole.determined) return false;
  const SearchCandidate& of = candidates[static_cast<std::size_t>(gain.candidate)];
  if (std::max(gain.chance, chance_by_poses(whole, of)) > evidence.chance) return false;
  const Whole with = whole_fit(detail::joined(whole.columns, of.columns));
  return with.determined && is_plausible(with, base) &&
         certainty_of(with.columns, whole.columns) > evidence.sure;
}

bool ParameterSearch::free_one(const std::vector<int>& base, const Candidates& candidates,
                               std::vector<int>& chosen, const Evidence& of_all) const {
  constexpr std::size_t kTried = 8;  // of the best, before the search ends
  const auto tried = std::count_if(candidates.begin(), candidates.end(),
                                   [](const auto& of) { return !of.columns.empty(); });
  const Evidence evidence{of_all.chance / static_cast<double>(tried), of_all.sure};
  const Whole whole = whole_fit(detail::columns_of(base, candidates, chosen));
  const std::vector<Gain> all = gains(whole, candidates, chosen);
  for (std::size_t i = 0; i < std::min(kTried, all.size()); ++i) {
    if (!helps(whole, all[i], candidates, base.size(), evidence)) continue;
    chosen.push_back(all[i].candidate);
    return true;
  }
  return false;
}

void ParameterSearch::hold_superfluous(const std::vector<int>& base, const Candidates& candidates,
                                       std::vector<int>& chosen) const {
  const Evidence evidence{0.02, 0.5};  // beside the others: it has been found already
  for (;;) {                           // the least certain first
    int weakest = -1;
    double least = 0.0;
    for (const int k : chosen) {
      const Whole without = whole_fit(detail::columns_of(base, candidates, chosen, k));
      const Gain gain = gain_of(without, candidates[static_cast<std::size_t>(k)], k);
      if (helps(without, gain, candidates, base.size(), evidence)) continue;
      if (weakest >= 0 && gain.squares >= least) continue;
      weakest = k;
      least = gain.squares;
    }
    if (weakest < 0) return;
    chosen.erase(std::find(chosen.begin(), chosen.end(), weakest));
  }
}

std::vector<int> ParameterSearch::saturated(const std::vector<int>& base,
                                            const Candidates& candidates, std::vector<int> chosen,
                                            const std::vector<int>& ranks) const {
  for (const int r : ranks) {
    for (;;) {
      const Whole whole = whole_fit(detail::columns_of(base, candidates, chosen));
      const std::vector<Gain> all = gains(whole, candidates, chosen);
      const auto next = std::find_if(all.begin(), all.end(), [&](const Gain& gain) {
        const SearchCandidate& of = candidates[static_cast<std::size_t>(gain.candidate)];
        if (of.rank != r || gain.squares <= 0.0) return false;
        const Whole with = whole_fit(detail::joined(whole.columns, of.columns));
        return with.determined && is_plausible(with, base.size());
      });
      if (next == all.end()) break;
      chosen.push_back(next->candidate);
    }
  }
  return chosen;
}

int ParameterSearch::simplest(const std::vector<int>& base, const Candidates& candidates,
                              const std::vector<int>& chosen, int k) const {
  const auto rank = [&](int c) { return candidates[static_cast<std::size_t>(c)].rank; };
  const Whole without = whole_fit(detail::columns_of(base, candidates, chosen, k));
  for (const int other : like(without, candidates, chosen, k)) {
    if (rank(other) < rank(k)) k = other;
  }
  return k;
}

std::vector<int> ParameterSearch::like(const Whole& without, const Candidates& candidates,
                                       const std::vector<int>& chosen, int k) const {
  constexpr double kAlike = 0.9;    // share of the fall that another one explains, too
  constexpr double kAsWell = 1.04;  // squares of errors on held-out poses: 2 %
  const auto with = [&](int c) {
    return detail::joined(without.columns, candidates[static_cast<std::size_t>(c)].columns);
  };
  const Gain own = gain_of(without, candidates[static_cast<std::size_t>(k)], k);
  const Eigen::VectorXd of_own = predicted(with(k), folds_);
  const auto is_as_good = [&](const std::vector<int>& other) {
    const Eigen::VectorXd of_other = predicted(other, folds_);
    return (of_other.size() > 0 && of_other.sum() <= kAsWell * of_own.sum()) ||
           certainty(of_other, of_own) <= kSure || certainty_of(with(k), other) <= kSure;
  };
  std::vector<int> others;
  for (const Gain& gain : gains(without, candidates, chosen)) {
    if (gain.squares < kAlike * own.squares) break;
    // Where little noise is left, a tenth of the fall can be certain, and much.
    if (is_as_good(with(gain.candidate))) others.push_back(gain.candidate);
  }
  return others;
}

void ParameterSearch::run(const std::vector<int>& base, const Candidates& candidates,
                          std::vector<int>& chosen) const {
  constexpr double kFar = 0.5;               // of the sum of squares: linearize again
  constexpr Evidence kOfSearch{0.2, kSure};  // what is superfluous is held again
  const auto columns = [&](const std::vector<int>& of) {
    return detail::columns_of(base, candidates, of);
  };
  std::vector<int> determined;  // at this linearization
  for (const int k : chosen) {
    determined.push_back(k);
    if (!whole_fit(columns(determined)).determined) determined.pop_back();
  }
  chosen = determined;
  const double begin = whole_fit(columns(chosen)).squares;
  std::set<std::set<int>> seen;  // so that it ends
  int ranks = 0;
  for (const SearchCandidate& candidate : candidates) ranks = std::max(ranks, candidate.rank);
  if (chosen
          .empty()) {  // zeros and mounts together: what is far off makes anything look like a help
    // A mount has the zero of its joint in it, so it is first.
    const std::vector<int> zeros = saturated(base, candidates, chosen, {1, 0});
    const bool far = whole_fit(columns(zeros)).squares < kFar * begin;
    if (far && certainty_of(columns(zeros), columns(chosen)) > kSure) {
      for (const int k : zeros) {  // a mount alone, if it leaves nothing to the others
        if (candidates[static_cast<std::size_t>(k)].rank != 1) break;
        chosen.push_back(k);
        if (!(certainty_of(columns(zeros), columns(chosen)) > kSure)) return;
      }
      chosen = zeros;
      return;
    }
  }
  for (;;) {
    while (seen.insert(std::set<int>(chosen.begin(), chosen.end())).second &&
           free_one(base, candidates, chosen, kOfSearch)) {
      hold_superfluous(base, candidates, chosen);
      if (whole_fit(columns(chosen)).squares < kFar * begin) return;
    }
    // Many small errors at once, none of which shows alone: begin with all, and hold what is superfluous.
    std::vector<int> best = chosen;
    std::vector<int> up_to;
    for (int rank = 0; rank <= ranks; ++rank) {
      up_to.push_back(rank);
      std::vector<int> all = saturated(base, candidates, chosen, up_to);
      if (all.size() == chosen.size() || !(certainty_of(columns(all), columns(best)) > kSure))
        continue;
      hold_superfluous(base, candidates, all);
      if (certainty_of(columns(all), columns(best)) > kSure) best = std::move(all);
    }
    if (best == chosen) hold_superfluous(base, candidates, best);
    if (best == chosen || !seen.insert(std::set<int>(best.begin(), best.end())).second) break;
    chosen = std::move(best);
    if (whole_fit(columns(chosen)).squares < kFar * begin) return;
  }
  for (int& k : chosen) k = simplest(base, candidates, chosen, k);
}

}  // namespace kinecal
