// SPDX-License-Identifier: Apache-2.0
#include "scene.hpp"

#include <fmt/core.h>

#include <sstream>

#include "kinecal/files/bags/mcap/write_mcap.hpp"
#include "kinecal/files/results/file_set.hpp"
#include "kinecal/files/urdf/visuals.hpp"
#include "kinecal/report/scene_mcap.hpp"
#include "kinecal/report/scene_meshes.hpp"
#include "output_file.hpp"
#include "terminal.hpp"

namespace kinecal::cli {

RobotScene scene_of(const CalibratedRobot& calibrated, const std::vector<std::string>& mesh_paths,
                    const SceneLimits& limits) {
  RobotScene scene = robot_scene(calibrated.setup.calibration, calibrated, calibrated.samples,
                                 limits, calibrated.left_out_samples);
  Diagnostics diagnostics;
  add_visuals(visuals(calibrated.setup.urdf_text, calibrated.setup.urdf, diagnostics),
              mesh_places(calibrated.setup.urdf, mesh_paths), calibrated.setup.urdf, scene,
              diagnostics);
  print(diagnostics);
  return scene;
}

void write_scene_file(const std::string& file, const CalibratedRobot& calibrated,
                      const std::vector<std::string>& mesh_paths) {
  // Each sample takes 10 to 100 kB.
  const RobotScene scene = scene_of(calibrated, mesh_paths, {.samples = 1000, .features = 100000});
  std::ostringstream bytes;
  write_scene(scene, bytes, best_mcap_compression());
  write_output(file, bytes.str());
  say(stderr, "wrote {}{}\n", file, scene.thinned.empty() ? "" : ": " + scene.thinned);
}

}  // namespace kinecal::cli
