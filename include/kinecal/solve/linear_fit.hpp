// A problem linearized at its solution, in coordinates that samples and priors determine.
//
// The quality of a result follows from linear algebra on the rows near its minimum: the covariance,
// cross-validation, the effect of one sample.  Coordinates z leave out undetermined directions:
//
//   free parameters = those of the solution + basis z        (basis: free x coordinates)
//
// Coordinates have no unit: the basis carries the units of the parameters.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "kinecal/evaluation/any_evaluator.hpp"
#include "kinecal/linkage.hpp"
#include "kinecal/problem/any_problem.hpp"
#include "kinecal/solve/spectrum.hpp"

namespace kinecal {

/// The rows of all features of an error block in one sample.
struct RowBlock {
  int term = 0;            ///< error block, by number in the problem
  int sample = 0;          ///< sample, by number in the problem
  Eigen::Index first = 0;  ///< its first row
  Eigen::Index size = 0;   ///< number of rows: feature after feature
};

/// The directions of the free parameters that samples or priors determine.
struct Coordinates {
  Eigen::MatrixXd basis;  ///< (free x coordinates) change of the free parameters
  Eigen::MatrixXd null;   ///< (free x others) undetermined changes
  /// (free) undetermined share of each parameter: 0 fully determined, 1 fully undetermined.
  Eigen::VectorXd lost;
  Eigen::VectorXd
      scale;  ///< (free) effect of each parameter on all weighted residuals, per its unit
};

/// Weighted residuals of a problem and their derivatives by coordinates.
struct LinearFit {
  /// Rows as the evaluation writes them.
  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

  std::vector<RowBlock> blocks;    ///< in the order of samples, then of error blocks
  Eigen::VectorXd residual;        ///< (rows) without losses
  RowMajor jacobian;               ///< (rows x coordinates) derivatives; empty if not requested
  Eigen::VectorXd loss;            ///< (rows) rho' of the feature: 1 without a loss
  Eigen::VectorXd used;            ///< (rows) TermResiduals::used: 0 without poses of samples
  Coordinates coordinates;         ///< the variables of the derivatives
  Eigen::VectorXd prior_gradient;  ///< (coordinates) of all priors
  Eigen::MatrixXd prior_hessian;   ///< (coordinates x coordinates) of all priors
  Eigen::MatrixXd hessian;         ///< information() with the losses; empty without derivatives

  /// Number of coordinates.
  [[nodiscard]] Eigen::Index size() const { return coordinates.basis.cols(); }
};

/// The coordinates of a problem near some values.
/// @param values  of all parameters of the table
[[nodiscard]] Coordinates determined_coordinates(const AnyProblem& problem, const FreeSet& free,
                                                 ParameterValues values);

namespace detail {
/// The coordinates that samples with this information determine.
[[nodiscard]] Coordinates coordinates_of(const SampleInformation& samples);
}  // namespace detail

/// Linearizes a problem.
/// @param evaluator    of the problem and its free parameters
/// @param values       of all parameters of the table
/// @param coordinates  see determined_coordinates()
/// @param derivatives  false: residuals only
/// @throws std::domain_error  if a residual is undefined
[[nodiscard]] LinearFit linear_fit(AnyEvaluator& evaluator, ParameterValues values,
                                   const Coordinates& coordinates, bool derivatives = true);

/// linear_fit() without its Hessian.
[[nodiscard]] LinearFit linear_rows(AnyEvaluator& evaluator, ParameterValues values,
                                    const Coordinates& coordinates, bool derivatives = true);

/// J^T J of rows with weights, priors included.
/// @param weights  (rows) of squared residuals
/// @param priors   factor of the priors
[[nodiscard]] Eigen::MatrixXd information(const LinearFit& fit, const Eigen::VectorXd& weights,
                                          double priors = 1.0);

/// Sums of weighted rows, without priors.
struct RowSums {
  Eigen::MatrixXd information;  ///< (coordinates x coordinates) J^T W J
  Eigen::VectorXd gradient;     ///< (coordinates) J^T W r

  explicit RowSums(Eigen::Index coordinates);  ///< all zero
  RowSums& operator+=(const RowSums& other);   ///< adds those of other rows
};

/// The sums of the rows of a block.
/// @param weights   (rows of the fit) of squared residuals
/// @param residual  (rows of the fit)
[[nodiscard]] RowSums row_sums(const LinearFit& fit, const RowBlock& block,
                               const Eigen::VectorXd& weights, const Eigen::VectorXd& residual);

/// The sums of all rows but those of a part of the samples, for each part.  Nothing is subtracted, so that what only a
/// part determines is zero without it.
/// @param weights  (rows) of squared residuals
/// @param part     of each sample, from 0; negative: in none
[[nodiscard]] std::vector<RowSums> sums_without_parts(const LinearFit& fit,
                                                      const Eigen::VectorXd& weights,
                                                      const std::vector<int>& part);

/// The step from the linearization to the minimum of weighted squared rows: one Gauss-Newton step.
/// @param sums    of the weighted rows
/// @param priors  factor of the priors
/// @returns  (coordinates)
[[nodiscard]] Eigen::VectorXd step_to_minimum(const LinearFit& fit, const RowSums& sums,
                                              double priors = 1.0);

/// The same of all rows.
/// @param weights  (rows) of squared residuals
/// @param priors   factor of the priors
/// @returns  (coordinates)
[[nodiscard]] Eigen::VectorXd step_to_minimum(const LinearFit& fit, const Eigen::VectorXd& weights,
                                              double priors = 1.0);

/// Values of all parameters after a step.
/// @param step  (coordinates)
[[nodiscard]] Eigen::VectorXd stepped(const LinearFit& fit, const FreeSet& free,
                                      ParameterValues values, const Eigen::VectorXd& step);

/// A fit with other weights.
struct Refit {
  Eigen::VectorXd values;    ///< of all parameters of the table
  Eigen::VectorXd residual;  ///< (rows) weighted, of all rows, in the order of LinearFit
};

/// Minimizes weighted squared rows, starting from the solution: Gauss-Newton steps, halved until
/// the cost falls.  One step is enough unless some directions are poorly determined.
/// @param values   where `fit` was linearized
/// @param weights  (rows) of squared residuals
/// @param first    step_to_minimum() of these weights and priors
/// @param priors   factor of the priors
/// @param settled  stops after a step that lowers the cost by less than this fraction
[[nodiscard]] Refit refit(AnyEvaluator& evaluator, ParameterValues values, const LinearFit& fit,
                          const Eigen::VectorXd& weights, const Eigen::VectorXd& first,
                          double priors = 1.0, double settled = 1e-4);

}  // namespace kinecal

#ifdef KINECAL_HEADER_ONLY
#include "kinecal/solve/linear_fit.ipp"
#endif
