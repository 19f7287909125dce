// SPDX-License-Identifier: Apache-2.0
#include "search.hpp"

#include <fmt/core.h>

#include <span>
#include <utility>

#include "kinecal/config/config_to_yaml.hpp"
#include "kinecal/text/counted.hpp"
#include "kinecal/tools/identify/another_robot.hpp"
#include "kinecal/tools/identify/open_config.hpp"

namespace kinecal::cli {

bool SearchedFit::is_empty() const {
  return frees_nothing(search.config);
}

SearchedFit search_and_fit(Input& input, const CalibrateOptions& options, bool geometry_only,
                           const Progress& progress, const SolveOptions& solving) {
  const Config open = input.config;
  const Diagnostics before = std::exchange(input.diagnostics, {});
  SearchedFit all;
  const auto run = [&](std::span<const Sample> samples) {
    all.search = search_robot(open, input.robot, samples, {geometry_only, options.hold});
    input.config = all.search.config;
    if (all.is_empty()) return;
    input.diagnostics = {};
    input.diagnostics.doubts = before.doubts;
    input.diagnostics.refutable = before.refutable;
    assemble_input(input, options);
    input.diagnostics.throw_if_errors();
    all.fit = fit(input, std::move(input.calibration), options, progress, solving);
  };
  run(input.samples);
  if (!all.fit.findings.left_out.empty()) {  // again, without bad samples
    run(used_samples(all.fit.findings, input.samples));
  }
  all.fit.findings.search = reported(all.search);
  if (const std::string why = another_robot(all.search); !why.empty()) {
    all.fit.findings.judgement.add_causes(Grade::do_not_use, {why});
  }
  all.config = config_to_yaml(
      all.search.config,
      "What these samples support; 'kinecal identify' found it.  With each parameter, the\n"
      "error on poses held out before and after it was freed.",
      search_comments(all.search));
  return all;
}

std::string search_summary(const SearchedFit& searched, const Input& input) {
  const RobotSearch& search = searched.search;
  const std::string begin = fmt::format("Robot '{}', {}: {} may be wrong, ", input.robot.name(),
                                        counted(input.samples.size(), "sample"),
                                        counted(search.task.candidates.size(), "parameter"));
  if (search.found.chosen.empty()) {
    return begin + "these samples support none of them" +
           (searched.is_empty() ? ": nothing is freed" : ": only unknown poses are freed") +
           "\n\n" + search_text(search);
  }
  return begin + fmt::format("{} of them these samples support\n\n", search.found.chosen.size()) +
         search_text(search);
}

}  // namespace kinecal::cli
