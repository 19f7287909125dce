// A sensor's features in the base, for given parameters, and how each parameter moves them.
//
// All error blocks share one view, which is filled once per pack of samples; the part of a chain
// before its first moving joint is walked once per evaluation.  Kinematics gives one twist per
// parameter for all points of a chain.  A depth camera's own parameters move each point
// differently; those motions are computed on demand.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "kinecal/crate/compiled_walk.hpp"
#include "kinecal/crate/sensor_model.hpp"

namespace kinecal {

/// What all samples of one evaluation share.
struct SensorState {
  std::vector<Corrections<double>> corrections;    ///< of each chain
  std::vector<std::vector<JointIndices>> columns;  ///< of the joints of each chain
  std::vector<TwistColumns> twist_columns;         ///< of each chain
  /// Values of the camera's parameters, in the order of kCameraParameters.
  std::array<double, 6> camera_values{};
  std::vector<int> free_camera;     ///< which of the camera's parameters are free
  std::vector<int> camera_columns;  ///< their columns of the Jacobian

  /// @param free  the columns of the Jacobian
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

  /// Takes over new values.
  /// @param values  of all parameters of the table
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

/// One sensor's features in one pack of samples, in the base.
template <class S>
class SensorView {
 public:
  SensorView() = default;
  SensorView(SensorView&&) noexcept = default;  ///< moves only: starts_ point into twists_
  SensorView& operator=(SensorView&&) noexcept = default;  ///< moves only: see above

  /// What the sensor observed in the current pack.
  [[nodiscard]] const PackedObservation<S>& observation() const { return *observation_; }
  /// What all packs share.
  [[nodiscard]] const SensorState& state() const { return *state_; }
  /// Each feature in the base, metres.
  [[nodiscard]] const std::vector<Vector3<S>>& points() const { return points_; }
  /// The pose of the sensor's own frame in the base.
  [[nodiscard]] const Pose<S>& pose() const { return poses_[0]; }
  /// The twist in the base for each free parameter of a chain.
  [[nodiscard]] const ChainTwists<S>& twists(std::size_t chain) const { return twists_[chain]; }
  /// True for a depth camera.
  [[nodiscard]] bool sees_depth() const { return observation_->depth_camera != nullptr; }

  /// Number of free parameters of a depth camera; zero if derivatives were not asked for.
  [[nodiscard]] std::size_t num_camera_motions() const {
    return sees_depth() && derivatives_ ? state_->free_camera.size() : 0;
  }
  /// Calls visit(const Vector3<S>&) for each of them with the derivative of feature i: metres per
  /// unit of the parameter, in the base.
  template <class Visit>
  void for_each_camera_motion(std::size_t i, Visit&& visit) const {
    for_each_camera_motion(i, num_camera_motions(), visit);
  }
  /// The same.
  /// @param count  num_camera_motions(), if the compiler knows it
  template <class Visit>
  void for_each_camera_motion(std::size_t i, std::size_t count, Visit&& visit) const {
    if (count == 0) return;
    const auto seen = camera_->see(observation_->measured[i]);
    const Matrix3<S>& rotation = poses_[0].rotation;
    const Vector3<S> ray = ray_of(rotation, seen);
    if (count == DepthCamera<>::kParameters) {  // most often
      [&]<int... K>(std::integer_sequence<int, K...>) {
        (visit(moved(rotation, ray, seen, K)), ...);
      }
      (std::make_integer_sequence<int, DepthCamera<>::kParameters>{});
    } else {
      for (const int k : state_->free_camera) visit(moved(rotation, ray, seen, k));
    }
  }

  /// Begins an evaluation: computes what does not depend on the samples.
  /// @param derivatives  compute twists and camera motions, too
  /// @param walks        compiled walks; a chain without one is walked joint by joint
  void start(const SensorModel& model, const SensorState& state, bool derivatives,
             std::span<const CompiledWalk<S>> walks = {});

  /// Evaluates the sensor for the next pack of samples.
  void update(const PackedObservation<S>& seen);

 private:
  void start_chain(std::size_t c);

  KINECAL_FLATTEN void walk_chain(std::size_t c);

  KINECAL_FLATTEN void place_camera_points();

  using Seen = typename CorrectedDepthCamera<S>::Seen;

  /// The ray to a point that the camera sees: in the base, of length one along the optical axis.
  [[nodiscard]] static Vector3<S> ray_of(const Matrix3<S>& rotation, const Seen& seen) {
    Vector3<S> ray;
    for (int r = 0; r < 3; ++r) {
      ray(r) = rotation(r, 0) * seen.s + rotation(r, 1) * seen.t + rotation(r, 2);
    }
    return ray;
  }

