// kinecal evaluate: how a result fits other samples.
// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "commands.hpp"
#include "input.hpp"
#include "kinecal/files/json/json_text.hpp"
#include "kinecal/text/counted.hpp"
#include "kinecal/text/printable.hpp"
#include "new_samples.hpp"
#include "output_file.hpp"

namespace kinecal::cli {
namespace {

std::string json(const StoredResult& result, const NewSamples& fresh) {
  return detail::json_lines({{"result", result.folder},
                             {"verdict", result.verdict},
                             {"samples", fresh.samples.size()},
                             {"assumed", fresh.assumed},
                             {"error_blocks", fit_json(result, fresh)}});
}

}  // namespace

int evaluate(const RecheckOptions& options) {
  const StoredResult result = read_result(options.result);
  if (!options.report.empty()) check_output(options.report, options.samples, true);
  const NewSamples fresh =
      read_new_samples(result, {options.samples, options.cameras, options.recorded});
  print(fresh.diagnostics);
  if (!fresh.diagnostics.errors.empty()) return kBadInput;
  std::string text = fmt::format("Result {} ({}) on {}; nothing is solved\n", result.folder,
                                 result.verdict, counted(fresh.samples.size(), "sample"));
  if (!fresh.assumed.empty()) text += fresh.assumed + "\n";
  text += "\n" + fit_text(result, fresh) + "\n" + worst_text(result, fresh);
  fmt::print("{}", printable(text));
  if (!options.report.empty()) write_file(options.report, json(result, fresh));
  return kDone;
}

}  // namespace kinecal::cli
