// Definitions of capture_config.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/config/capture/capture_config.hpp"

#include <algorithm>
#include <array>
#include <initializer_list>
#include <limits>
#include <map>
#include <memory>
#include <numbers>
#include <optional>
#include <set>
#include <string>
#include <utility>

#include "kinecal/capture/finders/led_finder.hpp"
#include "kinecal/config/config_items.ipp"
#include "kinecal/config/read_config.hpp"
#include "kinecal/config/ros2_nodes.ipp"
#include "kinecal/files/yaml/yaml_document.hpp"
#include "kinecal/kinematics/forward_kinematics.hpp"

namespace kinecal {

namespace detail {

// Reads the finder of LEDs of a capture.yaml, in both dialects.

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

// Reads the finders of printed targets in a capture.yaml.

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

// Reads the finders of a capture.yaml, type by type.

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
  constexpr int kMostRepeats = 1000;
  finder.z_repeats = map.count("z_repeats", finder.z_repeats);
  if (finder.z_repeats > kMostRepeats) {
    map.error(map.find("z_repeats")->place, "z_repeats: " + std::to_string(finder.z_repeats) +
                                                " copies of a scan; the most are " +
                                                std::to_string(kMostRepeats));
  }
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

[[nodiscard]] inline MaskFinder read_mask_finder(ConfigMap& map) {
  MaskFinder finder;
  finder.camera_sensor = map.text("camera_sensor_name").value_or(finder.camera_sensor);
  return finder;
}

[[nodiscard]] inline TouchFinder read_touch_finder(ConfigMap& map) {
  TouchFinder finder;
  finder.chain_sensor = map.text("chain_sensor_name").value_or(finder.chain_sensor);
  finder.tip = map.text("tip_frame").value_or(finder.tip);
  finder.touched_sensor = map.text("touched_sensor_name").value_or(finder.touched_sensor);
  finder.frame = map.text("frame_id").value_or(finder.frame);
  finder.has_direction = map.flag("has_direction", finder.has_direction);
  finder.place = {map.number("x", 0.0), map.number("y", 0.0), map.number("z", 0.0)};
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
    {"MaskFinder", [](ConfigMap& map) -> FinderSettings { return read_mask_finder(map); }},
    {"TouchFinder", [](ConfigMap& map) -> FinderSettings { return read_touch_finder(map); }},
};

namespace {

/// "LedFinder" of "robot_calibration/LedFinder" and "robot_calibration::LedFinder"; the plugin
/// CheckerboardFinder<sensor_msgs::msg::Image> is the CheckerboardFinder2d.
[[nodiscard]] std::string finder_type(const std::string& type) {
  const std::size_t arguments = type.find('<');
  std::string name = type.substr(0, arguments);
  name = name.substr(name.find_last_of("/:") + 1);  // npos + 1 is 0
  const bool of_images =
      arguments != std::string::npos && type.find("Image", arguments) != std::string::npos;
  return of_images && !name.ends_with("2d") ? name + "2d" : name;
}

/// The camera_info topic of an image topic: /head_camera/rgb/image_raw has
/// /head_camera/rgb/camera_info.
[[nodiscard]] std::string camera_info_beside(const std::string& topic) {
  return topic.substr(0, topic.find_last_of('/') + 1) + "camera_info";
}

/// @param topic  if the file does not name one
[[nodiscard]] std::optional<CaptureFinder> read_finder(const std::string& name,
                                                       const std::string& topic, ConfigMap& map) {
  const std::optional<std::string> type = map.required_text("type");
  if (!type) return std::nullopt;
  CaptureFinder finder;
  finder.name = name;
  finder.type = finder_type(*type);
  finder.place = map.place();
  const auto reader = kFinderTypes.find(finder.type);
  if (reader == kFinderTypes.end()) {
    std::vector<std::string> types;
    for (const auto& known : kFinderTypes) types.push_back(known.first);
    map.error(map.find("type")->place,
              "type '" + *type + "' is not a finder" + map.did_you_mean(finder.type, types));
    return std::nullopt;
  }
  finder.topic = map.text("topic").value_or(topic);
  finder.camera_info = map.text("camera_info_topic").value_or(camera_info_beside(finder.topic));
  finder.action = map.text("action").value_or("");
  map.ignore({"camera_driver", "canera_driver"});  // ROS 2 spells it so
  finder.settings = reader->second(map);
  map.report_unknown();
  return finder;
}

[[nodiscard]] CaptureChain read_chain(const std::string& name, ConfigMap& map) {
  CaptureChain chain{name, map.text("topic").value_or(""), {}};
  for (const ConfigEntry& element : map.list("joints")) {
    if (const auto joint = config_text(element.value)) {
      chain.joints.push_back(*joint);
    } else {
      map.error(element.place, "joints: " + describe_config(element.value) + " is not a name");
    }
  }
  if (chain.joints.empty()) map.error(map.place(), "has no joints");
  map.ignore({"planning_group", "controller"});
  map.report_unknown();
  return chain;
}

/// The finders of ROS 1: a map by name, in file order.
[[nodiscard]] std::vector<ConfigItem> find_finders_in_map(ConfigMap& file) {
  std::vector<ConfigItem> items;
  if (const auto all = file.map("features", "features")) {
    for (const ConfigEntry& entry : all->entries()) {
      items.push_back({entry.key, all->map(entry, "finder '" + entry.key + "'"), entry.place});
    }
  }
  return items;
}

void read_capture(ConfigMap& file, bool is_ros2, CaptureConfig& config) {
  FindRos2Items find_ros2_items;
  const auto find_items = [&](const ConfigItemKind& kind) {
    return is_ros2 ? find_ros2_items(file, kind) : find_ros1_items(file, kind);
  };
  for (ConfigItem& item : find_items({"chains", "chain", ""})) {
    if (item.map) config.chains.push_back(read_chain(item.name, *item.map));
  }
  config.duration = file.positive("duration", config.duration);
  std::vector<ConfigItem> finders =
      is_ros2 ? find_items({"features", "finder", ""}) : find_finders_in_map(file);
  for (ConfigItem& item : finders) {
    if (!item.map) continue;
    const std::string topic = is_ros2 ? "/" + item.name + "/points" : "/points";
    if (auto finder = read_finder(item.name, topic, *item.map)) config.finders.push_back(*finder);
  }
  if (finders.empty()) file.error(file.place(), "features has no finders");
  file.ignore({"settling_time", "settling_timeout", "velocity_factor"});
  // Of every node of ROS 2, and of the calibration, which may be in the same file.
  file.ignore({"use_sim_time", "start_type_description_service", "qos_overrides", "verbose",
               "base_link", "models", "free_params", "free_frames", "free_frames_initial_values",
               "error_blocks", "cal_steps", "max_num_iterations"});
  for (const ConfigEntry& step : file.list("calibration_steps")) {
    if (const auto name = config_text(step.value)) file.use(*name);
  }
  file.report_unknown();
}

/// The pose of a view's camera in a link, from the robot's URDF.
[[nodiscard]] PoseOfView camera_in(const Robot& robot, const std::string& link) {
  return [robot = std::make_shared<const Robot>(robot),
          link](const View& view) -> std::optional<Pose<double>> {
    if (!robot->has_link(view.frame)) return std::nullopt;
    const RuntimeChain chain = make_chain(*robot, link, view.frame);
    const bool complete =
        std::all_of(chain.joints.begin(), chain.joints.end(), [&](const ChainJoint& joint) {
          return !moves(joint.type) || view.joints.position(joint.drive.joint);
        });
    if (!complete) return std::nullopt;
    return forward_kinematics(
        chain, [&](const std::string& joint) { return *view.joints.position(joint); });
  };
}

}  // namespace
}  // namespace detail

CaptureConfig read_capture_config(const std::string& path, Diagnostics& diagnostics) {
  CaptureConfig config;
  const detail::YamlNode content = detail::load_config(path, diagnostics);
  if (!content.is_map()) {
    diagnostics.error({path, 0}, detail::describe_wrong_file(content, "a capture.yaml",
                                                             "a map with chains and features"));
    return config;
  }
  const std::vector<detail::ConfigEntry> nodes = detail::ros2_nodes(content, path);
  if (nodes.empty()) {
    detail::ConfigMap file(content, {path, 0}, "", diagnostics);
    detail::read_capture(file, false, config);
    return config;
  }
  const detail::ConfigEntry* node = detail::choose_node(nodes, "features", diagnostics);
  if (node == nullptr) return config;
  const detail::YamlNode& parameters = *node->value.find("ros__parameters");
  if (parameters.is_map()) {
    detail::ConfigMap map(parameters, node->place, "", diagnostics);
    detail::read_capture(map, true, config);
  } else {
    diagnostics.error(node->place, "node '" + node->key + "': ros__parameters is " +
                                       detail::describe_config(parameters) + ", not a map");
  }
  return config;
}

std::string region_frame(const FinderSettings& settings) {
  return std::visit(
      [](const auto& chosen) -> std::string {
        if constexpr (requires { chosen.region_frame(); }) return chosen.region_frame();
        return "";
      },
      settings);
}

FinderSettings on_robot(const CaptureFinder& finder, const Robot& robot) {
  const auto camera_in = [&](const std::string& link) -> PoseOfView {
    if (link.empty()) return {};
    if (robot.has_link(link)) return detail::camera_in(robot, link);
    std::vector<std::string> links;
    for (const Joint& joint : robot.joints()) links.push_back(joint.child);
    throw InputError(finder.place.str() + ": finder '" + finder.name +
                     "': the robot has no link '" + link + "'" + did_you_mean(link, links));
  };
  FinderSettings settings = finder.settings;
  std::visit(
      [&](auto& chosen) {
        if constexpr (requires { chosen.place_on(camera_in); }) chosen.place_on(camera_in);
      },
      settings);
  return settings;
}

}  // namespace kinecal
