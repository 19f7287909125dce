// Propagates covariances to poses.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/trust/uncertainty/pose_uncertainty.hpp"

#include "kinecal/trust/uncertainty/pose_variance.ipp"

namespace kinecal {

PoseUncertainty pose_uncertainty(const AnyProblem& problem, const FreeSet& free,
                                 ParameterValues values, const LinearFit& fit,
                                 const Uncertainty& known, std::span<const Sample> samples,
                                 const FrameOnRobot& frame, const FrameOnRobot& in) {
  detail::PoseDerivative derivative(problem, free, values, frame, in);
  detail::PoseVariance variance(detail::kNearFeatures * detail::mean_distance(problem, fit));
  const Eigen::MatrixXd covariance = known.covariance.matrix();
  for (const Sample& sample : samples) {
    if (const auto jacobian = derivative.at(sample)) {
      variance.add(*jacobian, covariance, fit.coordinates.null);
    }
  }
  return variance.result(frame, in);
}

PlainMatrix position_goal(const AnyProblem& problem, const FreeSet& free, ParameterValues values,
                          std::span<const Sample> samples, const FrameOnRobot& frame,
                          const FrameOnRobot& in) {
  detail::PoseDerivative derivative(problem, free, values, frame, in);
  Eigen::MatrixXd goal = Eigen::MatrixXd::Zero(free.size(), free.size());
  double poses = 0.0;
  for (const Sample& sample : samples) {
    const auto jacobian = derivative.at(sample);
    if (!jacobian) continue;
    goal.noalias() += jacobian->topRows<3>().transpose() * jacobian->topRows<3>();
    poses += 1.0;
  }
  if (poses > 0.0) goal /= poses;
  return goal;
}

}  // namespace kinecal
