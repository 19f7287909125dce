// Adds the error blocks of a step to a problem.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <span>
#include <stdexcept>
#include <string>

#include "kinecal/config/config.hpp"
#include "kinecal/config/loss_names.hpp"
#include "kinecal/config/registry.hpp"
#include "kinecal/problem/any_problem.hpp"
#include "kinecal/samples/sample.hpp"

namespace kinecal::detail {

/// Numbers of samples in which a block's first model observes something: alone, and together with
/// another model of the step.
struct Company {
  int alone = 0, beside = 0;
};
[[nodiscard]] inline Company company_of(const BlockConfig& block, const StepConfig& step,
                                        std::span<const Sample> samples) {
  Company count;
  for (const Sample& sample : samples) {
    const auto observes = [&](const std::string& model) {
      const Observation* seen = sample.observation(model);
      return seen != nullptr && !seen->features.empty();
    };
    if (block.models.empty() || !observes(block.models.front())) continue;
    const bool beside =
        std::any_of(step.models.begin(), step.models.end(), [&](const ModelConfig& model) {
          return model.name != block.models.front() && observes(model.name);
        });
    ++(beside ? count.beside : count.alone);
  }
  return count;
}

/// True if a plane block uses only the samples in which its model observes alone, by default: if
/// there are such samples, points seen together with another model, such as the LEDs of a gripper,
/// are not on the plane.
[[nodiscard]] inline bool is_exclusive_by_default(const BlockConfig& block, const StepConfig& step,
                                                  std::span<const Sample> samples) {
  if (block.type != "chain3d_to_plane" || block.exclusive || !block.ground.empty()) return false;
  const Company count = company_of(block, step, samples);
  return count.alone > 0 && count.beside > 0;
}

/// @throws std::exception  if the block's numbers are impossible or its sensors do not match
inline void add_block(AnyProblem& problem, const BlockConfig& block, bool exclusive) {
  const BlockEntry* entry = entry_of(block);
  if (entry == nullptr) throw std::invalid_argument("no type '" + block.type + "'");
  TermOptions options;
  options.type = block.type;
  options.unit = entry->unit;
  options.exclusive = exclusive;
  options.beside = block.ground;
  options.loss = {loss_type(block.loss.type), block.loss.scale};
  options.sigma = block.sigma;
  if (const auto scale = block.numbers.find("scale"); scale != block.numbers.end()) {
    options.scale = scale->second;
  }
  entry->add(problem, block, options);
}

}  // namespace kinecal::detail
