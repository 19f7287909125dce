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

/// The inverse of a matrix of information; empty if it is singular.
/// @param scale  (columns) lengths of the columns before others were taken off
[[nodiscard]] Eigen::MatrixXd scaled_inverse(const Eigen::MatrixXd& squared,
                                             const Eigen::VectorXd& scale) {
  const Eigen::VectorXd by = scale.cwiseInverse();
  const Ldlt ldlt(by.asDiagonal() * squared * by.asDiagonal());
  if (ldlt.least_pivot() <= 0.1 * kOwnShare) return {};
  const Eigen::MatrixXd identity = Eigen::MatrixXd::Identity(squared.rows(), squared.cols());
  const Eigen::MatrixXd inverse = ldlt.solve(identity);
  return by.asDiagonal() * inverse * by.asDiagonal();
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
  squared_ = jacobian_.transpose() * jacobian_ + fit.prior_hessian;
  gradient_ = jacobian_.transpose() * residual_ + fit.prior_gradient;
  scale_ = squared_.diagonal().cwiseSqrt();
  const auto rows = static_cast<std::size_t>(residual_.size());
  pose_.resize(rows);
  fold_.resize(rows);
  if (!poses.region.empty()) region_.resize(rows);
  for (const RowBlock& block : fit.blocks) {
    const auto sample = static_cast<std::size_t>(block.sample);
    for (Eigen::Index row = block.first; row < block.first + block.size; ++row) {
      const auto r = static_cast<std::size_t>(row);
      pose_[r] = poses.pose[sample];
      fold_[r] = poses.fold[sample];
      if (!region_.empty()) region_[r] = poses.region[sample];
      poses_ = std::max(poses_, pose_[r] + 1);
    }
  }
}

std::vector<int> ParameterSearch::independent(const std::vector<int>& columns) const {
  std::vector<int> kept;
  for (const int c : columns) {
    const Whole whole = whole_fit(kept);
    double left = squared_(c, c);
    if (!kept.empty()) {
      const Eigen::VectorXd cross = squared_(kept, std::vector<int>{c});
      left -= cross.dot(whole.inverse * cross);
    }
    if (left > detail::kOwnShare * squared_(c, c)) kept.push_back(c);
    if (!whole_fit(kept).determined) kept.pop_back();
  }
  return kept;
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
  constexpr double kHardly = 0.3;  // of the plausible change
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
                                           const std::vector<int>& part) const {
  const int parts = *std::max_element(part.begin(), part.end()) + 1;
  std::vector<std::vector<Eigen::Index>> rows(static_cast<std::size_t>(parts));
  for (std::size_t row = 0; row < part.size(); ++row) {
    rows[static_cast<std::size_t>(part[row])].push_back(static_cast<Eigen::Index>(row));
  }
  Eigen::VectorXd squares = Eigen::VectorXd::Zero(poses_);
  const Eigen::MatrixXd squared = squared_(columns, columns);
  const Eigen::VectorXd gradient = gradient_(columns), scale = scale_(columns);
  for (const std::vector<Eigen::Index>& out : rows) {
    if (out.empty()) continue;
    Eigen::VectorXd left = residual_(out);
    if (!columns.empty()) {
      const Eigen::MatrixXd jacobian = jacobian_(out, columns);
      const Eigen::MatrixXd inverse =
          detail::scaled_inverse(squared - jacobian.transpose() * jacobian, scale);
      if (inverse.size() == 0) return {};
      left -= jacobian * (inverse * (gradient - jacobian.transpose() * left));
    }
    for (std::size_t i = 0; i < out.size(); ++i) {
      const double value = left(static_cast<Eigen::Index>(i));
      squares(pose_[static_cast<std::size_t>(out[i])]) += value * value;
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
  const double sure = certainty(predicted(without, fold_), predicted(with, fold_));
  if (region_.empty() || !(sure > kSure)) return sure;
  constexpr double kNotWorse = -1.0;  // what helps inside the poses must not harm beyond them
  const double beyond = certainty(predicted(without, region_), predicted(with, region_));
  return beyond > kNotWorse ? sure : beyond;
}

}  // namespace kinecal

#include "kinecal/trust/parameter_search_path.ipp"
#include "kinecal/trust/parameter_search_run.ipp"
