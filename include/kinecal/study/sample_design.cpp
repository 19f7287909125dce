// Definitions of sample_design.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/study/sample_design.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "kinecal/study/design_rows.ipp"
#include "kinecal/trust/plain_equations.hpp"
#include "kinecal/trust/uncertainty.hpp"

namespace kinecal {

namespace detail {
namespace {

/// The contribution of a problem's priors for one sample.
[[nodiscard]] PlainMatrix prior_of_one(const MakeProblem& make, const FreeSet& free,
                                       ParameterValues values, const Sample& sample,
                                       const SampleDesign& design) {
  const std::unique_ptr<AnyProblem> problem = make();
  problem->add_sample(sample);
  const Eigen::MatrixXd all = plain_equations(*problem, free, values).hessian.matrix();
  if (problem->priors().empty()) return Eigen::MatrixXd::Zero(free.size(), free.size());
  return all - design.information.matrix();
}

}  // namespace
}  // namespace detail

StudyDesign study_design(const MakeProblem& make, const FreeSet& free, ParameterValues values,
                         std::span<const Sample> samples, const MeasurementNoise& noise,
                         Targets targets) {
  StudyDesign design{detail::DesignRows(make, free, values, samples, noise, targets).designs(),
                     Eigen::MatrixXd::Zero(free.size(), free.size())};
  if (!samples.empty()) {
    const SampleDesign held =
        targets == Targets::held
            ? design.samples[0]
            : detail::DesignRows(make, free, values, samples.first(1), noise, Targets::held)
                  .designs()[0];
    design.prior = detail::prior_of_one(make, free, values, samples[0], held);
  }
  return design;
}

ExpectedUncertainty expected_uncertainty(const StudyDesign& design, std::span<const int> chosen) {
  const Eigen::Index n = design.prior.rows();
  const Eigen::MatrixXd prior = static_cast<double>(chosen.size()) * design.prior.matrix();
  Eigen::MatrixXd information = prior, scores = Eigen::MatrixXd::Zero(n, n);
  for (const int i : chosen) {
    information += design.samples[static_cast<std::size_t>(i)].information.matrix();
    scores += design.samples[static_cast<std::size_t>(i)].scores.matrix();
  }
  const Eigen::VectorXd length = information.diagonal().cwiseMax(0.0).cwiseSqrt();
  const Eigen::VectorXd units = length.unaryExpr([](double l) { return l > 0.0 ? 1.0 / l : 1.0; });
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(units.asDiagonal() * information *
                                                              units.asDiagonal());
  constexpr double kNothing = 1e-11;  // of the largest eigenvalue: below it is rounding
  const auto& eigen = solver.eigenvalues();
  Eigen::VectorXd inverse = Eigen::VectorXd::Zero(n), lost = Eigen::VectorXd::Zero(n);
  ExpectedUncertainty expected;
  for (Eigen::Index i = 0; i < n; ++i) {
    if (eigen(i) > kNothing * eigen(n - 1)) {
      inverse(i) = 1.0 / eigen(i);
      ++expected.determined;
    } else {
      lost += solver.eigenvectors().col(i).cwiseAbs2();
    }
  }
  const Eigen::MatrixXd by = units.asDiagonal() * solver.eigenvectors() * inverse.asDiagonal() *
                             solver.eigenvectors().transpose() * units.asDiagonal();
  const Eigen::MatrixXd covariance = by * scores * by;
  expected.covariance = covariance;
  expected.deviation = detail::deviations(covariance, lost.cwiseSqrt());
  return expected;
}

double expected_variance(const ExpectedUncertainty& expected, const PlainMatrix& goal) {
  return goal.matrix().cwiseProduct(expected.covariance.matrix()).sum();
}

}  // namespace kinecal
