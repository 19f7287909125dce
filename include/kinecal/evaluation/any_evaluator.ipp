// Definitions of any_evaluator.hpp, for the instruction set that the library is compiled for.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/evaluation/any_evaluator.hpp"
#include "kinecal/evaluation/problem.hpp"

namespace kinecal {

#ifndef KINECAL_HEADER_ONLY
inline namespace KINECAL_INSTRUCTION_SET {
const bool KINECAL_LIBRARY_CHECK = true;
template <>
const bool EigenAligned::KINECAL_LIBRARY_CHECK = true;
}  // namespace KINECAL_INSTRUCTION_SET
#endif

KINECAL_INLINE std::vector<std::vector<Pose<double>>> AnyEvaluator::sample_poses(ParameterValues) {
  return {};
}

KINECAL_INLINE NormalEquations& NormalEquations::operator+=(const NormalEquations& other) {
  cost += other.cost;
  gradient += other.gradient;
  hessian += other.hessian;
  return *this;
}

KINECAL_INLINE void NormalEquations::add_prior(const PriorTerm& prior,
                                               const TermResiduals& residuals, int samples,
                                               Losses losses) {
  const double w2 = std::pow(prior.options.weight(), 2);
  const auto loss = prior.options.loss_for(losses)(w2 * residuals.residual.squaredNorm());
  cost += 0.5 * samples * loss.rho;
  if (residuals.jacobian.cols() == 0) return;
  const double factor = samples * w2 * loss.derivative;
  for (Eigen::Index row = 0; row < residuals.jacobian.rows(); ++row) {
    for (Eigen::Index column = 0; column < residuals.jacobian.cols(); ++column) {
      const double derivative = residuals.jacobian(row, column);
      gradient(column) += factor * derivative * residuals.residual(row);
      hessian(column, column) += factor * derivative * derivative;
    }
  }
}

KINECAL_INLINE std::unique_ptr<AnyProblem> make_problem(Robot robot, std::string base,
                                                        ParameterTable table,
                                                        std::set<std::string> frames) {
  return std::make_unique<Problem>(std::move(robot), std::move(base), std::move(table),
                                   std::move(frames));
}

KINECAL_INLINE Evaluation evaluation_of_library() {
  return {instruction_set(), kLanes<Packet>};
}

KINECAL_INLINE std::optional<UndefinedResidual> evaluate(const AnyProblem& problem,
                                                         ParameterValues values,
                                                         const FreeSet* free,
                                                         const RowVisitor& visit,
                                                         Linearization at) {
  const FreeSet none({}, problem.table().size());
  return problem.evaluator(free != nullptr ? *free : none, 1)
      ->evaluate(values, free != nullptr, visit, at);
}

KINECAL_INLINE std::optional<UndefinedResidual> undefined_residual(const AnyProblem& problem,
                                                                   ParameterValues values) {
  const RowVisitor none = [](int, int, const TermResiduals&) {};
  const FreeSet touched(problem.touched_parameters(), problem.table().size());
  const auto undefined = evaluate(problem, values, nullptr, none);
  return undefined ? undefined : evaluate(problem, values, &touched, none);
}

KINECAL_INLINE NormalEquations normal_equations(const AnyProblem& problem, ParameterValues values,
                                                const FreeSet* free, Losses losses, int threads) {
  const FreeSet none({}, problem.table().size());
  return problem.evaluator(free != nullptr ? *free : none, threads)
      ->normal_equations(values, free != nullptr, losses);
}

}  // namespace kinecal
