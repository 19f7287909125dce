// Compares two matrices that a law says are equal; central differences; lanes of packets as
// matrices.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstdio>
#include <string>

#include "kinecal/geometry/jet.hpp"
#include "kinecal/geometry/pose.hpp"
#include "kinecal/testing/verdict.hpp"

namespace kinecal::detail {

/// Step of central differences; their error is 1e-10 for a function with derivatives of size one.
inline constexpr double kStep = 1e-5;
/// Tolerance between jets and central differences, relative to the largest derivative or value.
inline constexpr double kOfDifferences = 1e-6;
/// Tolerance between two orders of the same arithmetic, such as fused multiply-adds; relative.
inline constexpr double kOfRounding = 1e-10;

/// A matrix with its name, for messages.
struct Named {
  std::string name;
  const Eigen::MatrixXd& matrix;

  [[nodiscard]] std::string text() const {
    std::string all = "\n" + name + ":";
    for (Eigen::Index row = 0; row < matrix.rows(); ++row) {
      all += "\n ";
      for (Eigen::Index column = 0; column < matrix.cols(); ++column) {
        char number[32];
        (void)std::snprintf(number, sizeof number, " %13.6g", matrix(row, column));
        all += number;
      }
    }
    return all;
  }
};

/// The largest absolute value in a matrix; NaN does not count.
[[nodiscard]] inline double largest(const Eigen::MatrixXd& m) {
  double most = 0.0;
  for (Eigen::Index i = 0; i < m.size(); ++i) most = std::max(most, std::abs(m.data()[i]));
  return most;
}

/// kLawsHold if two matrices are equal, else a verdict with `law` and both matrices.
/// @param tolerance  of an entry; NaN equals NaN
[[nodiscard]] inline Verdict compare(const std::string& law, const Named& a, const Named& b,
                                     double tolerance) {
  for (Eigen::Index i = 0; i < a.matrix.size(); ++i) {
    const double x = a.matrix.data()[i], y = b.matrix.data()[i];
    if (std::abs(x - y) <= tolerance || (std::isnan(x) && std::isnan(y)) || x == y) continue;
    return {law + a.text() + b.text()};
  }
  return kLawsHold;
}

/// A value and its derivatives.
/// @tparam M, N  number of values and of variables
template <class S, int M, int N>
struct Differentiated {
  static constexpr int kM = M, kN = N;
  Eigen::Matrix<S, M, 1> value;
  Eigen::Matrix<S, M, N> derivatives;

  Differentiated() = default;
  /// From jets.
  explicit Differentiated(const Eigen::Matrix<Jet<S, N>, M, 1>& jets)
      : value(values_of(jets)), derivatives(derivatives_by<N>(jets, 0)) {}

  /// From another scalar: one lane of packets, without derivatives.
  template <class Q>
  [[nodiscard]] Verdict is_lane_of(int i, const std::string& whose,
                                   const Differentiated<Q, M, N>& packets,
                                   const Eigen::Matrix<Q, M, 1>& plain) const {
    const Eigen::MatrixXd numbers = lane_of(value, 0), by = lane_of(derivatives, 0);
    const double tolerance = kOfRounding * (1.0 + largest(numbers) + largest(by));
    const auto check = [&](const std::string& what, const Eigen::MatrixXd& found,
                           const Eigen::MatrixXd& expected) {
      return compare(whose + what + " in packets differ from those in double; do not branch on " +
                         "values, write select(x < y, a, b)",
                     {"in packets", found}, {"in double", expected}, tolerance);
    };
    if (const Verdict v = check("values", lane_of(plain, i), numbers); !v) return v;
    if (const Verdict v = check("values of jets", lane_of(packets.value, i), numbers); !v) return v;
    return check("derivatives by jets", lane_of(packets.derivatives, i), by);
  }
};

/// Derivatives of a function by central differences.
/// @param at  at(k, step): the value (M) where variable k is moved by a step
template <int M, int N, class At>
[[nodiscard]] Eigen::MatrixXd central_differences(At&& at) {
  Eigen::MatrixXd derivatives(M, N);
  for (int k = 0; k < N; ++k) {
    derivatives.col(k) = (at(k, kStep) - at(k, -kStep)) / (2.0 * kStep);
  }
  return derivatives;
}

/// Compares claimed derivatives of a function with its central differences.
/// @param size  the largest value of the function
[[nodiscard]] inline Verdict compare_derivatives(const std::string& whose, const Named& said,
                                                 const Eigen::MatrixXd& differences, double size) {
  return compare(whose +
                     "derivatives disagree with its values; one row per value, one column per " +
                     "variable",
                 said, {"central differences of the values", differences},
                 kOfDifferences * (1.0 + largest(differences) + size));
}

}  // namespace kinecal::detail
