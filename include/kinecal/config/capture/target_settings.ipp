// Reads the finders of printed targets in a capture.yaml, for finder_settings.ipp.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "kinecal/config/capture/capture_config.hpp"
#include "kinecal/config/capture/led_settings.ipp"
#include "kinecal/config/config_items.ipp"

namespace kinecal::detail {

/// An integer of at least zero.
[[nodiscard]] inline int read_index(ConfigMap& map, const std::string& key, int fallback) {
  const double number = map.number(key, fallback);
  if (number >= 0.0 && number <= 1e6 && number == static_cast<int>(number)) {
    return static_cast<int>(number);
  }
  map.error(map.place(), key + " is not an integer from 0");
  return fallback;
}

/// Reads the sensors of a finder of a target, and the kind of its corners.
inline void read_target(ConfigMap& map, TargetSettings& target) {
  target.camera_sensor = map.text("camera_sensor_name").value_or(target.camera_sensor);
  target.chain_sensor = map.text("chain_sensor_name").value_or(target.chain_sensor);
  // ROS 2 reads this name of the key in place of the other, for checkerboards.
  target.chain_sensor = map.text("chain_sensor_name_id").value_or(target.chain_sensor);
  target.frame = map.text("frame_id").value_or(target.frame);
  TargetQuality& quality = target.quality;
  quality.min_square = map.positive("min_square", quality.min_square);
  quality.max_edge_width = map.positive("max_edge_width", quality.max_edge_width);
  quality.max_glare = map.number("max_glare", quality.max_glare);
  quality.max_bleed = map.positive("max_bleed", quality.max_bleed);
  target.max_without_depth = map.number("max_without_depth", target.max_without_depth);
}

/// A length that decides the scale of the result.  Notes the default, if it is taken.
[[nodiscard]] inline double read_scale(ConfigMap& map, const std::string& key, double fallback,
                                       const std::string& what) {
  if (map.peek(key) == nullptr) {
    map.note(map.place(), key + " is not given: " + what + " of " +
                              number_to_yaml(1000.0 * fallback) + " mm are assumed");
  }
  return map.positive(key, fallback);
}

[[nodiscard]] inline CheckerboardSettings read_checkerboard(ConfigMap& map, CornerKind corners) {
  CheckerboardSettings board;
  board.points_x = map.count("points_x", board.points_x);
  board.points_y = map.count("points_y", board.points_y);
  board.size = read_scale(map, "size", board.size, "squares");
  (void)read_choice(map, "checkerboard_type", "chess_board", {"chess_board"});  // of a fork
  board.target.corners = corners;
  read_target(map, board.target);
  if (const ConfigEntry* link = map.find("camera_link")) {  // of a fork
    map.warning(link->place, "camera_link is ignored: points stay in the frame of the camera");
  }
  map.ignore({"debug", "max_trials_count"});
  return board;
}

/// The keys that targets of AprilTags and of ArUco's markers share.
inline void read_tags(ConfigMap& map, CornerKind corners, AprilTagSettings& tags) {
  tags.columns = read_index(map, "columns", 0);
  tags.rows = read_index(map, "rows", 0);
  tags.size = map.positive("size", 0.0);
  if (tags.columns * tags.rows > 1 && map.peek("spacing") == nullptr) {
    map.note(map.place(), "spacing is not given: gaps of 0.3 times the size are assumed");
  }
  tags.spacing = map.number("spacing", tags.spacing);
  tags.first_id = read_index(map, "first_id", tags.first_id);
  tags.min_tags = map.count("min_tags", tags.min_tags);
  tags.min_side = map.positive("min_side", tags.min_side);
  tags.target.corners = corners;
  read_target(map, tags.target);
  for (const ConfigEntry& element : map.list("tags")) {
    auto tag = map.map(element, "tag");
    if (!tag) continue;
    const int id = read_index(*tag, "id", 0);
    tags.tags.push_back({id, tag->positive("size", tags.size), read_corner(*tag, "", {0, 0, 0})});
    tag->report_unknown();
  }
}

[[nodiscard]] inline AprilTagSettings read_april_tags(ConfigMap& map, CornerKind corners) {
  AprilTagSettings tags;
  tags.family = map.text("family").value_or(tags.family);
  tags.border = map.count("border", tags.border);
  tags.max_wrong_bits = read_index(map, "max_wrong_bits", tags.max_wrong_bits);
  tags.decimate = map.positive("decimate", tags.decimate);
  read_tags(map, corners, tags);
  return tags;
}

[[nodiscard]] inline AprilTagSettings read_markers(ConfigMap& map, CornerKind corners) {
  AprilTagSettings tags;
  tags.family = map.text("dictionary").value_or("DICT_4X4_50");
  read_tags(map, corners, tags);
  return tags;
}

[[nodiscard]] inline CharucoSettings read_charuco(ConfigMap& map, CornerKind corners) {
  CharucoSettings board;
  board.squares_x = map.count("squares_x", board.squares_x);
  board.squares_y = map.count("squares_y", board.squares_y);
  board.square_size = read_scale(map, "square_size", board.square_size, "squares");
  board.marker_size = read_scale(map, "marker_size", board.marker_size, "markers");
  board.dictionary = map.text("dictionary").value_or(board.dictionary);
  board.first_id = read_index(map, "first_id", board.first_id);
  board.legacy = map.flag("legacy", board.legacy);
  board.min_corners = map.count("min_corners", board.min_corners);
  board.target.corners = corners;
  read_target(map, board.target);
  map.ignore({"debug"});
  return board;
}

[[nodiscard]] inline CircleGridSettings read_circles(ConfigMap& map, CornerKind corners) {
  CircleGridSettings grid;
  grid.points_x = map.count("points_x", grid.points_x);
  grid.points_y = map.count("points_y", grid.points_y);
  grid.asymmetric =
      read_choice(map, "pattern", "asymmetric", {"asymmetric", "symmetric"}) == "asymmetric";
  grid.size = read_scale(map, "size", grid.size, "distances");
  grid.target.corners = corners;
  read_target(map, grid.target);
  map.ignore({"debug"});
  return grid;
}

}  // namespace kinecal::detail
