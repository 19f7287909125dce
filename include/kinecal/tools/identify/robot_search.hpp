// A search for what is wrong with a robot, of a configuration: identify() with names, and as text.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <span>
#include <string>
#include <vector>

#include "kinecal/config/config.hpp"
#include "kinecal/kinematics/robot.hpp"
#include "kinecal/report/reported_search.hpp"
#include "kinecal/samples/sample.hpp"
#include "kinecal/tools/identify/identified_config.hpp"

namespace kinecal {

/// What was searched and found.
struct RobotSearch {
  IdentifyTask task;
  Identified found;
  Config config;       ///< that frees what was found
  std::string mounts;  ///< how mounts change that are free from the beginning, a sentence each
};

/// What a search leaves out.
struct SearchLimits {
  bool geometry_only = false;          ///< no joint models, which a URDF cannot hold
  std::vector<std::string> hold = {};  ///< parameters, frames or candidates that keep their values
};

/// Searches for the parameters that samples support.
/// @param config  of one step: its models, error blocks and unknown poses are kept
/// @throws InputError             if there are several steps, a name to hold is unknown, or all candidates together
///                                cannot be assembled
/// @throws std::invalid_argument  as identify()
[[nodiscard]] RobotSearch search_robot(const Config& config, const Robot& robot,
                                       std::span<const Sample> samples,
                                       const SearchLimits& limits = {});

/// The steps for a report.
[[nodiscard]] ReportedSearch reported(const RobotSearch& search);

/// The steps as a table, zeros that are a quarter turn off before it, and below it what would explain the same.
[[nodiscard]] std::string search_text(const RobotSearch& search);

/// Comments for config_to_yaml(): what each parameter bought on poses held out.
[[nodiscard]] std::map<std::string, std::string> search_comments(const RobotSearch& search);

}  // namespace kinecal
