// A sensor as a batch of samples sees it: poses, twists, and what it delivers for each feature.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>
#include <vector>

#include "kinecal/evaluation/compiled_walk.hpp"
#include "kinecal/evaluation/sensor_code.hpp"
#include "kinecal/parameters/own_parameters.hpp"
#include "kinecal/problem/mounted_sensor.hpp"

namespace kinecal::detail {

/// What all batches of an evaluation share: the corrections of the sensor's chains, its parameters
/// and the columns of the Jacobian.
struct SensorState {
  std::vector<Corrections<double>> corrections;    ///< of each chain
  std::vector<std::vector<JointIndices>> columns;  ///< of the joints of each chain
  std::vector<TwistColumns> twist_columns;         ///< of each chain
  std::vector<bool> models;                        ///< of each chain: some joint has a model
  OwnParameters own;                               ///< of the sensor itself

  /// @param free  the columns of the Jacobian
  SensorState(const MountedSensor& sensor, const FreeSet& free)
      : corrections(sensor.chains().size()), own(sensor.parameters(), free) {
    for (std::size_t c = 0; c < sensor.chains().size(); ++c) {
      columns.push_back(columns_of(sensor.chain_parameters()[c], free));
      twist_columns.push_back(kinecal::twist_columns(sensor.chains()[c], columns.back()));
      models.push_back(have_models(sensor.chain_parameters()[c]));
    }
  }

  /// Takes over new values.
  /// @param values  of all parameters of the table
  void set(const MountedSensor& sensor, std::span<const double> values) {
    for (std::size_t c = 0; c < corrections.size(); ++c) {
      set_corrections(sensor.chain_parameters()[c], values, corrections[c]);
    }
    own.set(sensor.parameters(), values);
  }
};

/// How a problem evaluates a sensor in S.
template <class S>
struct SensorEvaluation {
  std::unique_ptr<const SensorCode<S>> code;  ///< its functions
  std::vector<CompiledWalk<S>> walks;         ///< of its first chains, as far as there are any
};

/// A sensor as it sees the current batch of samples.
template <class S>
class SensorView {
 public:
  SensorView() = default;
  SensorView(SensorView&&) noexcept = default;  ///< moves only: starts_ point into twists_
  SensorView& operator=(SensorView&&) noexcept = default;  ///< moves only: see above

  /// What the sensor observed in the current batch.
  [[nodiscard]] const BatchObservation<S>& observation() const { return observation_; }
  /// What all batches share.
  [[nodiscard]] const SensorState& state() const { return *state_; }
  /// The sensor's own parameters; none is free if derivatives were not asked for.
  [[nodiscard]] const OwnParameters& own() const { return state_->own; }
  /// Its functions.
  [[nodiscard]] const SensorCode<S>& code() const { return *evaluation_->code; }
  /// What it delivers for a feature, in the base: vectors as VectorsOf arranges them.
  [[nodiscard]] const Vector3<S>* values(std::size_t feature) const {
    return values_.data() + feature * num_values_;
  }
  /// Derivatives of a feature's variables by each free parameter of the sensor, in the base.
  [[nodiscard]] const Vector3<S>* changes(std::size_t feature) const {
    return changes_.data() + feature * changes_per_feature_;
  }
  /// Each feature in the base, metres; of a sensor that delivers points.
  [[nodiscard]] const std::vector<Vector3<S>>& points() const { return values_; }
  /// The pose of the sensor's own frame in the base.
  [[nodiscard]] const Pose<S>& pose() const { return poses_[0]; }
  /// The twist in the base for each free parameter of a chain.
  [[nodiscard]] const ChainTwists<S>& twists(std::size_t chain) const { return twists_[chain]; }

  /// Begins an evaluation: computes what does not depend on the samples.
  /// @param places       some block takes more of the sensor than predictions
  /// @param derivatives  compute twists and derivatives by the sensor's parameters, too
  void start(const MountedSensor& sensor, const SensorEvaluation<S>& evaluation,
             const SensorState& state, bool places, bool derivatives);

