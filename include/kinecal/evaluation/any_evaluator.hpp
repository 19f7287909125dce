// Evaluates a problem, independent of the scalar: residuals and Jacobian, or the normal equations.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <functional>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "kinecal/linkage.hpp"
#include "kinecal/problem/any_problem.hpp"

namespace kinecal {

/// The normal equations, summed over the features of all error blocks with weight w and loss rho:
///
///   cost = 1/2 sum rho(|w r|^2)    gradient = sum rho' w^2 J^T r    hessian = sum rho' w^2 J^T J
struct NormalEquations {
  double cost = 0.0;         ///< not finite if a residual or its derivative is undefined
  Eigen::VectorXd gradient;  ///< (parameters); empty if only the cost was requested
  Eigen::MatrixXd hessian;   ///< (parameters x parameters), symmetric

  /// All zero.
  explicit NormalEquations(int parameters)
      : gradient(Eigen::VectorXd::Zero(parameters)),
        hessian(Eigen::MatrixXd::Zero(parameters, parameters)) {}

  /// Adds the sums of other samples.
  NormalEquations& operator+=(const NormalEquations& other);
  /// Adds the residuals of a prior, which count once for each sample.
  void add_prior(const PriorTerm& prior, const TermResiduals& residuals, int samples,
                 Losses losses);
};

/// A residual that is undefined, such as that of a point behind a camera; or that has no derivative there, such
/// as a distance at zero.
struct UndefinedResidual {
  std::string term,        ///< name of the error block
      source;              ///< source location of the sample
  bool has_value = false;  ///< only its derivative is undefined
};

/// Receives the residuals of one term in one sample.
using RowVisitor = std::function<void(int term, int sample, const TermResiduals& rows)>;

/// Evaluates a problem repeatedly.  Keeps its memory and everything that does not depend on the
/// values.
class AnyEvaluator {
 public:
  virtual ~AnyEvaluator() = default;

  /// The problem that it evaluates.
  [[nodiscard]] virtual const AnyProblem& problem() const = 0;
  /// The Jacobian's columns.
  [[nodiscard]] virtual const FreeSet& free() const = 0;

  /// Evaluates all residuals of error blocks, sample by sample; samples of one layout are consecutive.  Priors are not
  /// visited: see PriorTerm::evaluate().
  /// @param values       of all parameters of the table
  /// @param derivatives  compute the Jacobian, too
  /// @param at           where derivatives are taken
  /// @returns  the first undefined residual, if any; undefined residuals are not visited, nor are those
  ///           with an undefined derivative if derivatives are computed
  /// @throws std::invalid_argument  if the number of values is not that of the table's parameters
  virtual std::optional<UndefinedResidual> evaluate(ParameterValues values, bool derivatives,
                                                    const RowVisitor& visit,
                                                    Linearization at = Linearization::measured) = 0;

  /// The cost and, with derivatives, gradient and Gauss-Newton Hessian.
  /// @param values  of all parameters of the table
  /// @returns  sums; their cost is not finite if a residual is undefined, or one of the derivatives
  /// @throws std::invalid_argument  if the number of values is not that of the table's parameters
  [[nodiscard]] virtual NormalEquations normal_equations(ParameterValues values,
                                                         bool derivatives = true,
                                                         Losses losses = Losses::as_given) = 0;

  /// The best poses that samples have of their own, by sample and joint: see AnyProblem::give_sample_poses().
  /// @param values  of all parameters of the table
  [[nodiscard]] virtual std::vector<std::vector<Pose<double>>> sample_poses(ParameterValues values);
};

/// Evaluates all residuals once: see AnyEvaluator::evaluate().
/// @param free  the columns of the Jacobian; nullptr: residuals only
[[nodiscard]] std::optional<UndefinedResidual> evaluate(const AnyProblem& problem,
                                                        ParameterValues values, const FreeSet* free,
                                                        const RowVisitor& visit,
                                                        Linearization at = Linearization::measured);

/// The first residual that is undefined at these values, if any; else the first whose derivative by
/// some parameter is.
[[nodiscard]] std::optional<UndefinedResidual> undefined_residual(const AnyProblem& problem,
                                                                  ParameterValues values);

/// The normal equations once: see AnyEvaluator::normal_equations().
/// @param free     the parameters to differentiate by; nullptr: the cost only
/// @param threads  number of threads that share the work; zero: one per core
[[nodiscard]] NormalEquations normal_equations(const AnyProblem& problem, ParameterValues values,
                                               const FreeSet* free,
                                               Losses losses = Losses::as_given, int threads = 0);

/// A problem that the library evaluates in packets, as wide as its instruction set allows.
/// Takes the same arguments as the constructor of AnyProblem.
[[nodiscard]] std::unique_ptr<AnyProblem> make_problem(Robot robot, std::string base,
                                                       ParameterTable table,
                                                       std::set<std::string> frames);

/// How the library evaluates problems.
struct Evaluation {
  std::string_view instruction_set;  ///< of its packets: "x86-64-v3"
  int lanes = 1;                     ///< samples evaluated at once
};
/// How the library linked to this program evaluates problems.
[[nodiscard]] Evaluation evaluation_of_library();

}  // namespace kinecal

#ifdef KINECAL_HEADER_ONLY
#include "kinecal/evaluation/problem.hpp"  // includes any_evaluator.ipp
#endif
