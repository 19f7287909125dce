// Definitions of sensor_view.hpp, for a scalar S.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>

#include "kinecal/evaluation/views/sensor_view.hpp"

namespace kinecal::detail {

template <class S>
void SensorView<S>::start(const MountedSensor& sensor, const SensorEvaluation<S>& evaluation,
                          const SensorState& state, bool derivatives) {
  evaluation_ = &evaluation;
  state_ = &state;
  derivatives_ = derivatives;
  observation_ = {};
  num_values_ = code().num_values();
  changes_per_feature_ = derivatives ? code().num_variables() * own().free.size() : 0;
  const std::size_t chains = sensor.chains().size();
  poses_.resize(chains);
  twists_.resize(chains);
  starts_.clear();
  walks_.clear();
  for (std::size_t c = 0; c < chains; ++c) {
    const RuntimeChain& chain = sensor.chains()[c].chain();
    const std::span<const JointIndices> columns = state.columns[c];
    state.twist_columns[c].resize(twists_[c]);
    TwistWalker<S> walker(columns, twists_[c]);
    const std::size_t joint = walk_to_first_motion(chain, state.corrections[c], walker);
    const bool models = state.effects[c] > 0;
    starts_.push_back({walker.walker.pose, &chain, joint, state.corrections[c], columns,
                       state.effects[c], walker.turn, walker.shift});
    walks_.push_back(runtime_walk<S>(derivatives, models));
    if (c >= evaluation.walks.size() || models) continue;
    const CompiledWalk<S>& compiled = evaluation.walks[c];
    if (!derivatives) walks_[c] = compiled.pose_only;
    const bool same = std::equal(columns.begin(), columns.end(), compiled.columns.begin(),
                                 compiled.columns.end());
    if (derivatives && same) walks_[c] = compiled.with_twists;
  }
}

template <class S>
void SensorView<S>::update(BatchObservation<S> seen) {
  const bool placed = state_->placed;
  if (placed && seen.layout != observation_.layout) {
    values_.resize(seen.size() * num_values_);
    changes_.resize(seen.size() * changes_per_feature_);
  }
  observation_ = seen;
  for (std::size_t c = 0, end = poses_.size(); c < end; ++c) {
    if (seen.has_joints(c)) walks_[c](starts_[c], seen.joints(c), poses_[c]);
  }
  if (!placed) return;
  const std::span<const int> chosen =
      derivatives_ ? std::span<const int>(own().free) : std::span<const int>();
  code().place(seen, poses_, own().values, chosen, values_.data(), changes_.data());
}

}  // namespace kinecal::detail
