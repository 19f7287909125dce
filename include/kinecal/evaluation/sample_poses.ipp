// Definitions of sample_poses.hpp, for a scalar S.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "kinecal/evaluation/sample_poses.hpp"
#include "kinecal/geometry/eigenpairs.hpp"
#include "kinecal/geometry/ldlt.hpp"
#include "kinecal/kinematics/floating_joint.hpp"

namespace kinecal {

namespace detail {

// The parts of sample_poses.ipp that do not depend on the scalar.

/// Table indices of the parameters of the poses that samples have of their own: six of each frame.
[[nodiscard]] inline FreeSet sample_pose_parameters(const AnyProblem& problem) {
  std::vector<int> all;
  for (const std::string& frame : problem.sample_poses()) {
    for (const auto axis : kFrameAxes) {
      all.push_back(problem.table().find(parameter_name(frame, axis)));
    }
  }
  return {std::move(all), problem.table().size()};
}

/// The columns of two sets.
[[nodiscard]] inline FreeSet joined(const FreeSet& first, const FreeSet& second) {
  std::vector<int> all = first.parameters();
  all.insert(all.end(), second.parameters().begin(), second.parameters().end());
  return {std::move(all), first.table_size()};
}

/// Where the numbers of the poses stand in the rows of a layout.
[[nodiscard]] inline std::vector<PosePlace> pose_places(const AnyProblem& problem,
                                                        const SampleLayout& layout) {
  std::vector<PosePlace> places;
  for (std::size_t s = 0; s < layout.sensors.size(); ++s) {
    if (!layout.sensors[s]) continue;
    const std::vector<SampledChain>& chains = problem.sensors()[s].chains();
    for (std::size_t c = 0; c < chains.size(); ++c) {
      const std::size_t first = layout.sensors[s]->joints[c];
      if (first == kAbsent) continue;
      const std::size_t stride = 2 + most_effects(chains[c].parameters());
      const std::vector<ChainJoint>& joints = chains[c].chain().joints;
      for (std::size_t f = 0; f < problem.sample_poses().size(); ++f) {
        PosePlace place{f, {}};
        bool found = false;
        for (std::size_t j = 0; j < joints.size(); ++j) {
          if (joints[j].floating != problem.sample_poses()[f]) continue;
          place.offsets[floating_coordinate(joints[j].name)->index] = first + stride * j;
          found = true;
        }
        if (found) places.push_back(place);
      }
    }
  }
  return places;
}

/// Moves poses.
/// @param step  (6 of each) translation and rotation vector, in the moved frame
inline void move(std::vector<Pose<double>>& poses, const Eigen::VectorXd& step) {
  for (std::size_t f = 0; f < poses.size(); ++f) {
    const auto by = step.segment<6>(6 * static_cast<Eigen::Index>(f));
    poses[f] = poses[f] * Pose<double>{exp(Vector3<double>(by.tail<3>())), by.head<3>()};
  }
}

/// The square of each row's weight, its loss included.
/// @param cost  adds the cost of the rows
[[nodiscard]] inline Eigen::VectorXd squared_weights(const Term& term, const TermResiduals& rows,
                                                     Losses losses, double& cost) {
  const Loss loss = term.options.loss_for(losses);
  Eigen::VectorXd weights = term.weight * rows.factor;
  const int size = term.feature_size;
  for (Eigen::Index row = 0; row < weights.size(); row += size) {
    auto of_feature = weights.segment(row, size);
    const auto value =
        loss(of_feature.cwiseProduct(rows.residual.segment(row, size)).squaredNorm());
    cost += 0.5 * value.rho;
    of_feature = value.derivative * of_feature.cwiseAbs2().eval();
  }
  return weights;
}

/// Lengths of the columns of a Jacobian by its J^T J; one for a column of zeros.
[[nodiscard]] inline Eigen::VectorXd column_lengths(const Eigen::MatrixXd& hessian) {
  return hessian.diagonal().unaryExpr([](double h) { return h > 0.0 ? std::sqrt(h) : 1.0; });
}

/// The pseudo-inverse of a (k x k) J^T J: directions without curvature stay out.
[[nodiscard]] inline Eigen::MatrixXd inverse_where_determined(const Eigen::MatrixXd& hessian) {
  const Eigen::VectorXd per_length = column_lengths(hessian).cwiseInverse();
  const Eigenpairs eigen = eigenpairs(per_length.asDiagonal() * hessian * per_length.asDiagonal());
  constexpr double kNoCurvature = 1e-12;  // of unit columns
  const Eigen::VectorXd inverse =
      eigen.values.unaryExpr([](double value) { return value > kNoCurvature ? 1.0 / value : 0.0; });
  return per_length.asDiagonal() * eigen.vectors * inverse.asDiagonal() *
         eigen.vectors.transpose() * per_length.asDiagonal();
}

inline Eigen::VectorXd SamplePoseSums::step(double damping) const {
  const Eigen::VectorXd per_length = column_lengths(hessian).cwiseInverse();
  Eigen::MatrixXd scaled = per_length.asDiagonal() * hessian * per_length.asDiagonal();
  constexpr double kNoCurvature = 1e-12;  // of unit columns
  scaled.diagonal().array() += damping + kNoCurvature;
  return per_length.cwiseProduct(
      Ldlt(scaled).solve(Eigen::VectorXd(-per_length.cwiseProduct(gradient))));
}

inline double SamplePoseSums::decrease(const Eigen::VectorXd& change) const {
  return -gradient.dot(change) - 0.5 * change.dot(hessian * change);
}

/// The damping of a Levenberg-Marquardt search.
/// Source: Nielsen, Damping Parameter in Marquardt's Method, 1999.
struct Damping {
  static constexpr double kMost = 1e12;  ///< where no step helps
  double value = 1e-6, growth = 2.0;

