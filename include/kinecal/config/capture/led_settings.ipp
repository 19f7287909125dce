// Reads the finder of LEDs of a capture.yaml, in both dialects.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <initializer_list>
#include <string>

#include "kinecal/capture/led_finder.hpp"
#include "kinecal/config/config_items.ipp"

namespace kinecal::detail {

[[nodiscard]] inline Vector3<double> read_corner(ConfigMap& map, const std::string& prefix,
                                                 const Vector3<double>& fallback) {
  return {map.number(prefix + "x", fallback.x()), map.number(prefix + "y", fallback.y()),
          map.number(prefix + "z", fallback.z())};
}

/// Reads one LED.
/// @param required  keys that must be there
inline void read_led(ConfigMap& led, const std::string& name,
                     std::initializer_list<const char*> required, LedFinder& finder) {
  finder.leds.push_back({led.count("code", 0), name, read_corner(led, "", {0, 0, 0})});
  for (const char* key : required) {
    if (led.peek(key) == nullptr) led.error(led.place(), std::string(key) + " is missing");
  }
  led.ignore({"topic"});  // of an image for debugging
  led.report_unknown();
}

/// `poses:` in ROS 1, a list of LEDs; `leds:` in ROS 2, a list of names, each a map beside it, whose
/// coordinates are zero by default.
inline void read_leds(ConfigMap& map, LedFinder& finder) {
  for (const ConfigEntry& element : map.list("poses")) {
    const std::string subject = "LED " + std::to_string(finder.leds.size() + 1);
    auto led = map.map(element, subject);
    if (!led) continue;
    led->set_subject(subject);
    const std::string name = led->text("topic").value_or(subject);
    read_led(*led, name, {"code", "x", "y", "z"}, finder);
  }
  for (ConfigItem& item : FindRos2Items()(map, {"leds", "LED", ""})) {
    if (item.map) read_led(*item.map, item.name, {"code"}, finder);
  }
  if (!finder.leds.empty()) return;
  map.error(map.place(), "has no LEDs: list them under poses (ROS 1) or leds (ROS 2)");
}

[[nodiscard]] inline LedFinder read_led_finder(ConfigMap& map) {
  LedFinder finder;
  finder.camera_sensor = map.text("camera_sensor_name").value_or(finder.camera_sensor);
  finder.chain_sensor = map.text("chain_sensor_name").value_or(finder.chain_sensor);
  finder.frame = map.text("gripper_led_frame").value_or(finder.frame);
  finder.threshold = map.positive("threshold", finder.threshold);
  finder.max_iterations = map.count("max_iterations", finder.max_iterations);
  finder.max_error = map.positive("max_error", finder.max_error);
  finder.max_inconsistency = map.positive("max_inconsistency", finder.max_inconsistency);
  map.ignore({"debug_image", "debug"});
  read_leds(map, finder);
  return finder;
}

}  // namespace kinecal::detail
