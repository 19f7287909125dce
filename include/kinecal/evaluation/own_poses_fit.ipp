// How OwnPosesEvaluator fits the poses of samples.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <utility>

#include "kinecal/evaluation/own_poses.hpp"
#include "kinecal/evaluation/own_poses_parts.ipp"

namespace kinecal {

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
std::vector<detail::OwnPoseSums> OwnPosesEvaluator<S>::sums_at(Poses poses, ParameterValues values,
                                                               Losses losses) {
  now_ = std::move(poses);
  for (std::size_t s = 0; s < now_.size(); ++s) place(s);
  return sums(values, losses);
}

template <class S>
std::vector<detail::OwnPoseSums> OwnPosesEvaluator<S>::start(ParameterValues values,
                                                             Losses losses) {
  std::vector<detail::OwnPoseSums> at = sums_at(best_, values, losses);
  if (known_.by_free.empty()) return at;
  Eigen::VectorXd change(free_.size());
  for (Eigen::Index i = 0; i < change.size(); ++i) {
    const auto p = static_cast<std::size_t>(free_.parameters()[static_cast<std::size_t>(i)]);
    change(i) = values[p] - known_.values[p];
  }
  Poses before = now_, expected = known_.poses;
  for (std::size_t s = 0; s < expected.size(); ++s) {
    detail::move(expected[s], -(known_.by_free[s] * change));
  }
  std::vector<detail::OwnPoseSums> there = sums_at(std::move(expected), values, losses);
  for (std::size_t s = 0; s < now_.size(); ++s) {
    if (there[s].rows == at[s].rows && there[s].cost <= at[s].cost) {
      at[s] = std::move(there[s]);
    } else {
      now_[s] = before[s];
      place(s);
    }
  }
  return at;
}

template <class S>
void OwnPosesEvaluator<S>::fit(ParameterValues values, Losses losses) {
  std::vector<detail::OwnPoseSums> at = start(values, losses);
  std::vector<detail::Damping> damping(now_.size());
  std::vector<bool> moves(now_.size(), true);
  constexpr int kMostSteps = 100;
  constexpr double kSettled = 1e-12;  // of the cost
  for (int step = 0; step < kMostSteps; ++step) {
    const Poses before = now_;
    std::vector<double> promised(now_.size(), 0.0);
    for (std::size_t s = 0; s < now_.size(); ++s) {
      if (!moves[s]) continue;
      const Eigen::VectorXd change = at[s].step(damping[s].value);
      promised[s] = at[s].decrease(change);
      moves[s] = promised[s] > kSettled * at[s].cost && damping[s].value < detail::Damping::kMost;
      if (!moves[s]) continue;
      detail::move(now_[s], change);
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

}  // namespace kinecal
