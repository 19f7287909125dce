// The yardstick: KDL's forward kinematics, differentiated by Ceres' central differences.
//
// The method of robot_calibration at its best: chains, joint positions and parameters are resolved
// to segments and indices once, constant transforms are folded, and evaluation does not look up
// names.  KDL caches the last pose of a joint, so most of the 53 evaluations of a Jacobian compute
// hardly any sine or cosine.
//
//   pose of a joint = origin * correction * motion(q + offset)
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <ceres/numeric_diff_cost_function.h>

#include <kdl/segment.hpp>
#include <memory>

#include "kinecal/parameters/chain_parameters.hpp"
#include "method.hpp"

namespace kinecal::bench {

[[nodiscard]] inline KDL::Vector to_kdl(const Vector3<double>& v) {
  return {v.x(), v.y(), v.z()};
}
[[nodiscard]] inline KDL::Frame to_kdl(const Pose<double>& pose) {
  const Matrix3<double>& r = pose.rotation;
  return {KDL::Rotation(r(0, 0), r(0, 1), r(0, 2), r(1, 0), r(1, 1), r(1, 2), r(2, 0), r(2, 1),
                        r(2, 2)),
          to_kdl(pose.translation)};
}

/// A chain of KDL segments with the indices of the parameters that act on them.
class KdlChain {
 public:
  KdlChain(const RuntimeChain& chain, const ParameterTable& table) : tail_(to_kdl(chain.tail)) {
    const std::vector<JointIndices> parameters = chain_parameters(chain, table);
    for (std::size_t i = 0; i < chain.joints.size(); ++i) {
      const ChainJoint& joint = chain.joints[i];
      const KDL::Frame origin = to_kdl(joint.fixed);
      // A correction comes between origin and motion, so the segment has the motion only.
      const KDL::Frame in_segment = joint.corrected ? KDL::Frame::Identity() : origin;
      const KDL::Joint moved =
          moves(joint.type)
              ? KDL::Joint(joint.name, in_segment.p, in_segment.M * to_kdl(joint.axis),
                           turns(joint.type) ? KDL::Joint::RotAxis : KDL::Joint::TransAxis)
              : KDL::Joint(joint.name, KDL::Joint::Fixed);
      steps_.push_back({KDL::Segment(joint.name, moved, in_segment), origin, parameters[i],
                        moves(joint.type), joint.corrected});
    }
  }

  /// Measured positions in the order of the segments, zero for fixed ones.
  [[nodiscard]] std::vector<double> positions(const RuntimeChain& chain,
                                              const Sighting& seen) const {
    std::vector<double> all;
    for (const ChainJoint& joint : chain.joints) {
      all.push_back(moves(joint.type) ? seen(joint.name) : 0.0);
    }
    return all;
  }

  /// Pose of the tip in the base.
  /// @param x  (26) parameters
  [[nodiscard]] KDL::Frame pose(const std::vector<double>& positions, const double* x) const {
    KDL::Frame base_T_tip = KDL::Frame::Identity();
    for (std::size_t i = 0; i < steps_.size(); ++i) {
      const Step& step = steps_[i];
      if (step.corrected) base_T_tip = base_T_tip * (step.origin * correction(step.parameters, x));
      if (!step.moves) continue;
      const int offset = step.parameters.offset;
      base_T_tip = base_T_tip * step.segment.pose(positions[i] + (offset < 0 ? 0.0 : x[offset]));
    }
    return base_T_tip * tail_;
  }

 private:
  struct Step {
    KDL::Segment segment;
    KDL::Frame origin;
    JointIndices parameters;
    bool moves, corrected;
  };

  [[nodiscard]] static KDL::Frame correction(const JointIndices& joint, const double* x) {
    const auto value = [&](std::size_t axis) {
      return joint.frame[axis] < 0 ? 0.0 : x[joint.frame[axis]];
    };
    const KDL::Vector shift(value(0), value(1), value(2)), turn(value(3), value(4), value(5));
    // Not KDL's norm: it treats vectors below 1e-6 as zero, and steps of differences are smaller.
    const double angle = std::sqrt(KDL::dot(turn, turn));
    if (angle == 0.0) return KDL::Frame(shift);
    return {KDL::Rotation::Rot2(turn / angle, angle), shift};
  }

  std::vector<Step> steps_;
  KDL::Frame tail_;
};

struct KdlModel {
  FetchChains chains;
  KdlChain arm, camera;

  explicit KdlModel(const FetchWork& work)
      : chains(work), arm(chains.arm, work.table), camera(chains.camera, work.table) {}
};

/// The residuals of one sample, as Ceres differentiates them.
class KdlResiduals {
 public:
  KdlResiduals(const KdlModel& model, const Sighting& seen)
      : model_(model),
        arm_positions_(model.arm.positions(model.chains.arm, seen)),
        camera_positions_(model.camera.positions(model.chains.camera, seen)),
        camera_(seen.camera),
        measured_(seen.measured) {
    for (std::size_t i = 0; i < kLeds; ++i) on_arm_[i] = to_kdl(seen.on_arm[i]);
  }

  /// @param x         (26) parameters
  /// @param residual  (12) metres
  bool operator()(const double* x, double* residual) const {
    const KDL::Frame base_T_arm = model_.arm.pose(arm_positions_, x);
    const KDL::Frame base_T_camera = model_.camera.pose(camera_positions_, x);
    std::array<double, 6> depth;
    for (std::size_t i = 0; i < depth.size(); ++i) depth[i] = x[model_.chains.camera_parameters[i]];
    for (std::size_t i = 0; i < kLeds; ++i) {
      const KDL::Vector seen = to_kdl(DepthCamera{}.place(
          Measurement<DepthCamera, double>{.point = measured_[i], .settings = camera_}, depth));
      const KDL::Vector r = base_T_camera * seen - base_T_arm * on_arm_[i];
      for (int axis = 0; axis < 3; ++axis) residual[3 * i + axis] = r[axis];
    }
    return true;
  }

 private:
  const KdlModel& model_;
  std::vector<double> arm_positions_, camera_positions_;
  std::array<double, 6> camera_;
  std::array<Vector3<double>, kLeds> measured_;
  std::array<KDL::Vector, kLeds> on_arm_;
};

using KdlCost = ceres::NumericDiffCostFunction<KdlResiduals, ceres::CENTRAL, kRows, kParameters>;

class KdlNumeric {
 public:
  KdlNumeric(const FetchWork& work, int samples) : model_(work), start_(work.initial_values()) {
    for (const Sighting& seen : work.sightings(samples)) {
      costs_.push_back(std::make_unique<KdlCost>(new KdlResiduals(model_, seen)));
    }
    const auto rows = static_cast<Eigen::Index>(costs_.size()) * kRows;
    stacked_ = {Eigen::VectorXd(rows), RowMajor(rows, kParameters)};
  }

  void evaluate(Values x, bool derivatives) {
    const double* parameters = x.data();
    for (std::size_t n = 0; n < costs_.size(); ++n) {
      double* jacobian = stacked_.jacobian.data() + n * kRows * kParameters;
      (void)costs_[n]->Evaluate(&parameters, stacked_.residual.data() + n * kRows,
                                derivatives ? &jacobian : nullptr);
    }
  }

  [[nodiscard]] const Stacked& stacked() const { return stacked_; }

  [[nodiscard]] Solved solve() const {
    Eigen::VectorXd x = start_;
    return solve_with_ceres(costs_, x);
  }

 private:
  KdlModel model_;
  Eigen::VectorXd start_;
  std::vector<std::unique_ptr<KdlCost>> costs_;
  Stacked stacked_;
};

}  // namespace kinecal::bench
