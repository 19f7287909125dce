// A sensor in a batch of samples: poses, twists, and its output for each feature.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>
#include <vector>

#include "kinecal/evaluation/views/compiled_walk.hpp"
#include "kinecal/evaluation/views/sensor_code.hpp"
#include "kinecal/evaluation/views/sensor_state.hpp"

namespace kinecal::detail {

/// How a problem evaluates a sensor in S.
template <class S>
struct SensorEvaluation {
  std::shared_ptr<const SensorCode<S>> code;  ///< its functions
  std::vector<CompiledWalk<S>> walks;         ///< of its first chains, as far as there are any
};

/// A sensor in the current batch of samples.
template <class S>
class SensorView {
 public:
  SensorView() = default;
  SensorView(SensorView&&) noexcept = default;  ///< moves only: starts_ point into twists_
  SensorView& operator=(SensorView&&) noexcept = default;  ///< moves only: see above

  /// The sensor's observations in the current batch.
  [[nodiscard]] const BatchObservation<S>& observation() const { return observation_; }
  /// The sensor's own parameters.
  [[nodiscard]] const OwnParameters& own() const { return state_->own; }
  /// Its functions.
  [[nodiscard]] const SensorCode<S>& code() const { return *evaluation_->code; }
  /// Its output for a feature, in the base: vectors in the order of VectorsOf.
  [[nodiscard]] const Vector3<S>* values(std::size_t feature) const {
    return values_.data() + feature * num_values_;
  }
  /// Derivatives of a feature's variables by each free parameter of the sensor, in the base.
  [[nodiscard]] const Vector3<S>* changes(std::size_t feature) const {
    return changes_.data() + feature * changes_per_feature_;
  }
  /// Each feature in the base, metres; for sensors that deliver points.
  [[nodiscard]] const std::vector<Vector3<S>>& points() const { return values_; }
  /// The pose of the sensor's own frame in the base.
  [[nodiscard]] const Pose<S>& pose() const { return poses_[0]; }
  /// The twist in the base for each free parameter of a chain.
  [[nodiscard]] const ChainTwists<S>& twists(std::size_t chain) const { return twists_[chain]; }

  /// Starts an evaluation: computes everything that does not depend on the samples.
  /// @param derivatives  compute twists and derivatives by the sensor's parameters, too
  void start(const MountedSensor& sensor, const SensorEvaluation<S>& evaluation,
             const SensorState& state, bool derivatives);

  /// Evaluates the sensor for the next batch of samples.
  void update(BatchObservation<S> seen);

 private:
  const SensorEvaluation<S>* evaluation_ = nullptr;
  const SensorState* state_ = nullptr;
  bool derivatives_ = false;
  BatchObservation<S> observation_;
  std::vector<WalkStart<S>> starts_;    ///< of each chain
  std::vector<Walk<S>> walks_;          ///< of each chain
  std::vector<Pose<S>> poses_;          ///< of each chain's tip in the base
  std::vector<ChainTwists<S>> twists_;  ///< of each chain
  std::size_t num_values_ = 0, changes_per_feature_ = 0;
  std::vector<Vector3<S>> values_;   ///< of each feature, in the base
  std::vector<Vector3<S>> changes_;  ///< of each feature by each free parameter, in the base
};

}  // namespace kinecal::detail
