// Definitions of set_camera.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/files/cameras/set_camera.hpp"

#include <fmt/format.h>

#include <set>

#include "kinecal/files/cameras/read_camera_file.hpp"
#include "kinecal/text/nearest_name.hpp"

namespace kinecal {

void set_camera(std::vector<Sample>& samples, const std::string& argument,
                Diagnostics& diagnostics) {
  const std::size_t equals = argument.find('=');
  if (equals == std::string::npos || equals == 0) {
    throw InputError("camera '" + argument + "': is not NAME=FILE");
  }
  const std::string name = argument.substr(0, equals), file = argument.substr(equals + 1);
  const CameraInfo camera = read_camera_argument(file, diagnostics);
  std::set<std::string> sensors;
  std::size_t seen = 0, set = 0;
  for (Sample& sample : samples) {
    for (Observation& observation : sample.observations) {
      sensors.insert(observation.sensor);
      if (observation.sensor != name) continue;
      ++seen;
      const bool is_known = observation.camera &&
                            (observation.camera->k[0] != 0.0 || observation.camera->p[0] != 0.0);
      if (is_known) continue;  // a photograph has the size of its image alone
      observation.camera = camera;
      ++set;
    }
  }
  if (seen == 0 && !samples.empty()) {
    diagnostics.errors.push_back("camera '" + argument + "': no sample has a sensor '" + name +
                                 "'" + did_you_mean(name, sensors));
  } else if (set < seen) {
    diagnostics.warnings.push_back(
        fmt::format("camera '{}': {} of {} samples have a camera_info already and keep it",
                    argument, seen - set, seen));
  }
}

}  // namespace kinecal
