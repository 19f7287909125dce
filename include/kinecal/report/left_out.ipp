// Samples that the result does not use, evaluated beside the others, so that they can be shown.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "kinecal/problem/any_problem.hpp"

namespace kinecal::detail {

/// A problem with the samples used, then those left out.
class ProblemWithLeftOut {
 public:
  /// @param samples   of the problem, in their order
  /// @param left_out  samples that were taken out of it
  ProblemWithLeftOut(const AnyProblem& problem, std::span<const Sample> samples,
                     std::span<const Sample> left_out)
      : problem_(&problem), samples_(samples) {
    if (left_out.empty()) return;
    all_.assign(samples.begin(), samples.end());
    all_.insert(all_.end(), left_out.begin(), left_out.end());
    samples_ = all_;
    larger_ = problem.without_samples();
    for (const Sample& sample : all_) larger_->add_sample(sample);
    problem_ = larger_.get();
  }

  [[nodiscard]] const AnyProblem& problem() const { return *problem_; }
  /// In the order of the problem.
  [[nodiscard]] std::span<const Sample> samples() const { return samples_; }

 private:
  const AnyProblem* problem_;
  std::span<const Sample> samples_;
  std::vector<Sample> all_;
  std::unique_ptr<AnyProblem> larger_;
};

}  // namespace kinecal::detail
