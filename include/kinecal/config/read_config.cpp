// Definitions of read_config.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/config/read_config.hpp"

#include <algorithm>
#include <set>
#include <utility>
#include <vector>

#include "kinecal/config/config_dialects.ipp"
#include "kinecal/files/yaml/yaml_document.hpp"

namespace kinecal {

namespace detail {
namespace {

/// Appends messages, each once: steps that share a list report the same errors.
void add_once(std::vector<std::string>& messages, const std::vector<std::string>& more) {
  std::set<std::string> added;
  for (const std::string& message : more) {
    if (added.insert(message).second) messages.push_back(message);
  }
}

}  // namespace
}  // namespace detail

Config read_config(const std::string& path, Diagnostics& diagnostics) {
  return parse_config(detail::read_yaml_text(path), path, diagnostics);
}

Config parse_config(const std::string& text, const std::string& path, Diagnostics& diagnostics,
                    NothingFree nothing_free) {
  detail::ConfigProgress progress;
  progress.nothing_free = nothing_free;
  progress.config.place = {path, 0};
  Diagnostics found;
  const detail::YamlNode content = detail::parse_config_text(text, path, found);
  if (content.is_map()) {
    detail::ConfigMap file(content, {path, 0}, "", found);
    detail::read_dialect(content, file, progress);
  } else {
    found.error({path, 0}, detail::describe_wrong_file(content, "a configuration"));
  }
  const std::vector<StepConfig>& steps = progress.config.steps;
  const auto is_empty = [](const StepConfig& step) { return free_parameters(step).empty(); };
  const bool all_empty = std::all_of(steps.begin(), steps.end(), is_empty);
  for (const StepConfig& step : steps) {  // a search is for all or for none
    if (all_empty || !is_empty(step) || nothing_free != NothingFree::without_lists) continue;
    found.error(step.place, "nothing is free in step '" + step.name +
                                "'; name parameters under 'free_params' or frames under "
                                "'free_frames'");
  }
  detail::add_once(diagnostics.errors, found.errors);
  detail::add_once(diagnostics.warnings, found.warnings);
  return progress.config;
}

}  // namespace kinecal
