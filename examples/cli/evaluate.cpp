// kinecal evaluate: how a result fits other samples.
// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "commands.hpp"
#include "input.hpp"
#include "kinecal/files/json/json_text.hpp"
#include "kinecal/files/results/file_set.hpp"
#include "kinecal/text/counted.hpp"
#include "kinecal/text/reading.hpp"
#include "new_samples.hpp"
#include "output_file.hpp"

namespace kinecal::cli {
namespace {

std::string json(const StoredResult& result, const NewSamples& fresh) {
  return detail::json_lines({{"result", result.folder},
                             {"verdict", result.verdict},
                             {"samples", fresh.samples.size()},
                             {"assumed", fresh.assumed},
                             {"off_robot", fresh.off_robot},
                             {"error_blocks", fit_json(result, fresh)}});
}

/// "worse: hand_eye 0.194 mm -> 255.7 mm", by more than samples of a few poses scatter; else "as good: ..."
std::string change_line(const std::vector<FitChange>& changes) {
  constexpr double kWorse = 1.5;
  std::string worse, as_good;
  for (const FitChange& change : changes) {
    std::string& text = change.times() > kWorse ? worse : as_good;
    text += fmt::format("{}{} {} -> {}", text.empty() ? "" : ", ", change.block,
                        reading(change.then, change.unit), reading(change.now, change.unit));
  }
  return (worse.empty() ? "as good: " + as_good : "worse: " + worse) + "\n";
}

}  // namespace

int evaluate(const RecheckOptions& options) {
  const StoredResult result = read_result(options.result);
  if (!options.report.empty()) check_json(options.report, options.samples);
  const NewSamples fresh = read_new_samples(result, {.samples = options.samples,
                                                     .cameras = options.cameras,
                                                     .recorded = options.recorded,
                                                     .mesh_paths = options.mesh_paths});
  print(fresh.diagnostics);
  if (!fresh.diagnostics.errors.empty()) return kBadInput;
  std::string text = fmt::format("Result {} ({}) on {}; nothing is solved\n", result.folder,
                                 result.verdict, counted(fresh.samples.size(), "sample"));
  if (!fresh.assumed.empty()) text += fresh.assumed + "\n";
  text += "\n" + fit_text(result, fresh) + "\n" + worst_text(result, fresh);
  const std::vector<FitChange> changes = fit_changes(result, fresh);
  if (!changes.empty()) text += "\n" + change_line(changes);
  for (const std::string& off : fresh.off_robot) text += "worse: " + off + "\n";
  show(text, options.manner);
  if (!options.report.empty()) write_output(options.report, json(result, fresh));
  const bool is_worse = std::any_of(changes.begin(), changes.end(), [&](const FitChange& change) {
    return !(change.times() <= options.fail_above);
  });
  const bool fails = options.fail_above > 0.0 && (is_worse || !fresh.off_robot.empty());
  return fails ? kNotUsable : kDone;
}

}  // namespace kinecal::cli
