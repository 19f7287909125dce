// What to do next: one line that works when it is pasted.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "kinecal/text/shell_command.hpp"

namespace kinecal {

struct Findings;

/// How the program was called; empty in a program of one's own.
struct ProgramCall {
  ShellCommand command = {};  ///< kinecal calibrate --urdf robot.urdf ...
  ShellCommand inputs = {};   ///< --urdf robot.urdf --config calibrate.yaml --samples a.yaml
  std::string output = {};    ///< folder of the results; empty: none are written
  std::string version = {};   ///< of the program
  std::vector<std::pair<std::string, std::string>> files =
      {};  ///< role ("URDF", "configuration", "samples",
           ///< "camera") and name of each that was read
};

/// What answers the verdict: holding what samples do not determine or support, recording more poses, looking at
/// the residuals; for a good result, checking it with a few new poses.
[[nodiscard]] std::string next_step(const Findings& findings);

}  // namespace kinecal
