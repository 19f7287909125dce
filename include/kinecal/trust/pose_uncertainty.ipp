// Propagating covariances to poses.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>

#include "kinecal/trust/pose_uncertainty.hpp"
#include "kinecal/trust/tip_derivative.ipp"

namespace kinecal {

namespace detail {

/// Root of the mean squared distance of features, metres; zero if none is in metres.
[[nodiscard]] inline double mean_distance(const AnyProblem& problem, const LinearFit& fit) {
  double squares = 0.0;
  Eigen::Index features = 0;
  for (const RowBlock& block : fit.blocks) {
    const Term& term = problem.term(block.term);
    if (term.options.unit != "m") continue;
    const double weight = term.options.weight;
    squares += fit.residual.segment(block.first, block.size).squaredNorm() / (weight * weight);
    features += block.size / term.feature_size;
  }
  return features > 0 ? std::sqrt(squares / static_cast<double>(features)) : 0.0;
}

/// The derivative of the tip of a chain to a frame.
[[nodiscard]] inline TipDerivative derivative_of(const AnyProblem& problem, const FreeSet& free,
                                                 std::span<const double> values,
                                                 const FrameOnRobot& to) {
  RuntimeChain chain = make_chain(problem.robot(), problem.base(), to.link, problem.frames());
  if (!to.frame.empty()) chain = with_virtual_frame(std::move(chain), to.frame);
  return {problem, free, values, std::move(chain)};
}

}  // namespace detail

KINECAL_INLINE PoseUncertainty pose_uncertainty(const AnyProblem& problem, const FreeSet& free,
                                                std::span<const double> values,
                                                const LinearFit& fit, const Uncertainty& known,
                                                std::span<const Sample> samples,
                                                const FrameOnRobot& frame, const FrameOnRobot& in) {
  PoseUncertainty result{
      .frame = frame.name(), .in = in.name(), .link = frame.link, .in_link = in.link};
  detail::TipDerivative of_frame = detail::derivative_of(problem, free, values, frame),
                        of_in = detail::derivative_of(problem, free, values, in);
  const Eigen::MatrixXd covariance = known.covariance.matrix();
  const double off = detail::mean_distance(problem, fit);
  constexpr double kNear = 3.0;  // times it: where features are
  double positions = 0.0, rotations = 0.0;
  int poses = 0;
  for (const Sample& sample : samples) {
    if (!of_frame.has_joints(sample) || !of_in.has_joints(sample)) continue;
    const Vector3<double> p_base = of_frame.tip(sample);
    const Eigen::MatrixXd jacobian = of_frame.at(sample, p_base) - of_in.at(sample, p_base);
    const Eigen::MatrixXd variance = jacobian * covariance * jacobian.transpose();
    const double position = variance.topLeftCorner<3, 3>().trace(),
                 rotation = variance.bottomRightCorner<3, 3>().trace();
    positions += position;
    rotations += rotation;
    ++poses;
    result.worst_position = std::max(result.worst_position, std::sqrt(std::max(0.0, position)));
    result.worst_rotation = std::max(result.worst_rotation, std::sqrt(std::max(0.0, rotation)));
    if (detail::moves_origin(jacobian, fit.coordinates.null, kNear * off))
      result.determined = false;
  }
  if (poses == 0) return result;
  result.position = std::sqrt(std::max(0.0, positions / poses));
  result.rotation = std::sqrt(std::max(0.0, rotations / poses));
  return result;
}

KINECAL_INLINE PlainMatrix position_goal(const AnyProblem& problem, const FreeSet& free,
                                         std::span<const double> values,
                                         std::span<const Sample> samples, const FrameOnRobot& frame,
                                         const FrameOnRobot& in) {
  detail::TipDerivative of_frame = detail::derivative_of(problem, free, values, frame),
                        of_in = detail::derivative_of(problem, free, values, in);
  Eigen::MatrixXd goal = Eigen::MatrixXd::Zero(free.size(), free.size());
  double poses = 0.0;
  for (const Sample& sample : samples) {
    if (!of_frame.has_joints(sample) || !of_in.has_joints(sample)) continue;
    const Vector3<double> p_base = of_frame.tip(sample);
    const Eigen::MatrixXd jacobian =
        (of_frame.at(sample, p_base) - of_in.at(sample, p_base)).topRows<3>();
    goal.noalias() += jacobian.transpose() * jacobian;
    poses += 1.0;
  }
  if (poses > 0.0) goal /= poses;
  return goal;
}

}  // namespace kinecal
