// Definitions of own_poses.hpp, for a scalar S.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "kinecal/evaluation/own_poses.hpp"
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
void OwnPosesEvaluator<S>::place(std::size_t sample) {
  const Place& place = places_[sample];
  for (const detail::PosePlace& of : offsets_[place.layout]) {
    const std::array<double, 6> at = floating_positions(now_[sample][of.frame]);
    for (std::size_t i = 0; i < at.size(); ++i) {
      const bool turns = i >= 3;  // the numbers of JointStates
      batches_[place.layout].set(place.row, of.offsets[i], turns ? std::cos(at[i]) : at[i]);
      batches_[place.layout].set(place.row, of.offsets[i] + 1, turns ? std::sin(at[i]) : 0.0);
    }
  }
}

template <class S>
std::vector<detail::OwnPoseSums> OwnPosesEvaluator<S>::sums(ParameterValues values, Losses losses) {
  std::vector<detail::OwnPoseSums> all(now_.size(), detail::OwnPoseSums(own_.size()));
  (void)by_own_->evaluate(values, true, [&](int t, int sample, const TermResiduals& rows) {
    detail::OwnPoseSums& of = all[static_cast<std::size_t>(sample)];
    const Eigen::VectorXd w2 = detail::squared_weights(problem_.term(t), rows, losses, of.cost);
    const Eigen::MatrixXd weighted = w2.asDiagonal() * rows.jacobian;
    of.hessian.noalias() += rows.jacobian.transpose() * weighted;
    of.gradient.noalias() += weighted.transpose() * rows.residual;
    of.rows += rows.residual.size();
  });
  return all;
}

template <class S>
void OwnPosesEvaluator<S>::fit(ParameterValues values, Losses losses) {
  now_ = best_;
  for (std::size_t s = 0; s < now_.size(); ++s) place(s);
  std::vector<detail::OwnPoseSums> at = sums(values, losses);
  std::vector<detail::Damping> damping(now_.size());
  std::vector<bool> moves(now_.size(), true);
  constexpr int kMostSteps = 100;
  constexpr double kSettled = 1e-14;  // of the cost
  for (int step = 0; step < kMostSteps; ++step) {
    const Poses before = now_;
    std::vector<double> promised(now_.size(), 0.0);
    for (std::size_t s = 0; s < now_.size(); ++s) {
      if (!moves[s]) continue;
      const Eigen::VectorXd change = at[s].step(damping[s].value);
      promised[s] = at[s].decrease(change);
      moves[s] = promised[s] > kSettled * at[s].cost && damping[s].value < detail::Damping::kMost;
      if (!moves[s]) continue;
      for (std::size_t f = 0; f < now_[s].size(); ++f) {
        now_[s][f] = detail::moved(now_[s][f], change.segment(6 * static_cast<Eigen::Index>(f), 6));
      }
      place(s);
    }
    if (std::find(moves.begin(), moves.end(), true) == moves.end()) return;
    std::vector<detail::OwnPoseSums> there = sums(values, losses);
    for (std::size_t s = 0; s < now_.size(); ++s) {
      if (!moves[s]) continue;
      const bool is_better = there[s].rows == at[s].rows && there[s].cost <= at[s].cost;
      damping[s].update(is_better ? (at[s].cost - there[s].cost) / promised[s] : -1.0);
      if (is_better) {
        at[s] = std::move(there[s]);
      } else {
        now_[s] = before[s];
        place(s);
      }
    }
  }
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
