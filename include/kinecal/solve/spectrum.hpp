// Singular values of a Jacobian with columns scaled to length one, computed from J^T J: which
// parameter combinations are observable.
//
// Observability is judged on the error-free problem: see ARCHITECTURE.md.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "kinecal/evaluation/any_evaluator.hpp"
#include "kinecal/linkage.hpp"
#include "kinecal/problem/any_problem.hpp"

namespace kinecal::detail {

/// Singular values below this fraction of the largest one count as zero; those of 1e-8 and below
/// are rounding, because they are roots of eigenvalues of J^T J.
inline constexpr double kUnobservable = 1e-6;

/// The columns of some rows that are not zero: an error block knows the parameters of its own sensors only.
[[nodiscard]] std::vector<int> nonzero_columns(const Eigen::MatrixXd& rows);

/// J^T J of the error-free problem, weighted, without priors.
[[nodiscard]] Eigen::MatrixXd error_free_information(const AnyProblem& problem, const FreeSet& free,
                                                     ParameterValues values);

/// The information of samples on the free parameters, as sums.
struct SampleInformation {
  NormalEquations measured;    ///< at the measured points, priors included
  Eigen::MatrixXd error_free;  ///< J^T J of the error-free problem, weighted, without priors
  Eigen::MatrixXd priors;      ///< Hessian of the priors
};

/// Whether priors also determine parameters.
enum class Priors { count, ignored };

/// Eigenvalues of an information matrix whose columns have been scaled to length one.
struct Spectrum {
  Eigen::VectorXd scale;     ///< lengths of the columns of J; one for zero columns
  Eigen::VectorXd singular;  ///< singular values of the scaled J, ascending
  Eigen::MatrixXd vectors;   ///< in the same order
  Eigen::Index null = 0;     ///< how many of the first ones are zero

  /// Of a symmetric, positive semidefinite matrix.
  explicit Spectrum(const Eigen::MatrixXd& information);
  /// The pseudo-inverse of the matrix, in its original units.
  [[nodiscard]] Eigen::MatrixXd pseudo_inverse() const;
};

}  // namespace kinecal::detail

#ifdef KINECAL_HEADER_ONLY
#include "kinecal/solve/spectrum.ipp"
#endif
