// The fit of frames from one start.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

#include "kinecal/solve/fit_frames.hpp"
#include "kinecal/solve/rotation_grid.hpp"

namespace kinecal::detail {

inline constexpr double kNoFit = std::numeric_limits<double>::infinity();

/// Sets the free components of a rotation vector.
inline void set_rotation(const UnknownFrame& frame, const Vector3<double>& vector,
                         Eigen::VectorXd& values) {
  for (std::size_t k = 0; k < 3; ++k) {
    if (frame.axes[3 + k] >= 0) values(frame.axes[3 + k]) = vector(static_cast<int>(k));
  }
}

/// Component k of a grid rotation sets the k-th free axis.
inline void set_grid_rotation(const UnknownFrame& frame, int index, int count,
                              Eigen::VectorXd& values) {
  std::vector<int> free;
  for (std::size_t k = 3; k < 6; ++k) {
    if (frame.axes[k] >= 0) free.push_back(frame.axes[k]);
  }
  const Vector3<double> vector = grid_rotation(index, count, static_cast<int>(free.size()));
  for (std::size_t k = 0; k < free.size(); ++k) values(free[k]) = vector(static_cast<int>(k));
}

/// Limits rotation vectors to length pi: beyond that, derivatives fade.
inline void shorten_rotations(std::span<const UnknownFrame> frames, Eigen::VectorXd& values) {
  for (const UnknownFrame& frame : frames) {
    if (frame.turns()) set_rotation(frame, shortest(rotation_of(frame, values)), values);
  }
}

/// Fits the evaluator's free parameters from one start.
class FrameFit {
 public:
  FrameFit(AnyEvaluator& evaluator, std::span<const UnknownFrame> frames)
      : evaluator_(evaluator), frames_(frames) {
    const FreeSet& free = evaluator.free();
    for (const UnknownFrame& frame : frames) {
      for (std::size_t k = 0; k < 3; ++k) {
        if (free.column(frame.axes[k]) >= 0) translations_.push_back(free.column(frame.axes[k]));
      }
    }
  }

  /// @param values      in: where to start; out: where it ended
  /// @param iterations  the largest number
  /// @returns  the cost; infinite if it is not defined there
  [[nodiscard]] double operator()(Eigen::VectorXd& values, int iterations) {
    NormalEquations at = placed(values);
    const double nothing = kRounding * at.cost;
    double damping = kFirstDamping;
    for (int i = 0; at.cost > nothing && i < iterations && damping < kMostDamping; ++i) {
      Eigen::VectorXd trial = values;
      add_step(at, damping, trial);
      NormalEquations next = placed(trial);
      if (!(next.cost <= at.cost)) {
        damping *= 8.0;
        continue;
      }
      const bool settled = at.cost - next.cost <= kSettled * at.cost;
      values = std::move(trial);
      at = std::move(next);
      if (settled) break;
      damping = std::max(0.1 * damping, kLeastDamping);
    }
    if (!std::isfinite(at.cost)) return kNoFit;
    return at.cost;
  }

 private:
  static constexpr double kFirstDamping = 1e-3, kLeastDamping = 1e-9, kMostDamping = 1e8;
  static constexpr double kSettled = 1e-6;    // of the cost, by one step
  static constexpr double kRounding = 1e-20;  // of the cost at the start

  [[nodiscard]] NormalEquations equations(const Eigen::VectorXd& values) {
    return evaluator_.normal_equations({values.data(), static_cast<std::size_t>(values.size())},
                                       true, Losses::convex);
  }

  /// Moves to the translations of least cost, as far as the cost is quadratic in them: the
  /// rotations then turn the frames about the points, not about an origin that may be far away.
  /// @returns  the normal equations there
  [[nodiscard]] NormalEquations placed(Eigen::VectorXd& values) {
    NormalEquations at = equations(values);
    if (translations_.empty() || !std::isfinite(at.cost)) return at;
    const std::vector<int>& t = translations_;
    Eigen::MatrixXd hessian = at.hessian(t, t);
    hessian.diagonal().array() += kLeastDamping * hessian.diagonal().maxCoeff();
    const Eigen::VectorXd step = hessian.ldlt().solve(-at.gradient(t));
    Eigen::VectorXd trial = values;
    for (std::size_t k = 0; k < t.size(); ++k) {
      trial(evaluator_.free().parameters()[static_cast<std::size_t>(t[k])]) +=
          step(static_cast<Eigen::Index>(k));
    }
    NormalEquations next = equations(trial);
    if (!(next.cost < at.cost)) return at;
    values = std::move(trial);
    return next;
  }

  void add_step(const NormalEquations& at, double damping, Eigen::VectorXd& values) const {
    constexpr double kFloor = 1e-9;  // of the largest: a direction without curvature stays
    Eigen::MatrixXd damped = at.hessian;
    const double floor = kFloor * damped.diagonal().maxCoeff();
    damped.diagonal() += damping * damped.diagonal().cwiseMax(floor);
    const Eigen::VectorXd step = damped.ldlt().solve(-at.gradient);
    const std::vector<int>& columns = evaluator_.free().parameters();
    for (std::size_t c = 0; c < columns.size(); ++c) {
      values(columns[c]) += step(static_cast<Eigen::Index>(c));
    }
    shorten_rotations(frames_, values);
  }

  AnyEvaluator& evaluator_;
  std::span<const UnknownFrame> frames_;
  std::vector<int> translations_;  ///< columns
};

}  // namespace kinecal::detail
