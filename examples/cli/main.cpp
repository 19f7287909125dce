// kinecal: calibrates robots from a URDF, a configuration and recorded samples.
//
// Called by the name of a program of robot_calibration, it stands for that: upstream.hpp.
// SPDX-License-Identifier: Apache-2.0
#include <string>
#include <vector>

#include "kinecal/program.hpp"
#include "upstream.hpp"

int main(int argc, char** argv) {
  const std::string called = argc > 0 ? argv[0] : "";
  const std::string name = called.substr(called.rfind('/') + 1);  // npos + 1 is 0
  if (!kinecal::cli::is_upstream(name)) return kinecal::run_program(argc, argv);
  return kinecal::cli::run_as_upstream(name, std::vector<std::string>(argv + 1, argv + argc));
}
