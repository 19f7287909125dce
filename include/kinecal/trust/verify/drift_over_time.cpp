// Definitions of drift_over_time.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/trust/verify/drift_over_time.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <map>
#include <stdexcept>

#include "kinecal/solve/spectrum.hpp"
#include "kinecal/trust/f_distribution.hpp"

namespace kinecal {

namespace detail {
namespace {

/// Row after row, as a matrix; also of a vector.
[[nodiscard]] Eigen::MatrixXd matrix_of(std::span<const double> numbers, Eigen::Index rows) {
  Eigen::MatrixXd matrix(rows, std::ssize(numbers) / rows);
  for (Eigen::Index i = 0; i < matrix.size(); ++i) {
    matrix(i / matrix.cols(), i % matrix.cols()) = numbers[static_cast<std::size_t>(i)];
  }
  return matrix;
}

[[nodiscard]] std::vector<double> numbers_of(const Eigen::MatrixXd& matrix) {
  std::vector<double> numbers;
  for (Eigen::Index i = 0; i < matrix.size(); ++i) {
    numbers.push_back(matrix(i / matrix.cols(), i % matrix.cols()));
  }
  return numbers;
}

/// A recording as rows: what it says of the change, and how sure.
struct Weighted {
  double time;             ///< from the mean, in units of the whole time
  Eigen::VectorXd change;  ///< (k)
  Eigen::MatrixXd weight;  ///< (k x k) V^-1; zero along what the recording does not determine
  Eigen::Index rank;
};

/// Least squares by recordings: a alone, or a and b.
struct LineFit {
  Eigen::VectorXd values;      ///< (k) or (2k)
  Eigen::MatrixXd covariance;  ///< for s = 1
  Eigen::Index rank = 0;
  double squares = 0.0;  ///< Q

  LineFit(const std::vector<Weighted>& all, bool has_slope) {
    const Eigen::Index k = all.front().change.size(), n = has_slope ? 2 * k : k;
    Eigen::MatrixXd information = Eigen::MatrixXd::Zero(n, n);
    Eigen::VectorXd right = Eigen::VectorXd::Zero(n);
    const auto design = [&](const Weighted& of) {
      Eigen::MatrixXd rows(k, n);
      rows.leftCols(k).setIdentity();
      if (has_slope) rows.rightCols(k) = of.time * Eigen::MatrixXd::Identity(k, k);
      return rows;
    };
    for (const Weighted& of : all) {
      const Eigen::MatrixXd rows = design(of);
      information += rows.transpose() * of.weight * rows;
      right += rows.transpose() * of.weight * of.change;
    }
    const Spectrum spectrum(information);
    covariance = spectrum.pseudo_inverse();
    rank = n - spectrum.null;
    values = covariance * right;
    for (const Weighted& of : all) {
      const Eigen::VectorXd rest = of.change - design(of) * values;
      squares += rest.dot(of.weight * rest);
    }
  }
  /// What is left of a recording.
  [[nodiscard]] Eigen::VectorXd rest(const Weighted& of) const {
    const Eigen::Index k = of.change.size();
    return of.change - values.head(k) - of.time * values.tail(k);
  }
};

constexpr double kMostMemory = 0.9;  ///< a larger one cannot be told from a drift

/// As how many fewer recordings they count.
[[nodiscard]] double fewer(double memory) {
  return (1.0 + memory) / (1.0 - memory);
}

/// Correlation of what is left in consecutive recordings; not negative, which costs nothing.
[[nodiscard]] double memory_of(const std::vector<Weighted>& all, const LineFit& fit) {
  Eigen::MatrixXd mean =
      Eigen::MatrixXd::Zero(all.front().weight.rows(), all.front().weight.rows());
  for (const Weighted& of : all) mean += of.weight;
  double neighbours = 0.0, own = 0.0;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const Eigen::VectorXd weighted = mean * fit.rest(all[i]);
    own += weighted.dot(fit.rest(all[i]));
    if (i > 0) neighbours += weighted.dot(fit.rest(all[i - 1]));
  }
  return own > 0.0 ? std::clamp(neighbours / own, 0.0, kMostMemory) : 0.0;
}

}  // namespace
}  // namespace detail

double DriftLine::slope_deviation(std::size_t parameter) const {
  const std::size_t k = slope.size(), row = k + parameter;
  return std::sqrt(std::max(0.0, covariance[row * 2 * k + row]));
}

