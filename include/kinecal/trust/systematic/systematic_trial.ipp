// Errors that are tried: their columns beside those of a fit, and how they are said.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <string>
#include <vector>

#include "kinecal/geometry/eigenpairs.hpp"
#include "kinecal/solve/linear_fit.hpp"
#include "kinecal/text/reading.hpp"
#include "kinecal/trust/noise/pose_groups.hpp"
#include "kinecal/trust/plausible_change.hpp"
#include "kinecal/trust/systematic/systematic_error.hpp"

namespace kinecal::detail {

// Whether columns that the model does not contain explain its residuals: the fall of the sum of squares if they
// are added to a fit.

/// What added columns explain.
struct Fall {
  double squares = 0.0;    ///< by which the sum of squares falls
  Eigen::VectorXd change;  ///< (added) their coefficients
  Eigen::VectorXd others;  ///< (coordinates) by which the model's own parameters move then
};

/// Columns X beside those of a fit (J, loss W).
class AddedColumns {
 public:
  /// Skips combinations of columns that the model's own parameters explain just as well.
  /// @param squared  (added x added) X^T W X
  /// @param cross    (added x coordinates) X^T W J
  /// @param scale    (added) one over the length of each column; zero: skipped
  /// @param inverse  of J^T W J
  AddedColumns(const Eigen::MatrixXd& squared, const Eigen::MatrixXd& cross,
               const Eigen::VectorXd& scale, const Eigen::MatrixXd& inverse)
      : others_(-inverse * cross.transpose()) {
    constexpr double kOwn = 1e-3;  // least share of a column's effect that others cannot explain
    const Eigenpairs own =
        eigenpairs(scale.asDiagonal() * (squared + cross * others_) * scale.asDiagonal());
    const Eigen::Index kept = (own.values.array() > kOwn).count();  // the last ones: they ascend
    units_ = own.values.tail(kept).cwiseSqrt().cwiseInverse().asDiagonal() *
             own.vectors.rightCols(kept).transpose() * scale.asDiagonal();
  }
  /// Each column in units of its own length.
  AddedColumns(const Eigen::MatrixXd& squared, const Eigen::MatrixXd& cross,
               const Eigen::MatrixXd& inverse)
      : AddedColumns(squared, cross, unit_lengths(squared), inverse) {}

  [[nodiscard]] int count() const { return static_cast<int>(others_.cols()); }
  /// By which the sum of squares of residuals r falls.
  /// @param gradient  (added) X^T W r
  [[nodiscard]] double squares(const Eigen::VectorXd& gradient) const {
    return (units_ * gradient).squaredNorm();
  }
  [[nodiscard]] Fall fall(const Eigen::VectorXd& gradient) const {
    const Eigen::VectorXd along = units_ * gradient;
    const Eigen::VectorXd change = -units_.transpose() * along;
    return {along.squaredNorm(), change, others_ * change};
  }

 private:
  [[nodiscard]] static Eigen::VectorXd unit_lengths(const Eigen::MatrixXd& squared) {
    return squared.diagonal().unaryExpr(
        [](double a) { return a > 0.0 ? 1.0 / std::sqrt(a) : 0.0; });
  }

  Eigen::MatrixXd others_;  ///< (coordinates x added)
  Eigen::MatrixXd units_;   ///< (combinations x added): of their unit lengths
};

/// True if added columns move the model's own parameters farther than robots are wrong.  The samples then
/// have so little in common that anything fits, and the fall is no evidence.
/// @param moves   (free) of the free parameters
/// @param except  columns of `free` that may move
[[nodiscard]] inline bool implausible(const AnyProblem& problem, const FreeSet& free,
                                      const Eigen::VectorXd& moves,
                                      const std::vector<int>& except = {}) {
  for (int c = 0; c < free.size(); ++c) {
    if (std::find(except.begin(), except.end(), c) != except.end()) continue;
    const int p = free.parameters()[static_cast<std::size_t>(c)];
    if (plausible_change(problem, p).exceeded(std::abs(moves(c)))) return true;
  }
  return false;
}

/// Probability that q columns explain a share above x of the sum of squares by chance; rounds q up to an even
/// number.
[[nodiscard]] inline double chance_of_share(double x, int q, double freedom) {
  const double b = 0.5 * (freedom - q);
  double term = 1.0, sum = 0.0;
  for (int j = 0; j < (q + 1) / 2; ++j) {
    sum += term;
    term *= x * (b + j) / (j + 1);
  }
  return std::pow(1.0 - x, b) * sum;
}

/// Residuals minus parameters; a pose has no more than six that are independent, as all features of it share what the
/// robot did there.
[[nodiscard]] inline double freedom_of(const LinearFit& fit, const PoseGroups& poses) {
  constexpr double kMost = 6.0;
  std::vector<double> rows(static_cast<std::size_t>(poses.count), 0.0);
  for (const RowBlock& block : fit.blocks) {
    const int pose = poses.of_sample[static_cast<std::size_t>(block.sample)];
    rows[static_cast<std::size_t>(pose)] += static_cast<double>(block.size);
  }
  double sum = 0.0;
  for (const double of : rows) sum += std::min(kMost, of);
  return sum - static_cast<double>(fit.size());
}

/// True if residuals are only rounding, in their own units: simulated samples without noise.
[[nodiscard]] inline bool is_exact(const AnyProblem& problem, const LinearFit& fit) {
  constexpr double kRounding = 1e-7;
  double squares = 0.0;
  for (const RowBlock& block : fit.blocks) {
    const double weight = problem.term(block.term).weight;
    squares += fit.residual.segment(block.first, block.size).squaredNorm() / (weight * weight);
  }
  return !(squares > kRounding * kRounding * static_cast<double>(fit.residual.size()));
}

/// Sums over the rows of some residuals r.
struct ResidualSums {
  double squares = 0.0;                     ///< r^T W r
  Eigen::MatrixXd of_slopes;                ///< (samples x slopes) d^T W r
  std::vector<Eigen::VectorXd> of_courses;  ///< (coordinates) sum of u J^T W r, of each course
};

/// An error that is tried.
struct Trial {
  SystematicError error;  ///< owner and course
  AddedColumns columns;
  std::function<Eigen::VectorXd(const ResidualSums&)> gradient;  ///< X^T W r
  /// Sets size and text, without the noise that is left; false if it is beyond what the linearization can say, or one bad
  /// capture.
  std::function<bool(const Fall&, SystematicError&)> say;
};

/// "0.57 deg" or "1.2 mm"
[[nodiscard]] inline std::string amount(double size, bool turns) {
  return turns ? reading(size * 180.0 / std::numbers::pi, "1") + " deg"
               : reading(1e3 * size, "1") + " mm";
}

/// "12 %"
[[nodiscard]] inline std::string percent(double part) {
  return reading(1e2 * part, "1") + " %";
}

}  // namespace kinecal::detail
