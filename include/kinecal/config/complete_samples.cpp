// Definitions of complete_samples.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/config/complete_samples.hpp"

#include "kinecal/config/place_planes.hpp"
#include "kinecal/config/registry.hpp"
#include "kinecal/samples/joint_moves.hpp"

namespace kinecal {

std::set<std::string> looks_before(const Config& config) {
  std::set<std::string> names;
  for (const StepConfig& step : config.steps) {
    for (const BlockConfig& block : step.error_blocks) {
      if (const BlockEntry* entry = entry_of(block)) {
        names.insert(entry->looks_before.begin(), entry->looks_before.end());
      }
    }
  }
  return names;
}

void complete_samples(const Config& config, std::vector<Sample>& samples) {
  if (const std::set<std::string> names = looks_before(config); !names.empty()) {
    set_before(samples, names);
  }
  place_planes(config, samples);
}

}  // namespace kinecal
