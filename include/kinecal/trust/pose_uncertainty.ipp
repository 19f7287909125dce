// Propagating covariances to poses.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>

#include "kinecal/trust/pose_uncertainty.hpp"

namespace kinecal {

namespace detail {

/// The derivative of a chain's tip by the free parameters, at any pose.
class TipDerivative {
 public:
  TipDerivative(const AnyProblem& problem, const FreeSet& free, std::span<const double> values,
                RuntimeChain chain)
      : chain_(std::move(chain)),
        parameters_(chain_parameters(chain_, problem.table())),
        columns_(columns_of(parameters_, free)),
        twist_columns_(twist_columns(chain_, columns_)),
        corrections_(corrections_for(parameters_, values)),
        free_(free.size()) {
    twist_columns_.resize(twists_);
  }

  /// True if a sample has all joints of the chain.
  [[nodiscard]] bool has_joints(const Sample& sample) const {
    return std::all_of(chain_.joints.begin(), chain_.joints.end(), [&](const ChainJoint& joint) {
      return !moves(joint.type) || sample.position(joint.drive.joint);
    });
  }
  /// The tip's origin at the pose of a sample, in the chain's base.
  [[nodiscard]] Vector3<double> tip(const Sample& sample) const {
    PoseWalker<double> walker;
    walk(chain_, states(sample), corrections_, walker);
    return walker.pose.translation;
  }
  /// (6 x free) velocity of a point that moves with the tip, then rotation, in the chain's base.
  [[nodiscard]] Eigen::MatrixXd at(const Sample& sample, const Vector3<double>& p_base) {
    TwistWalker<double> walker(std::span<const JointIndices>(columns_), twists_);
    walk(chain_, states(sample), corrections_, walker);
    Eigen::MatrixXd jacobian = Eigen::MatrixXd::Zero(6, free_);
    for (std::size_t i = 0; i < twist_columns_.rotational.size(); ++i) {
      const Twist<double>& twist = twists_.rotational[i];
      auto column = jacobian.col(twist_columns_.rotational[i]);
      column.head<3>() += twist.velocity(p_base);
      column.tail<3>() += twist.angular;
    }
    for (std::size_t i = 0; i < twist_columns_.translational.size(); ++i) {
      jacobian.col(twist_columns_.translational[i]).head<3>() += twists_.translational[i];
    }
    return jacobian;
  }

 private:
  [[nodiscard]] std::vector<JointState<double>> states(const Sample& sample) const {
    return measured_joint_states(chain_,
                                 [&](const std::string& joint) { return *sample.position(joint); });
  }

  RuntimeChain chain_;
  std::vector<JointIndices> parameters_, columns_;
  TwistColumns twist_columns_;
  Corrections<double> corrections_;
  ChainTwists<double> twists_;
  Eigen::Index free_;
};

}  // namespace detail

KINECAL_INLINE PoseUncertainty pose_uncertainty(const AnyProblem& problem, const FreeSet& free,
                                                std::span<const double> values,
                                                const LinearFit& fit, const Uncertainty& known,
                                                std::span<const Sample> samples,
                                                const FrameOnRobot& frame, const FrameOnRobot& in) {
  PoseUncertainty result{
      .frame = frame.name(), .in = in.name(), .link = frame.link, .in_link = in.link};
  const auto chain_to = [&](const FrameOnRobot& to) {
    RuntimeChain chain = make_chain(problem.robot(), problem.base(), to.link, problem.frames());
    if (!to.frame.empty()) chain = with_virtual_frame(std::move(chain), to.frame);
    return detail::TipDerivative(problem, free, values, std::move(chain));
  };
  detail::TipDerivative of_frame = chain_to(frame), of_in = chain_to(in);
  const Eigen::MatrixXd covariance = known.covariance.matrix();
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
    // Along what nothing determines, effects of parameters must cancel.
    const Eigen::MatrixXd& null = fit.coordinates.null;
    const auto of_origin = jacobian.topRows<3>();
    constexpr double kCancels = 1e-3;
    if ((of_origin * null).cwiseAbs().sum() >
        kCancels * (of_origin.cwiseAbs() * null.cwiseAbs()).sum() + 1e-12) {
      result.determined = false;
    }
  }
  if (poses == 0) return result;
  result.position = std::sqrt(std::max(0.0, positions / poses));
  result.rotation = std::sqrt(std::max(0.0, rotations / poses));
  return result;
}

}  // namespace kinecal
