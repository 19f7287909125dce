// Reads the finders of a capture.yaml, type by type.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <limits>
#include <map>
#include <numbers>
#include <string>
#include <utility>

#include "kinecal/config/capture/capture_config.hpp"
#include "kinecal/config/capture/led_settings.ipp"
#include "kinecal/config/capture/target_settings.ipp"
#include "kinecal/config/config_items.ipp"

namespace kinecal::detail {

[[nodiscard]] inline PlaneFinder read_plane_finder(ConfigMap& map) {
  PlaneFinder finder;
  finder.camera_sensor = map.text("camera_sensor_name").value_or(finder.camera_sensor);
  finder.region.frame = map.text("transform_frame").value_or("");
  finder.region.least = read_corner(map, "min_", finder.region.least);
  finder.region.most = read_corner(map, "max_", finder.region.most);
  finder.points_max = static_cast<std::size_t>(map.count("points_max", 60));
  finder.search.tolerance = map.positive("tolerance", finder.search.tolerance);
  finder.search.iterations = map.count("ransac_iterations", finder.search.iterations);
  finder.search.normal = {map.number("normal_a", 0.0), map.number("normal_b", 0.0),
                          map.number("normal_c", 0.0)};
  finder.search.normal_angle = map.positive("normal_angle", finder.search.normal_angle);
  map.ignore({"ransac_points", "initial_sample_distance", "debug", "debug_cloud"});
  return finder;
}

[[nodiscard]] inline ScanFinder read_scan_finder(ConfigMap& map) {
  ScanFinder finder;
  finder.sensor = map.text("sensor_name").value_or(finder.sensor);
  finder.frame = map.text("transform_frame").value_or("");
  finder.least = read_corner(map, "min_", finder.least);
  finder.most = read_corner(map, "max_", finder.most);
  finder.z_repeats = map.count("z_repeats", finder.z_repeats);
  finder.z_offset = map.number("z_offset", finder.z_offset);
  map.ignore({"debug"});
  return finder;
}

[[nodiscard]] inline RobotFinder read_robot_finder(ConfigMap& map) {
  RobotFinder finder{.plane = read_plane_finder(map)};
  finder.robot_sensor = map.text("robot_sensor_name").value_or(finder.robot_sensor);
  finder.least = read_corner(map, "min_robot_", finder.least);
  finder.most = read_corner(map, "max_robot_", finder.most);
  return finder;
}

/// Reads a target whose corners are of a kind.
template <auto read, CornerKind corners>
[[nodiscard]] FinderSettings with_corners(ConfigMap& map) {
  return read(map, corners);
}

/// Reads the settings of each type; upstream's names.  The corners of a target are points of a cloud, 2d:
/// pixels, 6d: one pose.
inline const std::map<std::string, FinderSettings (*)(ConfigMap&)> kFinderTypes = {
    {"LedFinder", [](ConfigMap& map) -> FinderSettings { return read_led_finder(map); }},
    {"CheckerboardFinder", with_corners<read_checkerboard, CornerKind::points>},
    {"CheckerboardFinder2d", with_corners<read_checkerboard, CornerKind::pixels>},
    {"CheckerboardFinder6d", with_corners<read_checkerboard, CornerKind::pose>},
    {"AprilTagFinder", with_corners<read_april_tags, CornerKind::points>},
    {"AprilTagFinder2d", with_corners<read_april_tags, CornerKind::pixels>},
    {"AprilTagFinder6d", with_corners<read_april_tags, CornerKind::pose>},
    {"ArucoFinder", with_corners<read_markers, CornerKind::points>},
    {"ArucoFinder2d", with_corners<read_markers, CornerKind::pixels>},
    {"ArucoFinder6d", with_corners<read_markers, CornerKind::pose>},
    {"CharucoFinder", with_corners<read_charuco, CornerKind::points>},
    {"CharucoFinder2d", with_corners<read_charuco, CornerKind::pixels>},
    {"CharucoFinder6d", with_corners<read_charuco, CornerKind::pose>},
    {"CircleGridFinder", with_corners<read_circles, CornerKind::points>},
    {"CircleGridFinder2d", with_corners<read_circles, CornerKind::pixels>},
    {"CircleGridFinder6d", with_corners<read_circles, CornerKind::pose>},
    {"PlaneFinder", [](ConfigMap& map) -> FinderSettings { return read_plane_finder(map); }},
    {"ScanFinder", [](ConfigMap& map) -> FinderSettings { return read_scan_finder(map); }},
    {"RobotFinder", [](ConfigMap& map) -> FinderSettings { return read_robot_finder(map); }},
};

}  // namespace kinecal::detail
