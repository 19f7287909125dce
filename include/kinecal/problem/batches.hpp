// Samples packed for evaluation: one sample per lane of a packet.
//
// A sample is prepared once, as a row of numbers: sine and cosine of its joints, measurements in
// the form the sensors need.  Samples of one layout share batches, one lane each: a structure of
// arrays. (Same layout: the same sensors observed the same number of features in the same frames,
// and the same terms apply.)  All batches of a layout are contiguous in memory.  A lane without a
// sample repeats the first one, a NaN feature another one; both are not present: they count zero
// times.  So one code path evaluates everything, without a remainder loop.
// Source: ARCHITECTURE.md, ideas 4 (no trigonometry in the loop) and 5 (packets over samples).
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <span>
#include <utility>
#include <vector>

#include "kinecal/geometry/packet.hpp"
#include "kinecal/kinematics/joint_state.hpp"
#include "kinecal/problem/sample_layout.hpp"

namespace kinecal::detail {

/// The joint states of a chain in a batch, by index of the joint.
/// @tparam kModels  some joint of the chain has parameters of joint models
template <class S, bool kModels>
struct JointStates {
  /// Of each joint: cosine and sine if it rotates, else position and an unused number; with models,
  /// then the effects of their parameters.  MountedSensor::joints() writes them.
  const S* numbers;
  std::size_t num_effects = 0;  ///< of each joint

  /// The state of a joint; position is valid only for a sliding joint.
  [[nodiscard]] JointState<S> operator[](std::size_t joint) const {
    const S* of_joint = numbers + stride() * joint;
    return {of_joint[0], of_joint[0], of_joint[1]};
  }
  /// The effects of the parameters of a joint's models.
  [[nodiscard]] const S* effects(std::size_t joint) const requires kModels {
    return numbers + stride() * joint + 2;
  }

 private:
  [[nodiscard]] std::size_t stride() const { return kModels ? 2 + num_effects : 2; }
};

/// What one sensor observed in the samples of a batch.
template <class S>
struct BatchObservation {
  const S* numbers = nullptr;                 ///< of the batch
  const ObservationLayout* layout = nullptr;  ///< offsets of this sensor's numbers

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
    return layout->joints[chain] != kAbsent;
  }
  /// The numbers of JointStates of a chain that leads to a feature.
  [[nodiscard]] const S* joints(std::size_t chain) const { return numbers + layout->joints[chain]; }
};

/// All samples of one layout.
template <class S>
class Batches {
 public:
  explicit Batches(SampleLayout layout) : layout_(std::move(layout)) {}

  /// Adds a sample.
  /// @param sample  its index in the problem
  /// @param row     its numbers, of this layout
  void add(int sample, std::span<const double> row) {
    const int lane = static_cast<int>(samples_.size() % kLanes<S>);
    samples_.push_back(sample);
    if (lane > 0) {
      S* const batch = numbers_.data() + (numbers_.size() - row.size());
      for (std::size_t i = 0; i < row.size(); ++i) set_lane(batch[i], lane, row[i]);
      return;
    }
    for (const double number : row) numbers_.push_back(S(number));  // in all lanes
    S* const batch = numbers_.data() + (numbers_.size() - row.size());
    for (const auto& seen : layout_.sensors) {
      for (std::size_t i = 0; seen && i < seen->chain.size(); ++i) {
        const std::size_t usable = seen->usable + i * seen->usable_step;
        batch[usable] = S(0.0);
        set_lane(batch[usable], 0, row[usable]);
      }
    }
  }

  /// The same samples with other numbers, without some of them.
  /// @param numbers  of each sample of the problem: its new number, or -1 to leave it out
  [[nodiscard]] Batches renumbered(std::span<const int> numbers) const {
    Batches kept(layout_);
    for (std::size_t i = 0; i < samples_.size(); ++i) {
      const int number = numbers[static_cast<std::size_t>(samples_[i])];
      if (number >= 0) kept.add(number, row(i));
    }
    return kept;
  }

  /// The numbers of a sample.
  /// @param row  of the sample, in the order in which they were added
  [[nodiscard]] std::vector<double> row(std::size_t row) const {
    const S* const batch = numbers_.data() + row / kLanes<S> * layout_.size;
    std::vector<double> numbers(layout_.size);
    for (std::size_t k = 0; k < numbers.size(); ++k) {
      numbers[k] = lane(batch[k], static_cast<int>(row % kLanes<S>));
    }
    return numbers;
  }

  /// Changes a number of a sample.
  /// @param row     of the sample, in the order in which they were added
  /// @param offset  of the number
  void set(std::size_t row, std::size_t offset, double number) {
    S* const batch = numbers_.data() + row / kLanes<S> * layout_.size;
    const bool alone = row % kLanes<S> == 0 && row + 1 == samples_.size();
    if (alone) batch[offset] = S(number);  // lanes without a sample repeat it
    set_lane(batch[offset], static_cast<int>(row % kLanes<S>), number);
  }
  /// Index in the problem of the sample of a row.
  [[nodiscard]] int sample(std::size_t row) const { return samples_[row]; }

  /// Number of samples.
  [[nodiscard]] int num_samples() const { return static_cast<int>(samples_.size()); }
  /// What the numbers of a batch are.
  [[nodiscard]] const SampleLayout& layout() const { return layout_; }
  /// Number of batches; zero if no term uses the samples.
  [[nodiscard]] std::size_t size() const {
    return layout_.size == 0 ? 0 : numbers_.size() / layout_.size;
  }
  /// Indices in the problem of the samples of a batch, by lane.
  [[nodiscard]] std::span<const int> samples(std::size_t batch) const {
    const std::size_t first = batch * kLanes<S>;
    return std::span(samples_).subspan(first,
                                       std::min<std::size_t>(kLanes<S>, samples_.size() - first));
  }
  /// The numbers of a batch; empty if there is no such batch.
  [[nodiscard]] std::span<const S> numbers(std::size_t batch) const {
    return batch < size() ? std::span(numbers_).subspan(batch * layout_.size, layout_.size)
                          : std::span<const S>();
  }
  /// The observations of one sensor in a batch.
  [[nodiscard]] BatchObservation<S> observation(std::size_t batch, std::size_t sensor) const {
    return {numbers_.data() + batch * layout_.size, &*layout_.sensors[sensor]};
  }
  /// Numbers of a term in a batch: TermLayout::inverse_sigmas or conditions; nullptr: it has none.
  [[nodiscard]] const S* of_term(std::size_t batch, std::size_t offset) const {
    return offset == kAbsent ? nullptr : numbers_.data() + batch * layout_.size + offset;
  }

 private:
  SampleLayout layout_;
  std::vector<S> numbers_;    ///< of all batches
  std::vector<int> samples_;  ///< of all batches, by lane
};

}  // namespace kinecal::detail