  /// Evaluates the sensor for the next batch of samples.
  void update(BatchObservation<S> seen);

 private:
  void start_chain(std::size_t c);

  template <bool kModels>
  KINECAL_FLATTEN void walk_chain(std::size_t c);

  const MountedSensor* sensor_ = nullptr;
  const SensorEvaluation<S>* evaluation_ = nullptr;
  const SensorState* state_ = nullptr;
  bool places_ = false, derivatives_ = false;
  BatchObservation<S> observation_;
  std::vector<WalkStart<S>> starts_;                      ///< of each chain
  std::vector<typename CompiledWalk<S>::Walk> compiled_;  ///< of each chain, or nullptr
  std::vector<Pose<S>> poses_;                            ///< of each chain's tip in the base
  std::vector<ChainTwists<S>> twists_;                    ///< of each chain
  std::size_t num_values_ = 0, changes_per_feature_ = 0;
  std::vector<Vector3<S>> values_;   ///< of each feature, in the base
  std::vector<Vector3<S>> changes_;  ///< of each feature by each free parameter, in the base
};

template <class S>
void SensorView<S>::start(const MountedSensor& sensor, const SensorEvaluation<S>& evaluation,
                          const SensorState& state, bool places, bool derivatives) {
  sensor_ = &sensor;
  evaluation_ = &evaluation;
  state_ = &state;
  places_ = places;
  derivatives_ = derivatives;
  observation_ = {};
  num_values_ = code().num_values();
  changes_per_feature_ = derivatives ? code().num_variables() * own().free.size() : 0;
  const std::size_t chains = sensor.chains().size();
  poses_.resize(chains);
  twists_.resize(chains);
  starts_.resize(chains);
  compiled_.assign(chains, nullptr);
  for (std::size_t c = 0; c < chains; ++c) {
    start_chain(c);
    if (c >= evaluation.walks.size()) continue;
    const CompiledWalk<S>& walk = evaluation.walks[c];
    if (walk.models != state.models[c]) continue;
    if (!derivatives) compiled_[c] = walk.pose_only;
    if (derivatives && walk.columns == state.columns[c]) compiled_[c] = walk.with_twists;
  }
}

template <class S>
void SensorView<S>::update(BatchObservation<S> seen) {
  if (places_ && seen.layout != observation_.layout) {
    values_.resize(seen.size() * num_values_);
    changes_.resize(seen.size() * changes_per_feature_);
  }
  observation_ = seen;
  for (std::size_t c = 0, end = poses_.size(); c < end; ++c) {
    if (!seen.has_joints(c)) continue;
    if (compiled_[c] != nullptr) {
      compiled_[c](starts_[c], seen.joints(c), poses_[c]);
    } else if (state_->models[c]) {
      walk_chain<true>(c);
    } else {
      walk_chain<false>(c);
    }
  }
  if (!places_) return;
  const std::span<const int> chosen =
      derivatives_ ? std::span<const int>(own().free) : std::span<const int>();
  code().place(seen, poses_, own().values, chosen, values_.data(), changes_.data());
}

template <class S>
void SensorView<S>::start_chain(std::size_t c) {
  const RuntimeChain& chain = sensor_->chains()[c];
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
template <bool kModels>
KINECAL_FLATTEN void SensorView<S>::walk_chain(std::size_t c) {
  const RuntimeChain& chain = sensor_->chains()[c];
  const JointStates<S, kModels> joints{observation_.joints(c)};
  const std::span<const JointCorrection<double>> corrections = state_->corrections[c];
  const WalkStart<S>& start = starts_[c];
  if (!derivatives_) {
    PoseWalker<S> walker;
    copy_numbers(start.pose, walker.pose);
    walk_on<kModels>(chain, start.joint, joints, corrections, walker);
    copy_numbers(walker.pose, poses_[c]);
    return;
  }
  TwistWalker<S> walker(state_->columns[c], start.turn, start.shift, start.pose);
  walk_on<kModels>(chain, start.joint, joints, corrections, walker);
  copy_numbers(walker.walker.pose, poses_[c]);
}

}  // namespace kinecal::detail
