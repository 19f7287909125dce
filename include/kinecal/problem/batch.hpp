// Samples as they are evaluated: as many at once as a packet has lanes.
//
// A sample is prepared once, as a row of numbers: sine and cosine of its joints, measurements as
// the sensors need them.  Samples of one layout (the same sensors observed the same number of
// features in the same frames, and the same terms apply) share batches, one lane each: a structure
// of arrays.  All batches of a layout lie one after the other in memory.  A lane without a sample
// repeats the first one with weight zero; a feature that is NaN repeats another one with weight
// zero.  So one code path evaluates everything, without a remainder loop.
// Source: ARCHITECTURE.md, ideas 4 (no trigonometry in the loop) and 5 (packets over samples).
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include "kinecal/geometry/packet.hpp"
#include "kinecal/kinematics/joint_state.hpp"
#include "kinecal/problem/sample_numbers.hpp"

namespace kinecal::detail {

/// Where the numbers of an observation are in a batch.
struct ObservationLayout {
  std::vector<std::size_t> chain;   ///< of each feature
  std::vector<std::size_t> joints;  ///< first number of each chain's joints, or kNoJoints
  std::size_t measured = 0, settings = 0, usable = 0;  ///< first number of each
  std::size_t usable_step = 0;  ///< one, or zero if no feature is missing: one number for all
  std::size_t width = 3;        ///< numbers of each feature in `measured`

  static constexpr std::size_t kNoJoints = static_cast<std::size_t>(-1);  ///< no feature is there
};

/// The joint states of a chain in a batch, by index of the joint.
/// @tparam kModels  some joint of the chain has parameters of joint models
template <class S, bool kModels>
struct JointStates {
  /// Of each joint: position, cosine, sine; without models what it moves by: cosine and sine if it
  /// turns, else position and nothing.
  const S* numbers;

  /// The state of a joint; without models its position is that of a joint that slides.
  [[nodiscard]] JointState<S> operator[](std::size_t joint) const {
    const S* of_joint = numbers + (kModels ? 3 : 2) * joint;
    return {of_joint[0], of_joint[kModels ? 1 : 0], of_joint[kModels ? 2 : 1]};
  }
};

/// What one sensor observed in the samples of a batch.
template <class S>
struct BatchObservation {
  const S* numbers = nullptr;                 ///< of the batch
  const ObservationLayout* layout = nullptr;  ///< where the sensor's are

  /// Number of features.
  [[nodiscard]] std::size_t size() const { return layout->chain.size(); }
  /// The sensor's chain to a feature.
  [[nodiscard]] std::size_t chain(std::size_t feature) const { return layout->chain[feature]; }
  /// One if a feature was observed, else zero; lane by lane.
  [[nodiscard]] const S& usable(std::size_t feature) const {
    return numbers[layout->usable + feature * layout->usable_step];
  }
  /// The numbers of a feature: 3, or 12 with an orientation (column by column).
  [[nodiscard]] const S* measured(std::size_t feature) const {
    return numbers + layout->measured + feature * layout->width;
  }
  /// The settings of the observation.
  [[nodiscard]] const S* settings() const { return numbers + layout->settings; }
  /// True if a chain leads to a feature.
  [[nodiscard]] bool has_joints(std::size_t chain) const {
    return layout->joints[chain] != ObservationLayout::kNoJoints;
  }
  /// The numbers of JointStates of a chain that leads to a feature.
  [[nodiscard]] const S* joints(std::size_t chain) const { return numbers + layout->joints[chain]; }
};

/// What a term takes of the samples of a batch besides the observations of its sensors.
template <class S>
struct BatchTerm {
  /// Of each feature, lane by lane: the block's sigma over the feature's own; nullptr: all are one.
  const S* factors = nullptr;
  const S* conditions = nullptr;  ///< those that the block takes, lane by lane
};

/// All samples of one layout.
template <class S>
class Batches {
 public:
  /// @param first  a sample of the layout
  Batches(std::vector<int> terms, const SampleNumbers& first) : terms_(std::move(terms)) {
    for (const auto& seen : first.sensors) {
      auto& layout = layouts_.emplace_back();
      if (!seen) continue;
      layout.emplace();
      layout->chain = seen->chain;
      for (const auto& joints : seen->joints) {
        layout->joints.push_back(joints ? reserve(*joints) : ObservationLayout::kNoJoints);
      }
      layout->settings = reserve(seen->settings);
      layout->measured = reserve(seen->measured);
      layout->usable = size_;
      layout->usable_step = seen->misses_some() ? 1 : 0;
      size_ += seen->misses_some() ? seen->usable.size() : 1;
      if (!seen->chain.empty()) layout->width = seen->measured.size() / seen->chain.size();
    }
    for (const TermNumbers& term : first.terms) {
      factors_.push_back(term.factors.empty() ? kNone : reserve(term.factors));
      conditions_.push_back(reserve(term.conditions));
    }
  }

