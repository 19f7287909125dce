// The derivative of a chain's tip by the free parameters, and its undetermined part.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <span>
#include <utility>
#include <vector>

#include "kinecal/problem/any_problem.hpp"

namespace kinecal::detail {

/// The derivative of a chain's tip by the free parameters, at any pose.
class TipDerivative {
 public:
  TipDerivative(const AnyProblem& problem, const FreeSet& free, ParameterValues values,
                RuntimeChain chain)
      : chain_(problem.robot(), std::move(chain), problem.table()),
        columns_(columns_of(chain_.parameters(), free)),
        twist_columns_(twist_columns(chain_.chain(), columns_)),
        corrections_(corrections_for(chain_.parameters(), values)),
        free_(free.size()) {
    twist_columns_.resize(twists_);
  }

  /// True if a sample has all joints of the chain.
  [[nodiscard]] bool has_joints(const Sample& sample) const { return chain_.has_joints(sample); }
  /// The tip's origin at the pose of a sample, in the chain's base.
  [[nodiscard]] Vector3<double> tip(const Sample& sample) const {
    return chain_.tip(sample, corrections_).translation;
  }
  /// (6 x free) velocity of a point that moves with the tip, then rotation, in the chain's base.
  [[nodiscard]] Eigen::MatrixXd at(const Sample& sample, const Vector3<double>& p_base) {
    TwistWalker<double> walker(std::span<const JointIndices>(columns_), twists_);
    walk(chain_.chain(), chain_.motions(sample), corrections_, walker);
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
  SampledChain chain_;
  std::vector<JointIndices> columns_;
  TwistColumns twist_columns_;
  Corrections<double> corrections_;
  ChainTwists<double> twists_;
  Eigen::Index free_;
};

/// True if undetermined changes move the origin of a frame: the effects of parameters do not
/// cancel.  Ignores a rotation about the features if the origin is as near to them as residuals are
/// large.
/// @param jacobian  (6 x free) of its position and rotation
/// @param null      (free x changes)
/// @param near      metres
[[nodiscard]] inline bool moves_origin(const Eigen::MatrixXd& jacobian, const Eigen::MatrixXd& null,
                                       double near) {
  const auto of_origin = jacobian.topRows<3>();
  constexpr double kCancels = 1e-3;
  const double turned = (jacobian.bottomRows<3>() * null).cwiseAbs().sum();
  return (of_origin * null).cwiseAbs().sum() >
         kCancels * (of_origin.cwiseAbs() * null.cwiseAbs()).sum() + near * turned + 1e-12;
}

}  // namespace kinecal::detail
