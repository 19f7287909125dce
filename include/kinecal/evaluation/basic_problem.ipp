// Definitions of basic_problem.hpp and of all that evaluates it, for a scalar S.  The library has compiled them
// for packets; include this for another scalar, such as double: one sample at a time.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/evaluation/basic_problem.hpp"
#include "kinecal/evaluation/evaluator.ipp"
#include "kinecal/evaluation/sample_poses.ipp"
#include "kinecal/evaluation/sums/feature_wrenches.ipp"
#include "kinecal/evaluation/sums/local_sums.ipp"
#include "kinecal/evaluation/sums/point_wrenches.ipp"
#include "kinecal/evaluation/views/sensor_view.ipp"

namespace kinecal {

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
  for (const SampledChain& chain : sensors().back().chains()) {  // in the order of the chains
    const auto walk = std::find_if(walks.begin(), walks.end(),
                                   [&](const auto& w) { return w.tip == chain.chain().tip; });
    if (walk == walks.end()) return;
    evaluations_.back().walks.push_back(*walk);
  }
}

template <class S>
void BasicProblem<S>::add_to_batch(std::size_t index, const detail::SampleLayout& layout,
                                   std::span<const double> numbers) {
  if (index == batches_.size()) batches_.emplace_back(layout);
  batches_[index].add(num_samples(), numbers);
}

template <class S>
std::vector<double> BasicProblem<S>::row_in_batches(std::size_t index, std::size_t row) const {
  return batches_[index].row(row);
}

template <class S>
void BasicProblem<S>::set_in_batches(std::size_t index, std::size_t row, std::size_t offset,
                                     double number) {
  batches_[index].set(row, offset, number);
}

template <class S>
void BasicProblem<S>::renumber_in_batches(std::span<const int> numbers) {
  for (detail::Batches<S>& batches : batches_) batches = batches.renumbered(numbers);
}

template <class S>
std::unique_ptr<AnyProblem> BasicProblem<S>::without_samples() const {
  return std::make_unique<BasicProblem>(*this, AnyProblem::WithoutSamples{});
}

template <class S>
std::unique_ptr<AnyEvaluator> BasicProblem<S>::evaluator(const FreeSet& free, int threads,
                                                         std::span<const int> terms) const {
  if (sample_poses().empty()) return std::make_unique<Evaluator<S>>(*this, free, threads, terms);
  if (!terms.empty()) {
    throw std::invalid_argument("evaluator: samples with poses of their own need all error blocks");
  }
  return std::make_unique<SamplePosesEvaluator<S>>(*this, free);
}

}  // namespace kinecal
