// Definitions of parameter_search.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/trust/parameter_search.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

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
  std::vector<int> fold(rows), region(poses.region.empty() ? 0 : rows);
  for (const RowBlock& block : fit.blocks) {
    const auto sample = static_cast<std::size_t>(block.sample);
    for (Eigen::Index row = block.first; row < block.first + block.size; ++row) {
      const auto r = static_cast<std::size_t>(row);
      pose_[r] = poses.pose[sample];
      fold[r] = poses.fold[sample];
      if (!region.empty()) region[r] = poses.region[sample];
      poses_ = std::max(poses_, pose_[r] + 1);
    }
  }
  folds_ = parts(fold);
  regions_ = parts(region);
  squared_ = fit.prior_hessian;
  gradient_ = fit.prior_gradient;
  for (const Part& part : folds_) {
    squared_ += part.squared;
    gradient_ += part.gradient;
  }
  scale_ = squared_.diagonal().cwiseSqrt();
}

std::vector<ParameterSearch::Part> ParameterSearch::parts(const std::vector<int>& part) const {
  std::vector<std::vector<int>> rows;
  for (std::size_t row = 0; row < part.size(); ++row) {
    const auto of = static_cast<std::size_t>(part[row]);
    if (of >= rows.size()) rows.resize(of + 1);
    rows[of].push_back(static_cast<int>(row));
  }
  std::erase_if(rows, [](const std::vector<int>& of) { return of.empty(); });
  std::vector<Part> all;
  for (const std::vector<int>& of : rows) {
    Part& one = all.emplace_back();
    for (const int row : of) one.pose.push_back(pose_[static_cast<std::size_t>(row)]);
    one.jacobian = jacobian_(of, Eigen::all);
    one.residual = residual_(of);
    Eigen::MatrixXd lower = Eigen::MatrixXd::Zero(jacobian_.cols(), jacobian_.cols());
    lower.selfadjointView<Eigen::Lower>().rankUpdate(one.jacobian.transpose());
    one.squared = lower.selfadjointView<Eigen::Lower>();
    one.gradient = one.jacobian.transpose() * one.residual;
  }
  return all;
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
    whole.residual += jacobian_(Eigen::all, columns) * whole.change;
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
      left += out.jacobian(Eigen::all, columns) * change;
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

}  // namespace kinecal

#include "kinecal/trust/parameter_search_path.ipp"
#include "kinecal/trust/parameter_search_run.ipp"
