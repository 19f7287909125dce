// Definitions of own_poses.hpp, for a scalar S.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "kinecal/evaluation/own_poses.hpp"
#include "kinecal/evaluation/own_poses_fit.ipp"
#include "kinecal/evaluation/own_poses_parts.ipp"

namespace kinecal {

template <class S>
OwnPosesEvaluator<S>::OwnPosesEvaluator(const BasicProblem<S>& problem, const FreeSet& free)
    : problem_(problem),
      free_(free),
      own_(detail::own_pose_parameters(problem)),
      all_(detail::joined(free, own_)),
      batches_(problem.batches()),
      now_(problem.poses_of_samples()),
      best_(now_) {
  for (const int p : own_.parameters()) {
    if (free.column(p) < 0) continue;
    throw std::invalid_argument(
        "'" + problem.table()[p].name +
        "' is of a pose that each sample has of its own; it cannot be free");
  }
  places_.resize(now_.size());
  for (std::size_t l = 0; l < batches_.size(); ++l) {
    offsets_.push_back(detail::pose_places(problem, batches_[l].layout()));
    for (std::size_t row = 0; row < static_cast<std::size_t>(batches_[l].num_samples()); ++row) {
      places_[static_cast<std::size_t>(batches_[l].sample(row))] = {l, row};
    }
  }
  by_own_ = std::make_unique<Evaluator<S>>(problem, batches_, own_, 1);
  by_all_ = std::make_unique<Evaluator<S>>(problem, batches_, all_, 1);
}

template <class S>
std::optional<UndefinedResidual> OwnPosesEvaluator<S>::collect(ParameterValues values,
                                                               Losses losses, Linearization at) {
  fit(values, losses);
  rows_.clear();
  const auto undefined = by_all_->evaluate(
      values, true,
      [&](int t, int sample, const TermResiduals& rows) {
        Rows& of = rows_.emplace_back(Rows{t, sample, rows, 0.0, {}});
        of.weights = detail::squared_weights(problem_.term(t), rows, losses, of.cost);
      },
      at);
  const Eigen::Index free = free_.size(), own = own_.size();
  std::vector<Eigen::MatrixXd> by_own(now_.size(), Eigen::MatrixXd::Zero(own, own)),
      by_both(now_.size(), Eigen::MatrixXd::Zero(own, free));
  for (const Rows& of : rows_) {
    const auto poses = of.residuals.jacobian.rightCols(own);
    const Eigen::MatrixXd weighted = of.weights.asDiagonal() * poses;
    const auto s = static_cast<std::size_t>(of.sample);
    by_own[s].noalias() += weighted.transpose() * poses;
    by_both[s].noalias() += weighted.transpose() * of.residuals.jacobian.leftCols(free);
  }
  for (std::size_t s = 0; s < now_.size(); ++s) {
    by_own[s] = detail::inverse_where_determined(by_own[s]);
    by_both[s] = by_own[s] * by_both[s];
  }
  for (Rows& of : rows_) {
    const auto s = static_cast<std::size_t>(of.sample);
    const Eigen::MatrixXd jacobian = std::move(of.residuals.jacobian);
    const auto poses = jacobian.rightCols(own);
    const Eigen::VectorXd lengths = (poses * by_own[s]).cwiseProduct(poses).rowwise().sum();
    of.residuals.used = lengths.cwiseProduct(of.weights);
    of.residuals.jacobian = jacobian.leftCols(free) - poses * by_both[s];
  }
  known_ = {now_, std::move(by_both), {values.begin(), values.end()}};
  return undefined;
}

template <class S>
std::optional<UndefinedResidual> OwnPosesEvaluator<S>::evaluate(ParameterValues values,
                                                                bool derivatives,
                                                                const RowVisitor& visit,
                                                                Linearization at) {
  const auto undefined = collect(values, Losses::as_given, at);
  for (Rows& of : rows_) {
    if (!derivatives) of.residuals.jacobian.resize(0, 0);
    visit(of.term, of.sample, of.residuals);
  }
  return undefined;
}

template <class S>
NormalEquations OwnPosesEvaluator<S>::normal_equations(ParameterValues values, bool derivatives,
                                                       Losses losses) {
  NormalEquations total(derivatives ? free_.size() : 0);
  std::optional<UndefinedResidual> undefined;
  if (!derivatives) {
    fit(values, losses);
    undefined = by_own_->evaluate(values, false, [&](int t, int, const TermResiduals& rows) {
      (void)detail::squared_weights(problem_.term(t), rows, losses, total.cost);
    });
  } else {
    undefined = collect(values, losses, Linearization::measured);
    for (const Rows& of : rows_) {
      const Eigen::MatrixXd weighted = of.weights.asDiagonal() * of.residuals.jacobian;
      total.cost += of.cost;
      total.gradient.noalias() += weighted.transpose() * of.residuals.residual;
      total.hessian.noalias() += weighted.transpose() * of.residuals.jacobian;
    }
  }
  if (undefined) total.cost = std::numeric_limits<double>::quiet_NaN();
  if (total.cost <= best_cost_) {
    best_cost_ = total.cost;
    best_ = now_;
  }
  TermResiduals of_prior;
  for (const PriorTerm& prior : problem_.priors()) {
    prior.evaluate(problem_.table(), values, derivatives ? &free_ : nullptr, of_prior);
    total.add_prior(prior, of_prior, problem_.num_samples(), losses);
  }
  return total;
}

template <class S>
std::vector<std::vector<Pose<double>>> OwnPosesEvaluator<S>::own_poses(ParameterValues values) {
  fit(values, Losses::as_given);
  return now_;
}

}  // namespace kinecal
