// SPDX-License-Identifier: Apache-2.0
#include "scene.hpp"

#include <fmt/core.h>

#include <sstream>

#include "input.hpp"
#include "kinecal/files/bags/mcap/write_mcap.hpp"
#include "kinecal/files/results/file_set.hpp"
#include "kinecal/procedure/calibrated_page.hpp"
#include "kinecal/report/scene_mcap.hpp"
#include "output_file.hpp"
#include "terminal.hpp"

namespace kinecal::cli {

void write_scene_file(const std::string& file, const CalibratedRobot& calibrated,
                      const std::vector<std::string>& mesh_paths) {
  // Each sample takes 10 to 100 kB.
  Diagnostics diagnostics;
  const RobotScene scene =
      calibrated_scene(calibrated, mesh_paths, diagnostics, {.samples = 1000, .features = 100000});
  print(diagnostics);
  std::ostringstream bytes;
  write_scene(scene, bytes, best_mcap_compression());
  write_output(file, bytes.str());
  say(stderr, "wrote {}{}\n", file, scene.thinned.empty() ? "" : ": " + scene.thinned);
}

}  // namespace kinecal::cli
