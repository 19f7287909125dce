// Errors, motion and faults of a scene file, for read_scene.ipp.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <utility>

#include "kinecal/files/yaml/config_map.ipp"
#include "kinecal/tools/simulation/simulation_plan.hpp"

namespace kinecal::detail {

/// @returns  errors given in the file
[[nodiscard]] inline ParameterTable read_errors(ConfigMap& map, ErrorSizes& errors) {
  ParameterTable given;
  for (const auto& [key, value] : {std::pair{"joint", &errors.joint},
                                   {"sliding", &errors.sliding},
                                   {"position", &errors.position},
                                   {"rotation", &errors.rotation},
                                   {"intrinsics", &errors.intrinsics},
                                   {"z_offset", &errors.z_offset},
                                   {"z_scaling", &errors.z_scaling}}) {
    constexpr double kMost = 1.0;  // radians, metres, or 100 %
    *value = map.number(key, *value);
    if (*value >= 0.0 && *value <= kMost) continue;
    map.error(map.find(key)->place,
              fmt::format("{} is {}, not between 0 and {} (radians, metres, or a share)", key,
                          *value, kMost));
  }
  if (auto values = map.map("values", "values")) {
    for (const ConfigEntry& entry : values->entries()) {
      given.add({.name = entry.key, .value = values->number(entry.key, 0.0)});
    }
  }
  map.report_unknown();
  return given;
}

/// Reads the noise of features; that of joints follows from the motion.
inline void read_noise(ConfigMap& map, MeasurementNoise& noise) {
  for (const auto& [key, value] :
       {std::pair{"pixel", &noise.pixel}, {"point", &noise.point}, {"rotation", &noise.rotation}}) {
    *value = map.number(key, *value);
    if (*value < 0.0) map.error(map.find(key)->place, std::string(key) + " is below zero");
  }
  map.report_unknown();
}

inline void read_motion(ConfigMap& map, SimulatedSetup& setup) {
  SimulatedTiming& timing = setup.timing;
  setup.drive.speed = map.positive("speed", setup.drive.speed);
  timing.image_rate = map.positive("image_rate", timing.image_rate);
  for (const auto& [key, value] : {std::pair{"encoder_noise", &timing.encoder_noise},
                                   {"repeatability", &timing.repeatability},
                                   {"backlash", &timing.backlash},
                                   {"image_latency", &timing.image_latency},
                                   {"exposure_time", &timing.exposure},
                                   {"late_stamps", &timing.late_stamps},
                                   {"lamp_latency", &timing.lamp_latency}}) {
    *value = map.number(key, *value);
  }
  map.report_unknown();
}

inline void read_faults(ConfigMap& map, Faults& faults) {
  faults.stuck_joint = map.text("stuck_joint").value_or("");
  for (const auto& [key, value] : {std::pair{"joints_end", &faults.joints_end},
                                   {"views_end", &faults.views_end},
                                   {"connection_ends", &faults.connection_ends},
                                   {"other_clock", &faults.other_clock},
                                   {"passer_by", &faults.passer_by},
                                   {"outliers", &faults.outliers},
                                   {"outlier_size", &faults.outlier_size}}) {
    *value = map.number(key, *value);
  }
  if (map.peek("dark_led") != nullptr) faults.dark_led = map.count("dark_led", 0);
  faults.no_camera_info = map.flag("no_camera_info", false);
  map.report_unknown();
}

}  // namespace kinecal::detail
