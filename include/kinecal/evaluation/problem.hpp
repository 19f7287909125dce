// A calibration problem with its samples in batches for evaluation.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/evaluation/block_term.hpp"
#include "kinecal/evaluation/evaluator.hpp"
#include "kinecal/problem/any_problem.hpp"

namespace kinecal {

/// A calibration problem.  Add sensors, then error blocks and priors, then samples.
/// @tparam S  scalar of the evaluation: a packet, or double for one sample at a time
template <class S>
class BasicProblem final : public AnyProblem {
 public:
  using AnyProblem::AnyProblem;

  /// Adds a sensor.
  /// @param walks  compiled walks along its chains, if there are any
  /// @throws  as AnyProblem::add_built_in()
  template <Sensor M>
  void add_sensor(const M& sensor, const Mount& mount,
                  const std::vector<detail::CompiledWalk<S>>& walks = {}) {
    if constexpr (detail::kIsOneOf<M, BuiltInSensor>) {
      add_built_in(sensor, mount);
    } else {
      add_sensor_of_type(sensor, mount);
    }
    set_walks(walks);
  }
  /// The same, for a sensor of the built-in types, which the library has compiled.
  void add_built_in(const BuiltInSensor& sensor, const Mount& mount) override;

  /// Adds an error block between sensors that have been added.
  /// @throws  as AnyProblem::add_built_in()
  template <ErrorBlock B>
  void add_block(const std::string& name, const B& block, const std::vector<std::string>& sensors,
                 const TermOptions& options = {}) {
    if constexpr (detail::kIsOneOf<B, BuiltInBlock>) {
      add_built_in(name, block, sensors, options);
    } else {
      add_block_of_type(name, block, sensors, options);
    }
  }
  /// The same, for a block of the built-in types, which the library has compiled.
  void add_built_in(const std::string& name, const BuiltInBlock& block,
                    const std::vector<std::string>& sensors, const TermOptions& options) override;

  /// The terms of the error blocks, in the order in which blocks were added.
  [[nodiscard]] const std::vector<std::unique_ptr<detail::Term<S>>>& terms() const {
    return terms_;
  }
  /// Number of error blocks, without priors.
  [[nodiscard]] int num_terms() const override { return static_cast<int>(terms_.size()); }
  /// The term of an error block.
  [[nodiscard]] const AnyTerm& term(int index) const override {
    return *terms_[static_cast<std::size_t>(index)];
  }
  /// How a sensor is evaluated.
  [[nodiscard]] const detail::SensorEvaluation<S>& evaluation_of(std::size_t sensor) const {
    return evaluations_[sensor];
  }
  /// The samples, by layout.
  [[nodiscard]] const std::vector<detail::Batches<S>>& batches() const { return batches_; }

  [[nodiscard]] std::unique_ptr<AnyEvaluator> evaluator(const FreeSet& free,
                                                        int threads = 1) const override;

 private:
  template <class M>
  void add_sensor_of_type(const M& sensor, const Mount& mount) {
    this->mount(any_sensor(sensor), mount);
    evaluations_.push_back({std::make_unique<detail::SensorCodeOf<M, S>>(sensor), {}});
  }
  template <class B>
  void add_block_of_type(const std::string& name, const B& block,
                         const std::vector<std::string>& sensors, const TermOptions& options) {
    std::vector<int> indices =
        sensors_of_block(name, sensors, kQuantities<B>, kParametersOfBlock<B>);
    std::vector<int> own;
    if constexpr (kParametersOfBlock < B >> 0) own = parameters_of_block(name, B::kParameters);
    terms_.push_back(std::make_unique<detail::BlockTerm<B, S>>(name, block, std::move(indices),
                                                               std::move(own), options));
  }
  void set_walks(const std::vector<detail::CompiledWalk<S>>& walks);
  void add_to_batch(std::size_t layout, const detail::SampleLayout& of_sample,
                    const detail::SampleNumbers& seen) override;

  std::vector<detail::SensorEvaluation<S>> evaluations_;  ///< of each sensor
  std::vector<std::unique_ptr<detail::Term<S>>> terms_;
  std::vector<detail::Batches<S>> batches_;  ///< by layout
};

// Outside of the class: not inline, so that only instances.hpp compiles them.

template <class S>
void BasicProblem<S>::add_built_in(const BuiltInSensor& sensor, const Mount& mount) {
  std::visit([&](const auto& of_type) { add_sensor_of_type(of_type, mount); }, sensor);
}

template <class S>
void BasicProblem<S>::add_built_in(const std::string& name, const BuiltInBlock& block,
                                   const std::vector<std::string>& sensors,
                                   const TermOptions& options) {
  std::visit([&](const auto& of_type) { add_block_of_type(name, of_type, sensors, options); },
             block);
}

template <class S>
void BasicProblem<S>::set_walks(const std::vector<detail::CompiledWalk<S>>& walks) {
  for (const RuntimeChain& chain : sensors().back().chains()) {  // in the order of the chains
    const auto walk =
        std::find_if(walks.begin(), walks.end(), [&](const auto& w) { return w.tip == chain.tip; });
    if (walk == walks.end()) return;
    evaluations_.back().walks.push_back(*walk);
  }
}

template <class S>
void BasicProblem<S>::add_to_batch(std::size_t layout, const detail::SampleLayout& of_sample,
                                   const detail::SampleNumbers& seen) {
  if (layout == batches_.size()) batches_.emplace_back(of_sample.terms, seen);
  batches_[layout].add(num_samples(), seen);
}

template <class S>
std::unique_ptr<AnyEvaluator> BasicProblem<S>::evaluator(const FreeSet& free, int threads) const {
  return std::make_unique<Evaluator<S>>(*this, free, threads);
}

/// A problem evaluated in packets as wide as the instruction set it is compiled for.
using Problem = BasicProblem<Packet>;

}  // namespace kinecal

#ifdef KINECAL_HEADER_ONLY
#include "kinecal/evaluation/any_evaluator.ipp"
#else
#include "kinecal/evaluation/instances.hpp"
#endif
