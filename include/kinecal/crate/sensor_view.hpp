// A sensor's features in the base, for given parameters, and how each parameter moves them.
//
// Filled once per sample and shared by all error blocks.  Kinematics contributes one twist per
// parameter for all points of a chain; a depth camera's own parameters move each point in its own
// way and are differentiated by jets.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>
#include <vector>

#include "kinecal/crate/sensor_model.hpp"
#include "kinecal/geometry/jet.hpp"

namespace kinecal {

/// What is the same for all samples of one evaluation.
struct SensorState {
  std::vector<Corrections<double>> corrections;    ///< of each chain
  std::vector<std::vector<JointIndices>> columns;  ///< of each chain; empty: no derivatives wanted
  std::array<double, 6> camera_values{};
  std::array<int, 6> camera_columns{-1, -1, -1, -1, -1, -1};

  /// @param values  of all parameters
  /// @param free    which of them are columns of the Jacobian; nullptr: no derivatives
  SensorState(const SensorModel& model, std::span<const double> values, const FreeSet* free) {
    for (const auto& parameters : model.parameters()) {
      corrections.push_back(corrections_for(parameters, values));
      if (free != nullptr) columns.push_back(columns_of(parameters, *free));
    }
    for (std::size_t i = 0; i < model.camera_parameters().size(); ++i) {
      const int parameter = model.camera_parameters()[i];
      if (parameter >= 0) camera_values[i] = values[static_cast<std::size_t>(parameter)];
      if (free != nullptr) camera_columns[i] = free->column(parameter);
    }
  }
};

class SensorView {
 public:
  using CameraJacobian = Eigen::Matrix<double, 3, DepthCamera::kParameters>;

  [[nodiscard]] const PackedObservation& observation() const { return *observation_; }
  [[nodiscard]] const std::vector<Vector3<double>>& points() const { return points_; }
  [[nodiscard]] const SensorState& state() const { return *state_; }
  /// True for a depth camera.
  [[nodiscard]] bool sees_depth() const { return !by_camera_.empty(); }
  /// The pose of the sensor's own frame in the base.
  [[nodiscard]] const Pose<double>& pose() const { return poses_[0]; }

  void update(const SensorModel& model, const SensorState& state, const PackedObservation& seen) {
    state_ = &state;
    observation_ = &seen;
    const bool derivatives = !state.columns.empty();
    poses_.resize(model.chains().size());
    twists_.resize(model.chains().size());
    for (std::size_t c = 0; c < poses_.size(); ++c) {
      if (seen.motions[c]) walk_chain(model, c, derivatives);
    }
    points_.clear();
    by_camera_.clear();
    if (model.sensor().type == SensorType::camera2d) return;
    for (std::size_t i = 0; i < seen.measured.size(); ++i) {
      add_point(model.sensor().type, i, derivatives);
    }
  }

  /// Adds to the rows of a Jacobian what moving point i does to a residual.
  /// @param p                  (3) where the point is, metres, in the base
  /// @param residual_by_point  (m x 3) derivative of the residual with respect to the point in base
  template <class ByPoint, class Rows>
  void add_motion(std::size_t i, const Vector3<double>& p, const ByPoint& residual_by_point,
                  Rows&& rows) const {
    for (const Twist<double>& twist : twists_[observation_->chain[i]]) {
      rows.col(twist.column) += residual_by_point * twist.velocity(p);
    }
    if (by_camera_.empty()) return;
    for (std::size_t k = 0; k < DepthCamera::kParameters; ++k) {
      if (const int column = state_->camera_columns[k]; column >= 0) {
        rows.col(column) += residual_by_point * by_camera_[i].col(static_cast<int>(k));
      }
    }
  }

  /// Adds what moving this sensor does to a residual of a point that it looks at: the same as
  /// moving the point the other way.
  template <class ByPoint, class Rows>
  void add_viewer_motion(const Vector3<double>& p_base, const ByPoint& residual_by_point,
                         Rows&& rows) const {
    for (const Twist<double>& twist : twists_[0]) {
      rows.col(twist.column) -= residual_by_point * twist.velocity(p_base);
    }
  }

 private:
  void walk_chain(const SensorModel& model, std::size_t c, bool derivatives) {
    const std::span<const Motion<double>> motions = *observation_->motions[c];
    const std::span<const JointCorrection<double>> corrections = state_->corrections[c];
    if (!derivatives) {
      PoseWalker<double> walker;
      walk(model.chains()[c], motions, corrections, walker);
      poses_[c] = walker.pose;
      return;
    }
    twists_[c].clear();
    TwistWalker<double> walker{state_->columns[c], {}, std::move(twists_[c])};
    walk(model.chains()[c], motions, corrections, walker);
    poses_[c] = walker.walker.pose;
    twists_[c] = std::move(walker.twists);
  }

  void add_point(SensorType type, std::size_t i, bool derivatives) {
    const Pose<double>& pose = poses_[observation_->chain[i]];
    const Vector3<double>& measured = observation_->measured[i];
    if (type == SensorType::chain3d) {
      points_.push_back(pose * measured);
      return;
    }
    const DepthCamera& camera = observation_->depth_camera;
    points_.push_back(pose * camera.point(measured, state_->camera_values));
    if (!derivatives) return;
    using CameraJet = Jet<double, DepthCamera::kParameters>;
    std::array<CameraJet, DepthCamera::kParameters> parameters;
    for (int k = 0; k < DepthCamera::kParameters; ++k) {
      const auto index = static_cast<std::size_t>(k);
      parameters[index] = CameraJet(state_->camera_values[index], k);
    }
    const Vector3<CameraJet> point = camera.point(measured, parameters);
    CameraJacobian& by_camera = by_camera_.emplace_back();
    for (int row = 0; row < 3; ++row) by_camera.row(row) = point(row).v.transpose();
    by_camera = pose.rotation * by_camera;
  }

  const SensorState* state_ = nullptr;
  const PackedObservation* observation_ = nullptr;
  std::vector<Pose<double>> poses_;                 ///< of each chain's tip in the base
  std::vector<std::vector<Twist<double>>> twists_;  ///< of each chain
  std::vector<Vector3<double>> points_;             ///< of each feature, in the base
  std::vector<CameraJacobian> by_camera_;           ///< of each feature; empty: no camera
};

}  // namespace kinecal