std::optional<DriftLine> drift_line(std::span<const TimedChange> changes) {
  constexpr std::ptrdiff_t kLeast = 4;
  if (std::ssize(changes) < kLeast) return std::nullopt;
  const std::size_t parameters = changes.front().change.size();
  DriftLine line{
      .recordings = static_cast<int>(changes.size()), .level = {}, .slope = {}, .covariance = {}};
  double first = changes.front().time;
  line.last = first;
  for (const TimedChange& of : changes) {
    if (of.change.size() != parameters || of.covariance.size() != parameters * parameters ||
        parameters == 0) {
      throw std::invalid_argument("changes of one mover have different numbers of parameters");
    }
    line.origin += of.time / static_cast<double>(changes.size());
    first = std::min(first, of.time);
    line.last = std::max(line.last, of.time);
  }
  const double span = line.last - first;
  if (!(span > 0.0)) return std::nullopt;

  const auto k = static_cast<Eigen::Index>(parameters);
  std::vector<detail::Weighted> all;
  double known = 0.0;
  for (const TimedChange& of : changes) {
    const detail::Spectrum spectrum(detail::matrix_of(of.covariance, k));
    all.push_back({(of.time - line.origin) / span, detail::matrix_of(of.change, k),
                   spectrum.pseudo_inverse(), k - spectrum.null});
    const auto rank = static_cast<double>(all.back().rank);
    known += rank;
    line.score += of.score - 2.0 * rank;
  }
  const detail::LineFit still(all, false), moving(all, true);
  const auto rank = static_cast<double>(moving.rank - still.rank);
  line.memory = detail::memory_of(all, moving);
  const double freedom = known - static_cast<double>(moving.rank);
  if (rank < 1.0 || freedom < 1.0) return std::nullopt;
  const double variance = moving.squares / freedom;
  line.scatter = std::sqrt(variance);
  line.score += moving.squares + 2.0 * static_cast<double>(moving.rank);
  const double fall = std::max(0.0, still.squares - moving.squares) / rank;
  const double most = detail::fewer(std::min(
      detail::kMostMemory, line.memory + 2.0 / std::sqrt(static_cast<double>(changes.size()))));
  if (freedom / most >= 1.0) {
    line.probability = variance > 0.0 ? f_tail(fall / (most * variance), rank, freedom / most)
                       : fall > 0.0   ? 0.0
                                      : 1.0;
  }
  Eigen::VectorXd unit = Eigen::VectorXd::Ones(2 * k);
  unit.tail(k).setConstant(1.0 / span);
  const Eigen::VectorXd values = unit.cwiseProduct(moving.values);
  line.level = detail::numbers_of(values.head(k));
  line.slope = detail::numbers_of(values.tail(k));
  line.covariance = detail::numbers_of(detail::fewer(line.memory) * variance *
                                       (unit.asDiagonal() * moving.covariance * unit.asDiagonal()));
  return line;
}

std::vector<DriftingRobot> drifting_robots(std::span<const MoverLine> lines, double level) {
  constexpr double kTold = 6.0;  // likelihood ratio of 20, as of check_drift()
  const auto tests = static_cast<double>(lines.size());
  std::map<int, std::vector<const MoverLine*>> found;
  std::map<int, double> least;
  for (const MoverLine& of : lines) {
    const double probability = std::min(1.0, tests * of.line.probability);
    if (probability >= level) continue;
    found[of.robot].push_back(&of);
    least[of.robot] = std::min(probability, least.contains(of.robot) ? least[of.robot] : 1.0);
  }
  std::vector<DriftingRobot> robots;
  for (auto& [robot, movers] : found) {
    std::stable_sort(movers.begin(), movers.end(), [](const MoverLine* a, const MoverLine* b) {
      return a->line.score < b->line.score;
    });
    DriftingRobot& of =
        robots.emplace_back(DriftingRobot{robot, movers.front()->mover, {}, least[robot]});
    for (std::size_t i = 1; i < movers.size(); ++i) {
      if (movers[i]->line.score < movers.front()->line.score + kTold) {
        of.alike.push_back(movers[i]->mover);
      }
    }
  }
  return robots;
}

double ChangeSize::of(std::span<const double> change) const {
  const auto k = static_cast<Eigen::Index>(change.size());
  const Eigen::VectorXd c = detail::matrix_of(change, k);
  return std::sqrt(std::max(0.0, c.dot(detail::matrix_of(effect, k) * c)));
}

std::optional<When> passes(const DriftLine& line, const ChangeSize& size, double limit) {
  const auto k = static_cast<Eigen::Index>(line.slope.size());
  const Eigen::MatrixXd g = detail::matrix_of(size.effect, k);
  const Eigen::VectorXd b = detail::matrix_of(line.slope, k);
  const Eigen::VectorXd now =
      Eigen::VectorXd(detail::matrix_of(line.level, k)) + (line.last - line.origin) * b;
  // |now + b t|^2 = limit^2, t from the last recording
  const double at = now.dot(g * now) - limit * limit, half = now.dot(g * b), growth = b.dot(g * b);
  if (at < 0.0 && !(growth > 0.0)) return std::nullopt;
  const double after = at >= 0.0 ? 0.0 : (std::sqrt(half * half - growth * at) - half) / growth;
  When when{line.last + after, 0.0};
  Eigen::VectorXd by(2 * k);  // derivative of half the squared size by a and b
  by.head(k) = g * (now + after * b);
  by.tail(k) = (when.time - line.origin) * by.head(k);
  const double rate = by.head(k).dot(b);
  const Eigen::MatrixXd covariance = detail::matrix_of(line.covariance, 2 * k);
  if (std::abs(rate) > 0.0)
    when.deviation = std::sqrt(std::max(0.0, by.dot(covariance * by))) / std::abs(rate);
  return when;
}

}  // namespace kinecal
