// Definitions of open_config.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/tools/identify/open_config.hpp"

#include <algorithm>
#include <string>

#include "kinecal/config/read_config.hpp"
#include "kinecal/tools/identify/candidates.ipp"
#include "kinecal/tools/init/initial_config.hpp"
#include "kinecal/tools/init/several_answers.hpp"

namespace kinecal {

Config config_from_samples(const Robot& robot, std::span<const Sample> samples) {
  std::string text;
  try {
    text = initial_config(robot, all_answers_from_samples(robot, samples, {}));
  } catch (const InputError& error) {
    std::string why = error.what();  // "--arm: ...": of options that only init has
    if (why.starts_with("--")) why.erase(0, why.find(": ") + 2);
    if (why.find("has no camera_info") != std::string::npos) throw InputError(why);
    throw InputError("the samples do not tell what observes what: " + why +
                     "; write a configuration with 'kinecal init' and give --config");
  }
  Diagnostics diagnostics;
  Config config = parse_config(text, "the proposed configuration", diagnostics);
  diagnostics.throw_if_errors();
  for (BlockConfig& block : config.steps.front().error_blocks) block.sigma.reset();
  return config;
}

bool frees_nothing(const Config& config) {
  return std::all_of(config.steps.begin(), config.steps.end(),
                     [](const StepConfig& step) { return free_parameters(step).empty(); });
}

void free_unknown_poses(Config& config, const Robot& robot, std::span<const Sample> samples) {
  Config proposed;
  try {
    proposed = config_from_samples(robot, samples);
  } catch (const InputError&) {
    return;  // it may have all poses; if not, assemble() names what is missing
  }
  StepConfig& step = config.steps.front();
  const auto has = [](const auto& all, const std::string& name) {
    return std::any_of(all.begin(), all.end(), [&](const auto& of) { return of.name == name; });
  };
  for (FreeFrameConfig frame : proposed.steps.front().free_frames) {
    if (!detail::is_base_frame(robot, frame) || has(step.free_frames, frame.name)) continue;
    frame.place = step.place;
    step.free_frames.push_back(frame);
  }
  for (FrameInitialValueConfig value : proposed.steps.front().frame_initial_values) {
    if (!has(step.free_frames, value.name) || has(step.frame_initial_values, value.name)) continue;
    value.place = step.place;
    step.frame_initial_values.push_back(value);
  }
}

}  // namespace kinecal
