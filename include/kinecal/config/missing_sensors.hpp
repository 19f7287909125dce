// Models whose sensor is in no sample, and what follows from that: one line for one cause.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <set>
#include <span>
#include <string>
#include <vector>

#include "kinecal/config/config.hpp"
#include "kinecal/config/parameters_from_config.hpp"
#include "kinecal/config/registry.hpp"
#include "kinecal/kinematics/chain.hpp"
#include "kinecal/samples/sample.hpp"
#include "kinecal/text/counted.hpp"
#include "kinecal/text/nearest_name.hpp"

namespace kinecal::detail {

/// "'a', 'b' and 'c'"; after a few, "'a', 'b', 'c' and 9 more parameters"
/// @param most  names to list
[[nodiscard]] std::string quoted_list(const std::vector<std::string>& names, std::size_t most = 100,
                                      const std::string& noun = "name");

/// The models of a step that its error blocks use, and that no sample has an observation of.
struct MissingSensors {
  std::vector<const ModelConfig*> models;
  std::vector<std::string> others;  ///< sensors of the samples that are no model

  [[nodiscard]] bool has(const std::string& model) const;
  /// True if a block compares one of them.
  [[nodiscard]] bool are_in(const BlockConfig& block) const;
};

/// True if an error block of a step compares a model.
[[nodiscard]] bool is_used(const StepConfig& step, const std::string& model);

[[nodiscard]] MissingSensors missing_sensors(const StepConfig& step,
                                             std::span<const Sample> samples);

/// The cause, and what to do.
[[nodiscard]] std::string sentence_of(const MissingSensors& missing);

/// Finds the parameters that have no residual because a sensor is missing.
class Consequences {
 public:
  Consequences(const MissingSensors& missing, const StepConfig& step, const AnyProblem& problem);

  [[nodiscard]] bool contain(const std::string& parameter) const;

 private:
  std::set<std::string> owners_;  ///< joints, frames, sensors, blocks
};

}  // namespace kinecal::detail
