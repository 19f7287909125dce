// Definitions of speed_limit.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/trust/systematic/speed_limit.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <optional>
#include <set>
#include <vector>

#include "kinecal/geometry/ldlt.hpp"
#include "kinecal/geometry/median.hpp"
#include "kinecal/parameters/joint_models/joint_model.hpp"
#include "kinecal/samples/joint_moves.hpp"
#include "kinecal/solve/linear_fit.hpp"

namespace kinecal {

namespace detail {
namespace {

// Two parts of a variance: what all samples share, and what grows with their speed.

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
[[nodiscard]] StampVariance variance_of_thirds(const std::vector<StampError>& errors) {
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
[[nodiscard]] StampVariance fit_stamp_variance(const std::vector<StampError>& errors) {
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

// Rows of a calibration, what a lag changes in them, and the noise apart from that.

/// Rows of a calibration at its solution, and their derivatives by the stamp: a wrong stamp is a change
/// of all lags, since camera and target are both where they were at another time.
struct LagRows {
  LinearFit fit;            ///< by the free parameters
  Eigen::MatrixXd inverse;  ///< (coordinates x coordinates) of J^T J
  Eigen::VectorXd slope;    ///< (rows) by the stamp, 1/s
  Eigen::VectorXd sigma;    ///< (rows) noise of the weighted residual
};

/// Derivatives of all rows by one parameter.
[[nodiscard]] Eigen::VectorXd column_of(const AnyProblem& problem, int parameter,
                                        ParameterValues values) {
  const FreeSet only({parameter}, problem.table().size());
  const Coordinates itself{Eigen::MatrixXd::Ones(1, 1), Eigen::MatrixXd(1, 0),
                           Eigen::VectorXd::Zero(1), Eigen::VectorXd::Ones(1)};
  return linear_rows(*problem.evaluator(only, 1), values, itself).jacobian.col(0);
}

/// Noise of each error block, across the direction in which a wrong stamp moves the rows of a sample:
/// robustly, from the median of samples.
[[nodiscard]] Eigen::VectorXd noise_across(const LagRows& rows) {
  std::map<int, std::vector<double>> variances;  // by error block
  for (const RowBlock& block : rows.fit.blocks) {
    const auto r = rows.fit.residual.segment(block.first, block.size);
    const auto c = rows.slope.segment(block.first, block.size);
    const double along = c.squaredNorm() > 0.0 ? r.dot(c) * r.dot(c) / c.squaredNorm() : 0.0;
    const double freedom = static_cast<double>(block.size - (c.squaredNorm() > 0.0 ? 1 : 0));
    if (freedom < 1.0) continue;
    const double median =
        std::pow(1.0 - 2.0 / (9.0 * freedom), 3);  // of chi-square (Wilson, Hilferty)
    variances[block.term].push_back((r.squaredNorm() - along) / (freedom * median));
  }
  const auto all = static_cast<double>(rows.fit.residual.size());
  const double kept = std::max(0.1, 1.0 - static_cast<double>(rows.fit.size()) / all);
  Eigen::VectorXd sigma = Eigen::VectorXd::Ones(rows.fit.residual.size());
  for (const RowBlock& block : rows.fit.blocks) {
    const auto found = variances.find(block.term);
    if (found == variances.end()) continue;
    const double variance = median_of(found->second) / kept;
    if (variance > 0.0) sigma.segment(block.first, block.size).setConstant(std::sqrt(variance));
  }
  return sigma;
}

/// @param lags  indices in the table
[[nodiscard]] LagRows lag_rows(const AnyProblem& problem, const FreeSet& free,
                               ParameterValues values, const std::vector<int>& lags) {
  LagRows rows;
  const Coordinates determined = determined_coordinates(problem, free, values);
  rows.fit = linear_fit(*problem.evaluator(free, 1), values, determined);
  rows.slope = Eigen::VectorXd::Zero(rows.fit.residual.size());
  for (const int lag : lags) rows.slope += column_of(problem, lag, values);
  rows.sigma = noise_across(rows);
  const Eigen::MatrixXd hessian =
      rows.fit.jacobian.transpose() * rows.fit.jacobian + rows.fit.prior_hessian;
  const Eigen::MatrixXd identity = Eigen::MatrixXd::Identity(rows.fit.size(), rows.fit.size());
  rows.inverse = Ldlt(hessian).solve(identity);
  return rows;
}

/// True if joints move a sensor.
[[nodiscard]] bool is_moved(const MountedSensor& sensor) {
  const auto moves_it = [](const ChainJoint& joint) { return moves(joint.type); };
  return std::any_of(sensor.chains().begin(), sensor.chains().end(), [&](const SampledChain& of) {
    return std::any_of(of.chain().joints.begin(), of.chain().joints.end(), moves_it);
  });
}

/// A sample whose residuals change with the stamp.
struct MovingSample {
  StampError error;
  double rate = 0.0;  ///< slope per coordinate and speed of the fastest joint, 1/rad; 0: it stands
  Eigen::VectorXd gradient;  ///< (coordinates) J^T c
};

/// The samples of an error block.
[[nodiscard]] std::vector<MovingSample> moving_samples(const LagRows& rows, int term,
                                                       std::span<const Sample> samples) {
  constexpr double kLeast = 0.1;    // of the variance of a residual
  constexpr double kStands = 0.01;  // rad/s
  std::vector<MovingSample> all;
  for (const RowBlock& block : rows.fit.blocks) {
    const auto c = rows.slope.segment(block.first, block.size);
    const double square = c.squaredNorm();
    if (block.term != term || square == 0.0) continue;
    const double along = c.dot(rows.fit.residual.segment(block.first, block.size));
    const double sigma = rows.sigma(block.first);
    MovingSample& moving = all.emplace_back();
    moving.gradient = rows.fit.jacobian.middleRows(block.first, block.size).transpose() * c;
    const double leverage = moving.gradient.dot(rows.inverse * moving.gradient) / square;
    moving.error = {along * along / square / (sigma * sigma) / std::max(kLeast, 1.0 - leverage),
                    std::sqrt(square) / sigma};
    const double speed =
        fastest_joint(samples[static_cast<std::size_t>(block.sample)]).value_or(0.0);
    if (speed <= kStands) continue;
    moving.rate = moving.error.slope / std::sqrt(static_cast<double>(block.size)) / speed;
  }
  std::sort(all.begin(), all.end(), [](const MovingSample& a, const MovingSample& b) {
    return a.error.slope < b.error.slope;
  });
  return all;
}

/// The largest +- of free lags, with noise and jitter; 0 if all are held.
[[nodiscard]] double deviation_of(const LagRows& rows, const std::vector<int>& columns,
                                  const std::vector<MovingSample>& samples,
                                  const StampVariance& variance) {
  double largest = 0.0;
  for (const int column : columns) {
    const Eigen::VectorXd of_lag =
        rows.inverse * rows.fit.coordinates.basis.row(column).transpose();
    const Eigen::VectorXd weights = rows.fit.jacobian * of_lag;
    double sum = variance.still * weights.cwiseProduct(rows.sigma).squaredNorm();
    for (const MovingSample& sample : samples) {
      const double share = sample.gradient.dot(of_lag);
      sum += std::max(0.0, variance.jitter) * share * share;
    }
    largest = std::max(largest, std::sqrt(sum));
  }
  return largest;
}

[[nodiscard]] std::optional<SpeedLimit> limit_of(const LagRows& rows, int term,
                                                 const std::vector<int>& columns,
                                                 std::span<const Sample> samples) {
  const std::vector<MovingSample> moving = moving_samples(rows, term, samples);
  std::vector<StampError> errors;
  std::vector<double> rates;
  for (const MovingSample& sample : moving) {
    errors.push_back(sample.error);
    if (sample.rate > 0.0) rates.push_back(sample.rate);
  }
  constexpr std::size_t kFewest = 10;
  if (rates.size() < kFewest) return std::nullopt;
  const StampVariance variance = fit_stamp_variance(errors);
  constexpr double kOneInThousand = 3.09, kOneInTwenty = 1.645;  // quantiles of chance
  SpeedLimit limit;
  limit.samples = static_cast<int>(moving.size());
  limit.jitter_most = std::sqrt(std::max(0.0, variance.jitter) + kOneInTwenty * variance.deviation);
  if (variance.jitter > kOneInThousand * variance.deviation)
    limit.jitter = std::sqrt(variance.jitter);
  limit.lag_deviation = deviation_of(rows, columns, moving, variance);
  for (const Sample& sample : samples) {
    limit.fastest = std::max(limit.fastest, fastest_joint(sample).value_or(0.0));
  }
  const double stamps = limit.jitter > 0.0 ? limit.jitter : limit.jitter_most;
  const double each = median_of(rates) * std::hypot(stamps, limit.lag_deviation);
  limit.speed = each > 0.0 ? 1.0 / (3.0 * each) : limit.fastest;
  return limit;
}

}  // namespace
}  // namespace detail

std::string SpeedLimit::text() const {
  constexpr double kMilliseconds = 1e3;
  const auto number = [](const char* format, double value) {
    char buffer[32];
    std::snprintf(buffer, sizeof buffer, format, value);
    return std::string(buffer);
  };
  const bool is_seen = jitter > 0.0;
  const std::string stamps = sensors + ": stamps jitter by " + (is_seen ? "" : "less than ") +
                             number("%.2g", kMilliseconds * (is_seen ? jitter : jitter_most)) +
                             " ms: ";
  if (speed >= fastest) {
    return stamps + "at all speeds of these samples, up to " + number("%.2f", fastest) +
           " rad/s, motion adds less than a third of the noise";
  }
  return stamps + "up to " + number("%.2g", speed) +
         " rad/s motion adds less than a third of the noise";
}

std::vector<SpeedLimit> speed_limits(const AnyProblem& problem, const FreeSet& free,
                                     ParameterValues values, std::span<const Sample> samples) {
  const auto lag_of = [&](const MountedSensor& sensor) {
    return problem.table().find(parameter_name(sensor.mount().parameter_prefix(), kLag.name));
  };
  std::set<int> lags;  // several sensors may share a prefix
  for (const MountedSensor& sensor : problem.sensors()) lags.insert(lag_of(sensor));
  lags.erase(-1);
  std::vector<SpeedLimit> all;
  if (lags.empty()) return all;
  const detail::LagRows rows =
      detail::lag_rows(problem, free, values, std::vector<int>(lags.begin(), lags.end()));
  for (int t = 0; t < problem.num_terms(); ++t) {
    std::string names;
    std::vector<int> columns;
    for (const int s : problem.term(t).sensors) {
      const MountedSensor& sensor = problem.sensors()[static_cast<std::size_t>(s)];
      const int lag = lag_of(sensor);
      if (lag < 0 && detail::is_moved(sensor)) {
        names.clear();
        break;
      }
      if (lag < 0) continue;
      names += (names.empty() ? "" : " and ") + sensor.mount().parameter_prefix();
      if (free.column(lag) >= 0) columns.push_back(free.column(lag));
    }
    if (names.empty()) continue;
    if (auto limit = detail::limit_of(rows, t, columns, samples)) {
      limit->sensors = names;
      all.push_back(std::move(*limit));
    }
  }
  return all;
}

}  // namespace kinecal
