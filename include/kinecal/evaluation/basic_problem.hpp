// A calibration problem with its samples in batches, for evaluation in any scalar.  Include
// basic_problem.ipp to evaluate in another scalar than packets, such as double.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdexcept>

#include "kinecal/errors/block_checks.hpp"
#include "kinecal/evaluation/block_term.hpp"
#include "kinecal/evaluation/evaluator.hpp"
#include "kinecal/problem/any_problem.hpp"
#include "kinecal/sensors/sensor_checks.hpp"

namespace kinecal {

/// A calibration problem.  Add sensors, then error blocks and priors, then samples.
/// @tparam S  scalar of the evaluation: a packet, or double for one sample at a time
template <class S>
class BasicProblem final : public AnyProblem {
 public:
  using AnyProblem::AnyProblem;
  /// For without_samples().
  BasicProblem(const BasicProblem& other, AnyProblem::WithoutSamples without)
      : AnyProblem(other, without), evaluations_(other.evaluations_), codes_(other.codes_) {}

  /// Adds a sensor.  Its parameters must be in the table (add_sensor_parameters()): one that is not counts as
  /// zero, not as its initial value.
  /// @param walks  compiled walks along its chains, if any
  /// @throws  as AnyProblem::add_built_in()
  template <class M>
  void add_sensor(const M& sensor, const Mount& mount,
                  const std::vector<detail::CompiledWalk<S>>& walks = {}) {
    [[maybe_unused]] const detail::CheckSensorType<M> check_of_type{};
    if constexpr (detail::kIsOneOf<M, BuiltInSensor>) {
      add_built_in(sensor, mount);
    } else if constexpr (Sensor<M>) {
      add_sensor_of_type(sensor, mount);
    }
    set_walks(walks);
  }
  /// The same for a built-in sensor, which the library has compiled.
  void add_built_in(const BuiltInSensor& sensor, const Mount& mount) override;

  /// Adds an error block between sensors that have been added.
  /// @throws  as AnyProblem::add_built_in()
  template <class B>
  void add_block(const std::string& name, const B& block, const std::vector<std::string>& sensors,
                 const TermOptions& options = {}) {
    [[maybe_unused]] const detail::CheckErrorBlock<B> check_of_type{};
    if constexpr (detail::kIsOneOf<B, BuiltInBlock>) {
      add_built_in(name, block, sensors, options);
    } else if constexpr (ErrorBlock<B>) {
      add_block_of_type(name, block, sensors, options);
    }
  }
  /// The same for a built-in block, which the library has compiled.
  void add_built_in(const std::string& name, const BuiltInBlock& block,
                    const std::vector<std::string>& sensors, const TermOptions& options) override;

  /// The code that evaluates the term of an error block.
  [[nodiscard]] const detail::TermCode<S>& code(int term) const {
    return *codes_[static_cast<std::size_t>(term)];
  }
  /// The code that evaluates a sensor.
  [[nodiscard]] const detail::SensorEvaluation<S>& evaluation_of(std::size_t sensor) const {
    return evaluations_[sensor];
  }
  /// The samples, by layout.
  [[nodiscard]] const std::vector<detail::Batches<S>>& batches() const { return batches_; }

  [[nodiscard]] std::unique_ptr<AnyEvaluator> evaluator(
      const FreeSet& free, int threads = 0, std::span<const int> terms = {}) const override;
  [[nodiscard]] std::unique_ptr<AnyProblem> without_samples() const override;

 private:
  template <class M>
  void add_sensor_of_type(const M& sensor, const Mount& mount) {
    this->mount(detail::behind_interface(sensor), mount);
    evaluations_.push_back({std::make_shared<const detail::SensorCodeOf<M, S>>(sensor), {}});
  }
  template <class B>
  void add_block_of_type(const std::string& name, const B& block,
                         const std::vector<std::string>& sensors, const TermOptions& options) {
    TermOptions complete = options;
    if constexpr (requires { B::kType; }) {
      if (complete.type.empty()) complete.type = B::kType;
    }
    if constexpr (requires { B::kUnit; }) {
      if (complete.unit.empty()) complete.unit = B::kUnit;
    }
    if (complete.type.empty()) complete.type = name;
    if (complete.unit.empty()) {
      throw std::invalid_argument(
          "error block '" + name + "': its residual has no unit; write in it, for " +
          "metres: static constexpr const char* kUnit = \"m\";  (or \"px\", \"1\")");
    }
    Term term{.name = name,
              .options = std::move(complete),
              .quantities = kQuantities<B>,
              .conditions = kConditionsOfBlock<B>,
              .feature_size = kResiduals<B>};
    if constexpr (ScaledPoseBlock<B>) {
      term.pose_scales = {block.translation_scale, block.rotation_scale};
    }
    add_term(std::move(term), sensors, parameters_of(block));
    codes_.push_back(std::make_shared<const detail::BlockTerm<B, S>>(block));
  }
  void set_walks(const std::vector<detail::CompiledWalk<S>>& walks);
  void add_to_batch(std::size_t index, const detail::SampleLayout& layout,
                    std::span<const double> numbers) override;
  [[nodiscard]] std::vector<double> row_in_batches(std::size_t index,
                                                   std::size_t row) const override;
  void set_in_batches(std::size_t index, std::size_t row, std::size_t offset,
                      double number) override;
  void renumber_in_batches(std::span<const int> numbers) override;

  std::vector<detail::SensorEvaluation<S>> evaluations_;           ///< of each sensor
  std::vector<std::shared_ptr<const detail::TermCode<S>>> codes_;  ///< of each term
  std::vector<detail::Batches<S>> batches_;                        ///< by layout
};

}  // namespace kinecal

#ifdef KINECAL_HEADER_ONLY
#include "kinecal/evaluation/basic_problem.ipp"
#endif
