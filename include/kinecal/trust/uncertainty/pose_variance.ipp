// Sums the variance of the pose of a frame in another over poses of the robot.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>

#include "kinecal/solve/linear_fit.hpp"
#include "kinecal/trust/uncertainty/pose_uncertainty.hpp"
#include "kinecal/trust/uncertainty/tip_derivative.ipp"

namespace kinecal::detail {

/// Root of the mean squared distance of features, metres; zero if none is in metres.
[[nodiscard]] inline double mean_distance(const AnyProblem& problem, const LinearFit& fit) {
  double squares = 0.0;
  Eigen::Index features = 0;
  for (const RowBlock& block : fit.blocks) {
    const Term& term = problem.term(block.term);
    if (term.options.unit != "m") continue;
    const double weight = term.weight;
    squares += fit.residual.segment(block.first, block.size).squaredNorm() / (weight * weight);
    features += block.size / term.feature_size;
  }
  return features > 0 ? std::sqrt(squares / static_cast<double>(features)) : 0.0;
}

/// The derivative of the tip of a chain to a frame.
[[nodiscard]] inline TipDerivative derivative_of(const AnyProblem& problem, const FreeSet& free,
                                                 ParameterValues values, const FrameOnRobot& to) {
  RuntimeChain chain = make_chain(problem.robot(), problem.base(), to.link, problem.frames());
  if (!to.frame.empty()) chain = with_virtual_frame(std::move(chain), to.frame);
  return {problem, free, values, std::move(chain)};
}

/// The derivative of the pose of a frame in another.
struct PoseDerivative {
  TipDerivative of_frame, of_in;

  PoseDerivative(const AnyProblem& problem, const FreeSet& free, ParameterValues values,
                 const FrameOnRobot& frame, const FrameOnRobot& in)
      : of_frame(derivative_of(problem, free, values, frame)),
        of_in(derivative_of(problem, free, values, in)) {}

  /// (6 x free); nullopt if the sample lacks a joint of the chains.
  [[nodiscard]] std::optional<Eigen::MatrixXd> at(const Sample& sample) {
    if (!of_frame.has_joints(sample) || !of_in.has_joints(sample)) return std::nullopt;
    const Vector3<double> p_base = of_frame.tip(sample);
    return of_frame.at(sample, p_base) - of_in.at(sample, p_base);
  }
};

/// Sums of variances over poses.
class PoseVariance {
 public:
  /// @param near  metres: see moves_origin()
  explicit PoseVariance(double near) : near_(near) {}

  /// @param jacobian    (6 x free) of the pose
  /// @param covariance  (free x free)
  /// @param null        (free x changes) undetermined changes
  void add(const Eigen::MatrixXd& jacobian, const Eigen::MatrixXd& covariance,
           const Eigen::MatrixXd& null) {
    const Eigen::MatrixXd variance = jacobian * covariance * jacobian.transpose();
    const double position = std::max(0.0, variance.topLeftCorner<3, 3>().trace()),
                 rotation = std::max(0.0, variance.bottomRightCorner<3, 3>().trace());
    positions_ += position;
    rotations_ += rotation;
    poses_ += 1.0;
    worst_position_ = std::max(worst_position_, std::sqrt(position));
    worst_rotation_ = std::max(worst_rotation_, std::sqrt(rotation));
    if (moves_origin(jacobian, null, near_)) determined_ = false;
  }

  [[nodiscard]] PoseUncertainty result(const FrameOnRobot& frame, const FrameOnRobot& in) const {
    const double poses = std::max(1.0, poses_);
    return {.frame = frame.name(),
            .in = in.name(),
            .link = frame.link,
            .in_link = in.link,
            .position = std::sqrt(positions_ / poses),
            .rotation = std::sqrt(rotations_ / poses),
            .worst_position = worst_position_,
            .worst_rotation = worst_rotation_,
            .determined = determined_};
  }

 private:
  double near_, positions_ = 0.0, rotations_ = 0.0, poses_ = 0.0;
  double worst_position_ = 0.0, worst_rotation_ = 0.0;
  bool determined_ = true;
};

/// Up to this distance from the features, in mean distances, rotations about them do not count.
inline constexpr double kNearFeatures = 3.0;

}  // namespace kinecal::detail
