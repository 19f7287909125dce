// A sensor's features in the base, for given parameters, and how each parameter moves them.
//
// Filled once per pack of samples and shared by all error blocks; what lies before the first joint
// that moves, once per evaluation.  Kinematics contributes one twist
// per parameter for all points of a chain; a depth camera's own parameters move each point in its
// own way.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>
#include <vector>

#include "kinecal/crate/compiled_walk.hpp"
#include "kinecal/crate/sensor_model.hpp"

namespace kinecal {

/// What is the same for all samples of one evaluation.
struct SensorState {
  std::vector<Corrections<double>> corrections;    ///< of each chain
  std::vector<std::vector<JointIndices>> columns;  ///< of the joints of each chain
  std::vector<TwistColumns> twist_columns;         ///< of each chain
  std::array<double, 6> camera_values{};
  std::vector<int> free_camera;     ///< which of the camera's parameters are free
  std::vector<int> camera_columns;  ///< and their columns

  /// @param free  which parameters are columns of the Jacobian
  SensorState(const SensorModel& model, const FreeSet& free) : corrections(model.chains().size()) {
    for (std::size_t c = 0; c < model.chains().size(); ++c) {
      columns.push_back(columns_of(model.parameters()[c], free));
      twist_columns.push_back(kinecal::twist_columns(model.chains()[c], columns.back()));
    }
    for (std::size_t i = 0; i < model.camera_parameters().size(); ++i) {
      const int column = free.column(model.camera_parameters()[i]);
      if (column < 0) continue;
      free_camera.push_back(static_cast<int>(i));
      camera_columns.push_back(column);
    }
  }

  /// @param values  of all parameters
  void set(const SensorModel& model, std::span<const double> values) {
    for (std::size_t c = 0; c < corrections.size(); ++c) {
      set_corrections(model.parameters()[c], values, corrections[c]);
    }
    for (std::size_t i = 0; i < model.camera_parameters().size(); ++i) {
      const int parameter = model.camera_parameters()[i];
      if (parameter >= 0) camera_values[i] = values[static_cast<std::size_t>(parameter)];
    }
  }
};

template <class S>
class SensorView {
 public:
  [[nodiscard]] const PackedObservation<S>& observation() const { return *observation_; }
  [[nodiscard]] const SensorState& state() const { return *state_; }
  /// Each feature in the base, metres.
  [[nodiscard]] const std::vector<Vector3<S>>& points() const { return points_; }
  /// The pose of the sensor's own frame in the base.
  [[nodiscard]] const Pose<S>& pose() const { return poses_[0]; }
  [[nodiscard]] const ChainTwists<S>& twists(std::size_t chain) const { return twists_[chain]; }
  [[nodiscard]] bool sees_depth() const { return observation_->depth_camera != nullptr; }

  /// How the free parameters of a depth camera move feature i: metres, in the base, per unit.
  [[nodiscard]] std::span<const Vector3<S>> camera_motion(std::size_t i) const {
    if (!sees_depth() || !derivatives_) return {};
    const std::size_t n = state_->free_camera.size();
    return std::span(camera_motion_).subspan(i * n, n);
  }

  /// Begins an evaluation: what does not depend on the samples.
  /// @param derivatives  twists and camera motions, too
  /// @param walks  those that are compiled; chains that they do not lead along are walked as usual
  void start(const SensorModel& model, const SensorState& state, bool derivatives,
             std::span<const CompiledWalk<S>> walks = {}) {
    model_ = &model;
    state_ = &state;
    derivatives_ = derivatives;
    poses_.resize(model.chains().size());
    twists_.resize(model.chains().size());
    starts_.resize(model.chains().size());
    for (std::size_t c = 0; c < starts_.size(); ++c) {
      start_chain(c);
      for (const CompiledWalk<S>& walk : walks) {
        const bool fits =
            walk.tip == model.chains()[c].tip && (!derivatives || walk.columns == state.columns[c]);
        if (fits) starts_[c].compiled = &walk;
      }
    }
  }

  /// Goes on to a pack of samples.
  void update(const PackedObservation<S>& seen) {
    observation_ = &seen;
    for (std::size_t c = 0; c < poses_.size(); ++c) {
      if (seen.motions[c]) walk_chain(c);
    }
    points_.resize(seen.measured.size());
    if (seen.depth_camera) {
      place_camera_points();
    } else if (!seen.pinhole_camera) {
      for (std::size_t i = 0; i < seen.measured.size(); ++i) {
        points_[i] = poses_[seen.chain[i]] * seen.measured[i];
      }
    }
  }

 private:
  /// How far the walk of a chain comes before anything moves.
  struct Start {
    Pose<S> pose;
    std::size_t joint = 0;
    std::ptrdiff_t turns = 0, shifts = 0;
    const CompiledWalk<S>* compiled = nullptr;  ///< for the rest of it
  };