  /// Adds a sample.
  /// @param sample  its index in the problem
  void add(int sample, const SampleNumbers& seen) {
    const int lane = static_cast<int>(samples_.size() % kLanes<S>);
    if (lane == 0) numbers_.resize(numbers_.size() + size_);
    S* const batch = numbers_.data() + (numbers_.size() - size_);
    samples_.push_back(sample);
    for (std::size_t s = 0; s < seen.sensors.size(); ++s) {
      if (!seen.sensors[s]) continue;
      const ObservationNumbers* of_sensor = &*seen.sensors[s];
      const ObservationLayout& layout = *layouts_[s];
      for (std::size_t c = 0; c < layout.joints.size(); ++c) {
        if (of_sensor->joints[c]) set(*of_sensor->joints[c], lane, batch + layout.joints[c]);
      }
      set(of_sensor->settings, lane, batch + layout.settings);
      set(of_sensor->measured, lane, batch + layout.measured);
      for (std::size_t i = 0; i < layout.chain.size(); ++i) {
        S& usable = batch[layout.usable + i * layout.usable_step];
        if (lane == 0) usable = S(0.0);
        set_lane(usable, lane, of_sensor->usable[i]);
      }
    }
    for (std::size_t t = 0; t < seen.terms.size(); ++t) {
      if (factors_[t] != kNone) set(seen.terms[t].factors, lane, batch + factors_[t]);
      set(seen.terms[t].conditions, lane, batch + conditions_[t]);
    }
  }

  /// Indices of the terms that apply.
  [[nodiscard]] const std::vector<int>& terms() const { return terms_; }
  /// Number of batches.
  [[nodiscard]] std::size_t size() const {
    return numbers_.size() / std::max<std::size_t>(size_, 1);
  }
  /// Indices in the problem of the samples of a batch, by lane.
  [[nodiscard]] std::span<const int> samples(std::size_t batch) const {
    const std::size_t first = batch * kLanes<S>;
    return std::span(samples_).subspan(first,
                                       std::min<std::size_t>(kLanes<S>, samples_.size() - first));
  }
  /// True if a sensor observed something.
  [[nodiscard]] bool has(std::size_t sensor) const { return layouts_[sensor].has_value(); }
  /// The numbers of a batch; empty if there is no such batch.
  [[nodiscard]] std::span<const S> numbers(std::size_t batch) const {
    return batch < size() ? std::span(numbers_).subspan(batch * size_, size_)
                          : std::span<const S>();
  }
  /// What a sensor observed in the samples of a batch.
  [[nodiscard]] BatchObservation<S> observation(std::size_t batch, std::size_t sensor) const {
    return {numbers_.data() + batch * size_, &*layouts_[sensor]};
  }
  /// What a term takes of the samples of a batch.
  /// @param i  place of the term in terms()
  [[nodiscard]] BatchTerm<S> of_term(std::size_t batch, std::size_t i) const {
    const S* numbers = numbers_.data() + batch * size_;
    return {factors_[i] == kNone ? nullptr : numbers + factors_[i], numbers + conditions_[i]};
  }

 private:
  static constexpr std::size_t kNone = static_cast<std::size_t>(-1);

  [[nodiscard]] std::size_t reserve(const std::vector<double>& numbers) {
    const std::size_t first = size_;
    size_ += numbers.size();
    return first;
  }
  /// Sets a lane; the first one sets all.
  static void set(const std::vector<double>& from, int lane, S* to) {
    for (const double number : from) {
      if (lane == 0) {
        *to++ = S(number);
      } else {
        set_lane(*to++, lane, number);
      }
    }
  }

  std::vector<int> terms_;
  std::vector<std::optional<ObservationLayout>> layouts_;  ///< by sensor
  std::vector<std::size_t> factors_;                       ///< of each term: first number, or kNone
  std::vector<std::size_t> conditions_;                    ///< of each term: first number
  std::size_t size_ = 0;                                   ///< numbers of a batch
  std::vector<S> numbers_;                                 ///< of all batches
  std::vector<int> samples_;                               ///< of all batches, by lane
};

}  // namespace kinecal::detail