  /// @param gain  the decrease of the cost, as a share of what was promised; negative: there was none
  void update(double gain) {
    if (gain < 0.0) {
      value = std::max(1e-4, value * growth);
      growth *= 2.0;
    } else {
      value *= std::max(1.0 / 3.0, 1.0 - std::pow(2.0 * gain - 1.0, 3));
      growth = 2.0;
    }
  }
};

}  // namespace detail

// How SamplePosesEvaluator fits the poses of samples.

template <class S>
void SamplePosesEvaluator<S>::place(std::size_t sample) {
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
std::vector<detail::SamplePoseSums> SamplePosesEvaluator<S>::sums(ParameterValues values,
                                                                  Losses losses) {
  std::vector<detail::SamplePoseSums> all(now_.size(), detail::SamplePoseSums(own_.size()));
  (void)by_own_->evaluate(values, true, [&](int t, int sample, const TermResiduals& rows) {
    detail::SamplePoseSums& of = all[static_cast<std::size_t>(sample)];
    const Eigen::VectorXd w2 = detail::squared_weights(problem_.term(t), rows, losses, of.cost);
    const Eigen::MatrixXd weighted = w2.asDiagonal() * rows.jacobian;
    of.hessian.noalias() += rows.jacobian.transpose() * weighted;
    of.gradient.noalias() += weighted.transpose() * rows.residual;
    of.rows += rows.residual.size();
  });
  return all;
}

template <class S>
std::vector<detail::SamplePoseSums> SamplePosesEvaluator<S>::sums_at(Poses poses,
                                                                     ParameterValues values,
                                                                     Losses losses) {
  now_ = std::move(poses);
  for (std::size_t s = 0; s < now_.size(); ++s) place(s);
  return sums(values, losses);
}

template <class S>
std::vector<detail::SamplePoseSums> SamplePosesEvaluator<S>::start(ParameterValues values,
                                                                   Losses losses) {
  std::vector<detail::SamplePoseSums> at = sums_at(best_, values, losses);
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
  std::vector<detail::SamplePoseSums> there = sums_at(std::move(expected), values, losses);
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
void SamplePosesEvaluator<S>::fit(ParameterValues values, Losses losses) {
  std::vector<detail::SamplePoseSums> at = start(values, losses);
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
    std::vector<detail::SamplePoseSums> there = sums(values, losses);
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
SamplePosesEvaluator<S>::SamplePosesEvaluator(const BasicProblem<S>& problem, const FreeSet& free)
    : problem_(problem),
      free_(free),
      own_(detail::sample_pose_parameters(problem)),
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
std::optional<UndefinedResidual> SamplePosesEvaluator<S>::collect(ParameterValues values,
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
std::optional<UndefinedResidual> SamplePosesEvaluator<S>::evaluate(ParameterValues values,
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
NormalEquations SamplePosesEvaluator<S>::normal_equations(ParameterValues values, bool derivatives,
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
std::vector<std::vector<Pose<double>>> SamplePosesEvaluator<S>::sample_poses(
    ParameterValues values) {
  fit(values, Losses::as_given);
  return now_;
}

}  // namespace kinecal
