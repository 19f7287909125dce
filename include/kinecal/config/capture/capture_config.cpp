// Definitions of capture_config.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/config/capture/capture_config.hpp"

#include <algorithm>
#include <memory>
#include <optional>
#include <set>
#include <utility>

#include "kinecal/config/capture/finder_settings.ipp"
#include "kinecal/config/read_config.hpp"
#include "kinecal/config/ros2_nodes.ipp"
#include "kinecal/files/yaml/yaml_document.hpp"
#include "kinecal/kinematics/forward_kinematics.hpp"

namespace kinecal {
namespace detail {
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
  if (const auto* plane = std::get_if<PlaneFinder>(&finder.settings)) {
    finder.region_frame = plane->region.frame;
  } else if (const auto* robot = std::get_if<RobotFinder>(&finder.settings)) {
    finder.region_frame = robot->plane.region.frame;
  } else if (const auto* scan = std::get_if<ScanFinder>(&finder.settings)) {
    finder.region_frame = scan->frame;
  }
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
  if (auto* leds = std::get_if<LedFinder>(&settings)) {
    leds->frame_T_camera = camera_in(leds->frame);
  } else if (auto* plane = std::get_if<PlaneFinder>(&settings)) {
    plane->region.frame_T_camera = camera_in(finder.region_frame);
  } else if (auto* scan = std::get_if<ScanFinder>(&settings)) {
    scan->frame_T_scanner = camera_in(finder.region_frame);
  } else if (auto* body = std::get_if<RobotFinder>(&settings)) {
    body->plane.region.frame_T_camera = camera_in(finder.region_frame);
  }
  return settings;
}

}  // namespace kinecal
