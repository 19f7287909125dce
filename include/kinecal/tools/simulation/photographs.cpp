// Definitions of photographs.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/tools/simulation/photographs.hpp"

#include <fmt/format.h>

#include <cmath>
#include <sstream>
#include <string>
#include <vector>

#include "kinecal/files/cameras/camera_info.hpp"
#include "kinecal/files/images/png_bytes.hpp"
#include "kinecal/files/poses/poses.hpp"
#include "kinecal/files/yaml/yaml_text.hpp"
#include "kinecal/tools/simulation/place_target.ipp"

namespace kinecal {

namespace detail {
namespace {

/// Depths of an organised cloud, millimetres; 0 where nothing was measured.
[[nodiscard]] Image<std::uint16_t> millimetres_of(const PointCloud& points) {
  constexpr float kMost = 65.5F;  // metres
  Image<std::uint16_t> depth(points.width, points.height, 0);
  for (std::size_t i = 0; i < depth.pixels.size(); ++i) {
    const float z = points.pixels[i].z();
    if (z > 0.0F && z < kMost) {
      depth.pixels[i] = static_cast<std::uint16_t>(std::lround(1000.0F * z));
    }
  }
  return depth;
}

/// The finder of a plan's target.
[[nodiscard]] std::string finder_text(const SimulationPlan& plan) {
  const SimulatedTarget& target = plan.target;
  const bool is_3d = plan.camera_type == "camera3d";
  std::string name = "plane_finder", type = "PlaneFinder";
  if (target.type == "checkerboard") {
    name = "checkerboard_finder";
    type = is_3d ? "CheckerboardFinder" : "CheckerboardFinder2d";
  } else if (has_tags(target)) {
    name = "april_tag_finder";
    type = is_3d ? "AprilTagFinder" : "AprilTagFinder2d";
  } else if (target.type == "leds") {
    name = "led_finder";
    type = "LedFinder";
  }
  std::string text = fmt::format("features:\n  {}:\n    type: robot_calibration/{}\n", name, type);
  text += fmt::format("    camera_sensor_name: {}\n", name_to_yaml(plan.setup.camera_name));
  if (target.type == "ground") return text;
  text += fmt::format("    chain_sensor_name: {}\n", name_to_yaml(plan.chain_sensor));
  if (is_board(target)) {
    const bool tags = has_tags(target);
    text +=
        fmt::format("    frame_id: {}\n    {}: {}\n    {}: {}\n    size: {}\n",
                    name_to_yaml(plan.target_frame), tags ? "columns" : "points_x", target.columns,
                    tags ? "rows" : "points_y", target.rows, number_to_yaml(target.size));
    if (tags) {
      const TagGridShape shape = tags_of(target);
      text += fmt::format("    spacing: {}\n", number_to_yaml(double(shape.gap) / shape.tag()));
      if (shape.border != 1) text += fmt::format("    border: {}\n", shape.border);
    }
    return text;
  }
  text += fmt::format("    gripper_led_frame: {}\n    action: leds\n    poses:\n",
                      name_to_yaml(target.link));
  int code = 0;
  for (const Vector3<double>& led : target.leds) {
    text +=
        fmt::format("     - {{code: {}, topic: led{}, x: {}, y: {}, z: {}}}\n", code + 1, code + 1,
                    number_to_yaml(led.x()), number_to_yaml(led.y()), number_to_yaml(led.z()));
    ++code;
  }
  return text;
}

/// Rows of a table: the name of an image and joint positions.
class PoseTable {
 public:
  void add(const std::string& image, const MeasuredJoints& joints) {
    if (text_.empty()) {
      text_ = "image";
      for (const std::string& name : joints.names) text_ += "," + name;
      text_ += "\n";
    }
    text_ += image;
    for (const double position : joints.positions) text_ += fmt::format(",{:.9g}", position);
    text_ += "\n";
  }
  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  std::string text_;
};

}  // namespace
}  // namespace detail

std::vector<OutputFile> files_of(const SimulationPlan& plan,
                                 const std::vector<JointTarget>& poses) {
  std::string truth;
  for (const Parameter& parameter : plan.setup.truth) {
    truth += detail::name_to_yaml(parameter.name) + ": " + number_to_yaml(parameter.value) + "\n";
  }
  std::vector<CapturePose> listed;
  for (const JointTarget& pose : poses) listed.push_back({pose.names, pose.positions, {}});
  std::ostringstream list;
  write_poses_yaml(list, listed);
  return {{"truth.yaml", truth},
          {"poses.yaml", list.str()},
          {"camera.yaml", to_camera_info_yaml(plan.setup.camera.info, plan.setup.camera_name)},
          {"calibrate.yaml", plan.config},
          {"capture.yaml", detail::finder_text(plan)}};
}

PhotographFiles take_photographs(const SimulationPlan& plan, const std::vector<JointTarget>& poses,
                                 const std::function<void(std::size_t)>& progress) {
  SimulatedRobot robot(plan.setup);
  PhotographFiles files;
  detail::PoseTable table;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    if (progress) progress(i);
    const std::string name = fmt::format("{:04d}.png", i + 1);
    try {
      robot.move(poses[i]);
      robot.wait_for_rest();
      const View view = robot.next_view(robot.now());
      table.add(name, robot.next_joints(view.stamp));
      files.images.push_back({name, detail::png_bytes(view.image)});
      if (view.points.empty()) continue;
      files.depth.push_back({name, detail::png_bytes(detail::millimetres_of(view.points))});
    } catch (const PoseError& e) {
      files.skipped.push_back(fmt::format("pose {}: {}", i + 1, e.what()));
    } catch (const ConnectionError& e) {
      files.skipped.push_back(fmt::format("pose {} and all after it: {}", i + 1, e.what()));
      break;
    }
  }
  if (files.images.empty()) {
    throw InputError("no image came" +
                     (files.skipped.empty() ? std::string() : ": " + files.skipped.front()));
  }
  files.others = files_of(plan, poses);
  files.others.push_back({"poses.csv", table.text()});
  return files;
}

}  // namespace kinecal
