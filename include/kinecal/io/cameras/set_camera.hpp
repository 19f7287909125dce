// A camera for samples that were recorded without one.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <set>
#include <string>
#include <vector>

#include "kinecal/io/cameras/read_camera_file.hpp"
#include "kinecal/kinematics/nearest_name.hpp"
#include "kinecal/samples/sample.hpp"

namespace kinecal {

/// Gives a sensor's observations a camera where they have none; what was recorded stays.
/// @param argument     "NAME=FILE" or, of a file with several cameras, "NAME=FILE:cam1"
/// @param diagnostics  is added an error if no sample has the sensor, a warning if all have a
///                     camera
/// @throws InputError  if the argument or the file cannot be read
inline void set_camera(std::vector<Sample>& samples, const std::string& argument,
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
      if (observation.camera) continue;
      observation.camera = camera;
      ++set;
    }
  }
  if (seen == 0 && !samples.empty()) {
    diagnostics.errors.push_back("camera '" + argument + "': no sample has a sensor '" + name +
                                 "'" + did_you_mean(name, sensors));
  } else if (set < seen) {
    diagnostics.warnings.push_back(
        fmt::format("camera '{}': {} of {} samples have a camera_info already; it stays", argument,
                    seen - set, seen));
  }
}

}  // namespace kinecal
