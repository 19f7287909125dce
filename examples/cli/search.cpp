// SPDX-License-Identifier: Apache-2.0
#include "search.hpp"

#include <fmt/core.h>

#include "kinecal/config/config_to_yaml.hpp"
#include "kinecal/text/counted.hpp"
#include "kinecal/tools/identify/open_config.hpp"

namespace kinecal::cli {

std::string search_summary(const CalibratedRobot& calibrated) {
  const RobotSearch& search = *calibrated.robot_search;
  const std::string begin =
      fmt::format("Robot '{}', {}: {} may be wrong, ", calibrated.setup.robot.name(),
                  counted(calibrated.setup.samples.size(), "sample"),
                  counted(search.task.candidates.size(), "parameter"));
  if (search.found.chosen.empty()) {
    return begin + "these samples support none of them" +
           (found_nothing(calibrated) ? ": nothing is freed" : ": only unknown poses are freed") +
           "\n\n" + search_text(search);
  }
  return begin + fmt::format("{} of them these samples support\n\n", search.found.chosen.size()) +
         search_text(search);
}

std::string found_config(const CalibratedRobot& calibrated) {
  if (!calibrated.robot_search) return {};
  return config_to_yaml(
      calibrated.robot_search->config,
      "What these samples support; 'kinecal identify' found it.  With each parameter, the\n"
      "error on poses held out before and after it was freed.",
      search_comments(*calibrated.robot_search));
}

bool found_nothing(const CalibratedRobot& calibrated) {
  return calibrated.robot_search && frees_nothing(calibrated.robot_search->config);
}

}  // namespace kinecal::cli
