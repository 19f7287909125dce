// A calibration problem with its samples packed for evaluation.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/crate/any_problem.hpp"
#include "kinecal/crate/block_term.hpp"
#include "kinecal/crate/evaluator.hpp"
#include "kinecal/crate/sized_block_term.hpp"

namespace kinecal {

/// A calibration problem.  Add sensors, then error blocks and priors, then samples.
/// @tparam S  scalar of the evaluation: a packet, or double for one sample at a time
template <class S>
class BasicProblem final : public AnyProblem {
 public:
  using AnyProblem::AnyProblem;

  /// Adds a sensor.
  /// @param walks  compiled walks along its chains, if there are any
  /// @throws  as AnyProblem::add_sensor()
  void add_sensor(const Sensor& sensor, std::vector<CompiledWalk<S>> walks = {}) {
    AnyProblem::add_sensor(sensor);
    walks_.resize(sensors().size());
    walks_.back() = std::move(walks);
  }

  /// Adds an error block between sensors that have been added.
  /// @tparam Known  KnownSizes of its two bodies, where the compiler knows them
  /// @throws std::invalid_argument  if a sensor does not exist, or their number or kind is wrong
  /// @throws std::logic_error       if samples have been added already
  template <class Known = void, ErrorBlock B>
  void add_block(const std::string& name, const B& block, const std::vector<std::string>& sensors,
                 const TermOptions& options = {}) {
    std::vector<int> indices = sensors_of_block(name, sensors, kSensors<B>, SightBlock<B>);
    if constexpr (PointPairBlock<B> && !std::is_void_v<Known>) {
      terms_.push_back(
          std::make_unique<SizedBlockTerm<B, S, Known>>(name, block, std::move(indices), options));
    } else {
      terms_.push_back(std::make_unique<BlockTerm<B, S>>(name, block, std::move(indices), options));
    }
  }
  /// The same, for a block of the built-in types.
  void add_built_in(const std::string& name, const BuiltInBlock& block,
                    const std::vector<std::string>& sensors, const TermOptions& options) override {
    std::visit([&](const auto& of_type) { add_block(name, of_type, sensors, options); }, block);
  }

  /// The terms of the error blocks, in the order in which blocks were added.
  [[nodiscard]] const std::vector<std::unique_ptr<Term<S>>>& terms() const { return terms_; }
  /// Number of error blocks, without priors.
  [[nodiscard]] int num_terms() const override { return static_cast<int>(terms_.size()); }
  /// The term of an error block.
  [[nodiscard]] const AnyTerm& term(int index) const override {
    return *terms_[static_cast<std::size_t>(index)];
  }
  /// Compiled walks of a sensor, if it has any.
  [[nodiscard]] std::span<const CompiledWalk<S>> walks(std::size_t sensor) const {
    if (sensor >= walks_.size()) return {};
    return walks_[sensor];
  }
  /// The packed samples: one shape per pack.
  [[nodiscard]] std::span<const PackedSample<S>> packs() const { return packs_; }

  [[nodiscard]] std::unique_ptr<AnyEvaluator> evaluator(const FreeSet& free,
                                                        int threads = 1) const override {
    return std::make_unique<Evaluator<S>>(*this, free, threads);
  }

 private:
  void pack_sample(const SampleShape& shape, OfShape& of_shape, const Observations& seen) override {
    if (of_shape.samples > 0 && add_to_pack(packs_[of_shape.open_pack], num_samples(), seen)) {
      return;
    }
    of_shape.open_pack = packs_.size();
    packs_.push_back(make_pack<S>(shape, num_samples(), seen));
  }

  std::vector<std::vector<CompiledWalk<S>>> walks_;  ///< of each sensor, as far as there are any
  std::vector<std::unique_ptr<Term<S>>> terms_;
  std::vector<PackedSample<S>> packs_;
};

/// A problem evaluated in packets as wide as the instruction set it is compiled for.
using Problem = BasicProblem<Packet>;

}  // namespace kinecal

#ifdef KINECAL_HEADER_ONLY
#include "kinecal/crate/problem.ipp"
#else
#include "kinecal/crate/instances.hpp"
#endif
