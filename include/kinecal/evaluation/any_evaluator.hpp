// Evaluating a problem, independent of the scalar: residuals with their Jacobian, or the normal
// equations.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>

#include "kinecal/evaluation/normal_equations.hpp"
#include "kinecal/parameters/parameter_table.hpp"

namespace kinecal {

class AnyProblem;

/// A residual that is undefined, such as that of a point behind a camera.
struct UndefinedResidual {
  std::string term,  ///< name of the error block
      source;        ///< source location of the sample
};

/// Takes the residuals of one term in one sample.
using RowVisitor = std::function<void(int term, int sample, const TermResiduals& rows)>;

/// Evaluates a problem repeatedly.  It keeps its memory and what does not depend on the values.
class AnyEvaluator {
 public:
  virtual ~AnyEvaluator() = default;

  /// The problem that it evaluates.
  [[nodiscard]] virtual const AnyProblem& problem() const = 0;
  /// The Jacobian's columns.
  [[nodiscard]] virtual const FreeSet& free() const = 0;

  /// Evaluates all residuals, sample by sample.  Samples of one shape follow each other.
  /// @param values       of all parameters of the table
  /// @param derivatives  compute the Jacobian, too
  /// @param at           where derivatives are taken
  /// @returns  the first undefined residual, if any; undefined residuals are not visited
  /// @throws std::invalid_argument  if values are not as many as the table has parameters
  virtual std::optional<UndefinedResidual> evaluate(std::span<const double> values,
                                                    bool derivatives, const RowVisitor& visit,
                                                    Linearization at = Linearization::measured) = 0;

  /// The cost and, with derivatives, gradient and Gauss-Newton Hessian.
  /// @param values  of all parameters of the table
  /// @returns  sums; their cost is not finite if a residual is undefined
  /// @throws std::invalid_argument  if values are not as many as the table has parameters
  [[nodiscard]] virtual NormalEquations normal_equations(std::span<const double> values,
                                                         bool derivatives = true,
                                                         Losses losses = Losses::as_given) = 0;
};

}  // namespace kinecal