  /// Derivative of a point by parameter k: metres per unit, in the base.
  [[nodiscard]] static Vector3<S> moved(const Matrix3<S>& rotation, const Vector3<S>& ray,
                                        const Seen& seen, int k) {
    const auto times = [](const Vector3<S>& v, S x) {
      return Vector3<S>(v(0) * x, v(1) * x, v(2) * x);
    };
    switch (k) {
      case 0:
        return times(rotation.col(0), seen.x_by_fx);
      case 1:
        return times(rotation.col(1), seen.y_by_fy);
      case 2:
        return times(rotation.col(0), seen.x_by_cx);
      case 3:
        return times(rotation.col(1), seen.y_by_cy);
      case 4:
        return times(ray, seen.depth_by_offset);
      default:
        return times(ray, seen.depth_by_scaling);
    }
  }

  const SensorModel* model_ = nullptr;
  const SensorState* state_ = nullptr;
  bool derivatives_ = false;
  const PackedObservation<S>* observation_ = nullptr;
  std::vector<WalkStart<S>> starts_;                      ///< of each chain
  std::vector<typename CompiledWalk<S>::Walk> compiled_;  ///< of each chain, or nullptr
  std::vector<Pose<S>> poses_;                            ///< of each chain's tip in the base
  std::vector<ChainTwists<S>> twists_;                    ///< of each chain
  std::vector<Vector3<S>> points_;                        ///< of each feature, in the base
  std::optional<CorrectedDepthCamera<S>> camera_;
};

template <class S>
void SensorView<S>::start(const SensorModel& model, const SensorState& state, bool derivatives,
                          std::span<const CompiledWalk<S>> walks) {
  model_ = &model;
  state_ = &state;
  derivatives_ = derivatives;
  poses_.resize(model.chains().size());
  twists_.resize(model.chains().size());
  starts_.resize(model.chains().size());
  compiled_.assign(model.chains().size(), nullptr);
  for (std::size_t c = 0; c < starts_.size(); ++c) {
    start_chain(c);
    for (const CompiledWalk<S>& walk : walks) {
      if (walk.tip != model.chains()[c].tip) continue;
      if (!derivatives) compiled_[c] = walk.pose_only;
      if (derivatives && walk.columns == state.columns[c]) compiled_[c] = walk.with_twists;
    }
  }
}

template <class S>
void SensorView<S>::update(const PackedObservation<S>& seen) {
  observation_ = &seen;
  for (std::size_t c = 0, end = poses_.size(); c < end; ++c) {
    if (!seen.motions[c]) continue;
    if (compiled_[c] != nullptr) {
      compiled_[c](starts_[c], seen.motions[c]->data(), poses_[c]);
    } else {
      walk_chain(c);
    }
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

template <class S>
void SensorView<S>::start_chain(std::size_t c) {
  const RuntimeChain& chain = model_->chains()[c];
  const std::span<const JointCorrection<double>> corrections = state_->corrections[c];
  if (!derivatives_) {
    PoseWalker<S> walker;
    const std::size_t joint = walk_to_first_motion(chain, corrections, walker);
    starts_[c] = {walker.pose, joint, corrections.data(), nullptr, nullptr};
    return;
  }
  state_->twist_columns[c].resize(twists_[c]);
  TwistWalker<S> walker(state_->columns[c], twists_[c]);
  const std::size_t joint = walk_to_first_motion(chain, corrections, walker);
  starts_[c] = {walker.walker.pose, joint, corrections.data(), walker.turn, walker.shift};
}

template <class S>
KINECAL_FLATTEN void SensorView<S>::walk_chain(std::size_t c) {
  const RuntimeChain& chain = model_->chains()[c];
  const std::span<const Motion<S>> motions = *observation_->motions[c];
  const std::span<const JointCorrection<double>> corrections = state_->corrections[c];
  const WalkStart<S>& start = starts_[c];
  if (!derivatives_) {
    PoseWalker<S> walker{start.pose};
    walk_on(chain, start.joint, motions, corrections, walker);
    poses_[c] = walker.pose;
    return;
  }
  TwistWalker<S> walker(state_->columns[c], start.turn, start.shift, start.pose);
  walk_on(chain, start.joint, motions, corrections, walker);
  poses_[c] = walker.walker.pose;
}

template <class S>
KINECAL_FLATTEN void SensorView<S>::place_camera_points() {
  const CorrectedDepthCamera<S> camera(*observation_->depth_camera, state_->camera_values);
  if (derivatives_) camera_ = camera;
  const Pose<S>& pose = poses_[0];  // a camera's features are in its own frame
  const Vector3<S>* measured = observation_->measured.data();
  for (Vector3<S>& point : points_) {
    const auto seen = camera.see(*measured++);
    const Vector3<S> ray = ray_of(pose.rotation, seen);
    for (int r = 0; r < 3; ++r) point(r) = pose.translation(r) + ray(r) * seen.depth;
  }
}

}  // namespace kinecal
