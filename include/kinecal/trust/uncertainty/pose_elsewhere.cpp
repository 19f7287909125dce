// Propagates covariances to poses that were not measured.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/trust/uncertainty/pose_elsewhere.hpp"

#include <numeric>
#include <vector>

#include "kinecal/solve/spectrum.hpp"
#include "kinecal/trust/noise/noise.hpp"
#include "kinecal/trust/uncertainty/pose_variance.ipp"

namespace kinecal {

namespace detail {
namespace {

/// A step linearized at its solution.
[[nodiscard]] LinearFit linear_fit_of(const AnyProblem& problem, const FreeSet& free,
                                      ParameterValues values) {
  const auto evaluator = problem.evaluator(free, 1);
  return linear_fit(*evaluator, values, determined_coordinates(problem, free, values));
}

/// Weights that scale the noise of rows to one.
[[nodiscard]] Eigen::VectorXd noise_weights(const LinearFit& fit,
                                            const std::vector<BlockNoise>& noise) {
  constexpr double kLeast = 1e-12;  // of samples without any error
  Eigen::VectorXd weights = fit.loss;
  for (const RowBlock& block : fit.blocks) {
    const double s = std::max(kLeast, noise[static_cast<std::size_t>(block.term)].weighted());
    weights.segment(block.first, block.size) /= s * s;
  }
  return weights;
}

}  // namespace
}  // namespace detail

PoseUncertainty pose_at(const AnyProblem& problem, const Assessment& step, ParameterValues values,
                        std::span<const Sample> poses, const FrameOnRobot& frame,
                        const FrameOnRobot& in) {
  const FreeSet free(step.parameters, problem.table().size());
  return pose_uncertainty(problem, free, values, detail::linear_fit_of(problem, free, values),
                          step.uncertainty, poses, frame, in);
}

PoseUncertainty pose_held_out(const AnyProblem& problem, const Assessment& step,
                              ParameterValues values, std::span<const Sample> samples,
                              const FrameOnRobot& frame, const FrameOnRobot& in) {
  const FreeSet free(step.parameters, problem.table().size());
  const LinearFit fit = detail::linear_fit_of(problem, free, values);
  const Coordinates& by = fit.coordinates;
  const Eigen::VectorXd weights = detail::noise_weights(fit, step.noise);
  const double count = static_cast<double>(samples.size());
  const double priors = (count - 1.0) / count / std::max(1e-24, prior_variance(step.noise));
  detail::PoseDerivative derivative(problem, free, values, frame, in);
  detail::PoseVariance variance(detail::kNearFeatures * detail::mean_distance(problem, fit));
  std::vector<int> each(samples.size());
  std::iota(each.begin(), each.end(), 0);
  const std::vector<RowSums> others = sums_without_parts(fit, weights, each);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const auto jacobian = derivative.at(samples[i]);
    if (!jacobian) continue;
    const detail::Spectrum spectrum(others[i].information + priors * fit.prior_hessian);
    const Eigen::MatrixXd lost =
        spectrum.scale.cwiseInverse().asDiagonal() * spectrum.vectors.leftCols(spectrum.null);
    Eigen::MatrixXd null(free.size(), by.null.cols() + lost.cols());
    null << by.null, by.basis * lost;
    variance.add(*jacobian,
                 step.uncertainty.design_effect * by.basis * spectrum.pseudo_inverse() *
                     by.basis.transpose(),
                 null);
  }
  return variance.result(frame, in);
}

}  // namespace kinecal
