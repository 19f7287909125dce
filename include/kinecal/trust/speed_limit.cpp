// Definitions of speed_limit.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/trust/speed_limit.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>
#include <set>

#include "kinecal/geometry/median.hpp"
#include "kinecal/parameters/joint_model.hpp"
#include "kinecal/samples/joint_moves.hpp"
#include "kinecal/trust/lag_rows.ipp"

namespace kinecal {
namespace detail {
namespace {

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