  void start_chain(std::size_t c) {
    const RuntimeChain& chain = model_->chains()[c];
    const std::span<const JointCorrection<double>> corrections = state_->corrections[c];
    if (!derivatives_) {
      PoseWalker<S> walker;
      const std::size_t joint = walk_to_first_motion(chain, corrections, walker);
      starts_[c] = {walker.pose, joint, 0, 0, nullptr};
      return;
    }
    state_->twist_columns[c].resize(twists_[c]);
    TwistWalker<S> walker(state_->columns[c], twists_[c]);
    const std::size_t joint = walk_to_first_motion(chain, corrections, walker);
    starts_[c] = {walker.walker.pose, joint, walker.turn - twists_[c].turns.data(),
                  walker.shift - twists_[c].shifts.data(), nullptr};
  }

  KINECAL_FLATTEN void walk_chain(std::size_t c) {
    const RuntimeChain& chain = model_->chains()[c];
    const std::span<const Motion<S>> motions = *observation_->motions[c];
    const std::span<const JointCorrection<double>> corrections = state_->corrections[c];
    const Start& start = starts_[c];
    Twist<S>* turn = twists_[c].turns.data() + start.turns;
    Vector3<S>* shift = twists_[c].shifts.data() + start.shifts;
    if (start.compiled != nullptr) {
      if (derivatives_) {
        start.compiled->with_twists(motions, corrections, start.pose, poses_[c], turn, shift);
      } else {
        start.compiled->pose_only(motions, corrections, start.pose, poses_[c]);
      }
      return;
    }
    if (!derivatives_) {
      PoseWalker<S> walker{start.pose};
      walk_on(chain, start.joint, motions, corrections, walker);
      poses_[c] = walker.pose;
      return;
    }
    TwistWalker<S> walker(state_->columns[c], turn, shift, start.pose);
    walk_on(chain, start.joint, motions, corrections, walker);
    poses_[c] = walker.walker.pose;
  }

  KINECAL_FLATTEN void place_camera_points() {
    const CorrectedDepthCamera<S> camera(*observation_->depth_camera, state_->camera_values);
    const std::size_t features = points_.size(), parameters = state_->free_camera.size();
    const Pose<S> pose = poses_[0];  // what a camera sees is in its own frame
    const Vector3<S>* measured = observation_->measured.data();
    Vector3<S>* points = points_.data();
    if (!derivatives_) {
      for (std::size_t i = 0; i < features; ++i) points[i] = pose * camera.point(measured[i]);
      return;
    }
    camera_motion_.resize(features * parameters);
    Vector3<S>* motion = camera_motion_.data();
    for (std::size_t i = 0; i < features; ++i, motion += parameters) {
      const auto seen = camera.see(measured[i]);
      points[i] = pose * seen.point;
      if (parameters == 6) {  // most often
        for_all(std::make_index_sequence<6>{},
                [&](auto k) { motion[k] = turned(pose.rotation, seen, static_cast<int>(k)); });
      } else {
        for (std::size_t k = 0; k < parameters; ++k) {
          motion[k] = turned(pose.rotation, seen, state_->free_camera[k]);
        }
      }
    }
  }

  template <std::size_t... K, class F>
  static void for_all(std::index_sequence<K...>, F&& f) {
    (f(std::integral_constant<std::size_t, K>{}), ...);
  }

  /// How parameter k moves a point, in the base.
  [[nodiscard]] static Vector3<S> turned(const Matrix3<S>& rotation,
                                         const typename CorrectedDepthCamera<S>::Seen& seen,
                                         int k) {
    switch (k) {
      case 0:
        return rotation.col(0) * seen.x_by_fx;
      case 1:
        return rotation.col(1) * seen.y_by_fy;
      case 2:
        return rotation.col(0) * seen.x_by_cx;
      case 3:
        return rotation.col(1) * seen.y_by_cy;
      case 4:
        return rotated(rotation, seen.by_offset);
      default:
        return rotated(rotation, seen.by_scaling);
    }
  }

  const SensorModel* model_ = nullptr;
  const SensorState* state_ = nullptr;
  bool derivatives_ = false;
  const PackedObservation<S>* observation_ = nullptr;
  std::vector<Start> starts_;              ///< of each chain
  std::vector<Pose<S>> poses_;             ///< of each chain's tip in the base
  std::vector<ChainTwists<S>> twists_;     ///< of each chain
  std::vector<Vector3<S>> points_;         ///< of each feature, in the base
  std::vector<Vector3<S>> camera_motion_;  ///< of each feature and free camera parameter
};

}  // namespace kinecal
