// Two parts of a variance: what all samples share, and what grows with their speed.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <vector>

#include "kinecal/geometry/median.hpp"

namespace kinecal::detail {

/// A sample along the change of its residuals with the stamp.
struct StampError {
  double square = 0.0;  ///< of the residual, in variances of the noise
  double slope = 0.0;   ///< change per second, in standard deviations of the noise
};

/// Parts of the variance of stamp errors.
struct StampVariance {
  double still = 1.0;      ///< of samples that do not move
  double jitter = 0.0;     ///< of the stamps, s^2; negative if chance has it so
  double deviation = 0.0;  ///< of `jitter`, s^2

  [[nodiscard]] double of(const StampError& error) const {
    return still + std::max(0.0, jitter) * error.slope * error.slope;
  }
};

/// A first guess, from medians of the slowest and the fastest third.
/// @param errors  sorted by slopes, at least three
[[nodiscard]] inline StampVariance variance_of_thirds(const std::vector<StampError>& errors) {
  constexpr double kMedianOfSquare = 0.4549;  // of a standard normal variable
  const std::ptrdiff_t third = std::ssize(errors) / 3;
  const auto median = [&](std::ptrdiff_t first, auto number) {
    std::vector<double> numbers;
    for (auto at = errors.begin() + first; at != errors.begin() + first + third; ++at) {
      numbers.push_back(number(*at));
    }
    return median_of(std::move(numbers));
  };
  const auto square = [](const StampError& e) { return e.square / kMedianOfSquare; };
  const auto slope = [](const StampError& e) { return e.slope * e.slope; };
  const std::ptrdiff_t fast = std::ssize(errors) - third;
  constexpr double kLeast = 0.1;  // of the variance of the noise
  StampVariance guess;
  guess.still = std::max(kLeast, median(0, square));
  guess.jitter = std::max(0.0, (median(fast, square) - guess.still) / median(fast, slope));
  return guess;
}

/// Fits both parts: see speed_limit.hpp.
/// @param errors  sorted by slopes, at least three, with slopes that are not zero
[[nodiscard]] inline StampVariance fit_stamp_variance(const std::vector<StampError>& errors) {
  constexpr int kReweightings = 30;
  constexpr double kFarthest = 3.5 * 3.5;  // squares of standard deviations
  constexpr double kLeast = 0.1;           // of the variance of the noise
  StampVariance now = variance_of_thirds(errors);
  const double unit = errors.back().slope * errors.back().slope;  // keeps both columns alike
  for (int round = 0; round < kReweightings; ++round) {
    Eigen::Matrix2d information = Eigen::Matrix2d::Zero();
    Eigen::Vector2d sum = Eigen::Vector2d::Zero();
    for (const StampError& error : errors) {
      const double variance = now.of(error);
      if (error.square > kFarthest * variance) continue;
      const Eigen::Vector2d row(1.0, error.slope * error.slope / unit);
      const double weight = 0.5 / (variance * variance);
      information += weight * row * row.transpose();
      sum += weight * error.square * row;
    }
    const Eigen::LDLT<Eigen::Matrix2d> solver(information);
    if (solver.rcond() < 1e-9) return {now.still, 0.0, now.still / unit};  // all are as fast
    const Eigen::Vector2d parts = solver.solve(sum);
    now.still = std::max(kLeast, parts(0));
    now.jitter = parts(1) / unit;
    now.deviation = std::sqrt(solver.solve(Eigen::Vector2d::UnitY())(1)) / unit;
  }
  return now;
}

}  // namespace kinecal::detail
