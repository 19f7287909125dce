// Checks before timing: all methods must agree on residuals, derivatives, sums and solutions.
//
// Exact derivatives agree to the rounding of a few hundred operations.  Central differences are
// good to about 1e-8, because Ceres' step is 1.5e-8 for small parameters.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <vector>

#include "method.hpp"

namespace kinecal::bench {

/// A method computes a different result from the others.
struct Disagreement : std::runtime_error {
  using std::runtime_error::runtime_error;
};

inline constexpr double kCostTolerance = 1e-9;         // relative
inline constexpr double kExactTolerance = 1e-12;       // of the largest entry
inline constexpr double kDifferencesTolerance = 1e-7;  // of the largest entry
inline constexpr double kSolutionTolerance = 1e-6;     // of the cost reached, relative

namespace detail {

/// Largest difference between two matrices, of the largest entry of the second.
template <class A, class B>
[[nodiscard]] double difference(const A& a, const B& b) {
  return (a - b).cwiseAbs().maxCoeff() / b.cwiseAbs().maxCoeff();
}

inline void expect(bool agrees, const std::string& method, const std::string& what, double found,
                   double tolerance) {
  if (agrees) return;
  throw Disagreement(fmt::format("{} of method '{}' differ by {:.3g}, tolerance {:.3g}", what,
                                 method, found, tolerance));
}

template <class A, class B>
void expect_near(const A& a, const B& b, double tolerance, const std::string& method,
                 const std::string& what) {
  if (a.rows() != b.rows() || a.cols() != b.cols()) {
    throw Disagreement(fmt::format("{} of method '{}' are {} x {}, not {} x {}", what, method,
                                   a.rows(), a.cols(), b.rows(), b.cols()));
  }
  const double found = difference(a, b);
  expect(found <= tolerance, method, what, found, tolerance);
}

}  // namespace detail

/// Compares the evaluations of every method with those of the reference.
/// @param reference  an exact method
/// @throws Disagreement  with method, quantity and difference
inline void check_evaluations(const Method& reference, const std::vector<Method>& methods,
                              Values x) {
  const Stacked truth = reference.stacked(x, true);
  const Sums sums = sums_of(truth);
  for (const Method& method : methods) {
    const double derivatives = method.exact ? kExactTolerance : kDifferencesTolerance;
    const Eigen::VectorXd residual = method.stacked(x, false).residual;
    detail::expect_near(residual, truth.residual, kExactTolerance, method.name, "residuals");
    const Stacked stacked = method.stacked(x, true);
    detail::expect_near(stacked.residual, truth.residual, kExactTolerance, method.name,
                        "residuals beside the Jacobian");
    detail::expect_near(stacked.jacobian, truth.jacobian, derivatives, method.name, "derivatives");
    const Sums own = method.normal_equations(x);
    const double cost = std::abs(own.cost - sums.cost) / sums.cost;
    detail::expect(cost <= kCostTolerance, method.name, "costs", cost, kCostTolerance);
    detail::expect_near(own.gradient, sums.gradient, derivatives, method.name, "gradients");
    detail::expect_near(own.hessian, sums.hessian, derivatives, method.name, "Hessians");
  }
}

/// @throws Disagreement  if a solution of the same samples has another cost than the reference's
inline void check_solution(const std::string& method, const Solved& solved, double cost) {
  const double found = std::abs(solved.cost - cost) / cost;
  detail::expect(found <= kSolutionTolerance, method, "costs of solutions", found,
                 kSolutionTolerance);
}

}  // namespace kinecal::bench
