// The parts of own_poses.ipp that do not depend on the scalar.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "kinecal/evaluation/own_poses.hpp"
#include "kinecal/kinematics/floating_joint.hpp"

namespace kinecal {

namespace detail {

/// Table indices of the parameters of the poses that samples have of their own: six of each frame.
[[nodiscard]] inline FreeSet own_pose_parameters(const AnyProblem& problem) {
  std::vector<int> all;
  for (const std::string& frame : problem.own_poses()) {
    for (const auto axis : kFrameAxes) {
      all.push_back(problem.table().find(parameter_name(frame, axis)));
    }
  }
  return {std::move(all), problem.table().size()};
}

/// The columns of two sets.
[[nodiscard]] inline FreeSet joined(const FreeSet& first, const FreeSet& second) {
  std::vector<int> all = first.parameters();
  all.insert(all.end(), second.parameters().begin(), second.parameters().end());
  return {std::move(all), first.table_size()};
}

/// Where the numbers of the poses stand in the rows of a layout.
[[nodiscard]] inline std::vector<PosePlace> pose_places(const AnyProblem& problem,
                                                        const SampleLayout& layout) {
  std::vector<PosePlace> places;
  for (std::size_t s = 0; s < layout.sensors.size(); ++s) {
    if (!layout.sensors[s]) continue;
    const std::vector<SampledChain>& chains = problem.sensors()[s].chains();
    for (std::size_t c = 0; c < chains.size(); ++c) {
      const std::size_t first = layout.sensors[s]->joints[c];
      if (first == kAbsent) continue;
      const std::size_t stride = 2 + most_effects(chains[c].parameters());
      const std::vector<ChainJoint>& joints = chains[c].chain().joints;
      for (std::size_t f = 0; f < problem.own_poses().size(); ++f) {
        PosePlace place{f, {}};
        bool found = false;
        for (std::size_t j = 0; j < joints.size(); ++j) {
          if (joints[j].floating != problem.own_poses()[f]) continue;
          place.offsets[floating_coordinate(joints[j].name)->index] = first + stride * j;
          found = true;
        }
        if (found) places.push_back(place);
      }
    }
  }
  return places;
}

/// Moves poses.
/// @param step  (6 of each) translation and rotation vector, in the moved frame
inline void move(std::vector<Pose<double>>& poses, const Eigen::VectorXd& step) {
  for (std::size_t f = 0; f < poses.size(); ++f) {
    const auto by = step.segment<6>(6 * static_cast<Eigen::Index>(f));
    poses[f] = poses[f] * Pose<double>{exp(Vector3<double>(by.tail<3>())), by.head<3>()};
  }
}

/// The square of each row's weight, its loss included.
/// @param cost  adds the cost of the rows
[[nodiscard]] inline Eigen::VectorXd squared_weights(const Term& term, const TermResiduals& rows,
                                                     Losses losses, double& cost) {
  const Loss loss = term.options.loss_for(losses);
  Eigen::VectorXd weights = term.weight * rows.factor;
  const int size = term.feature_size;
  for (Eigen::Index row = 0; row < weights.size(); row += size) {
    auto of_feature = weights.segment(row, size);
    const auto value =
        loss(of_feature.cwiseProduct(rows.residual.segment(row, size)).squaredNorm());
    cost += 0.5 * value.rho;
    of_feature = value.derivative * of_feature.cwiseAbs2().eval();
  }
  return weights;
}

/// Lengths of the columns of a Jacobian by its J^T J; one for a column of zeros.
[[nodiscard]] inline Eigen::VectorXd column_lengths(const Eigen::MatrixXd& hessian) {
  return hessian.diagonal().unaryExpr([](double h) { return h > 0.0 ? std::sqrt(h) : 1.0; });
}

/// The pseudo-inverse of a (k x k) J^T J: directions without curvature stay out.
[[nodiscard]] inline Eigen::MatrixXd inverse_where_determined(const Eigen::MatrixXd& hessian) {
  const Eigen::VectorXd per_length = column_lengths(hessian).cwiseInverse();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(per_length.asDiagonal() * hessian *
                                                             per_length.asDiagonal());
  constexpr double kNoCurvature = 1e-12;  // of unit columns
  const Eigen::VectorXd inverse = eigen.eigenvalues().unaryExpr(
      [](double value) { return value > kNoCurvature ? 1.0 / value : 0.0; });
  return per_length.asDiagonal() * eigen.eigenvectors() * inverse.asDiagonal() *
         eigen.eigenvectors().transpose() * per_length.asDiagonal();
}

inline Eigen::VectorXd OwnPoseSums::step(double damping) const {
  const Eigen::VectorXd per_length = column_lengths(hessian).cwiseInverse();
  Eigen::MatrixXd scaled = per_length.asDiagonal() * hessian * per_length.asDiagonal();
  constexpr double kNoCurvature = 1e-12;  // of unit columns
  scaled.diagonal().array() += damping + kNoCurvature;
  return per_length.cwiseProduct(scaled.ldlt().solve(-per_length.cwiseProduct(gradient)));
}

inline double OwnPoseSums::decrease(const Eigen::VectorXd& change) const {
  return -gradient.dot(change) - 0.5 * change.dot(hessian * change);
}

/// The damping of a Levenberg-Marquardt search.
/// Source: Nielsen, Damping Parameter in Marquardt's Method, 1999.
struct Damping {
  static constexpr double kMost = 1e12;  ///< where no step helps
  double value = 1e-6, growth = 2.0;

  /// @param gain  the decrease of the cost, as a share of what was promised; negative: there was none
  void update(double gain) {
    if (gain < 0.0) {
      value = std::max(1e-4, value * growth);
      growth *= 2.0;
    } else {
      value *= std::max(1.0 / 3.0, 1.0 - std::pow(2.0 * gain - 1.0, 3));
      growth = 2.0;
    }
  }
};

}  // namespace detail

}  // namespace kinecal
