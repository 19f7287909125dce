// Definitions of photographs.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/tools/simulation/photographs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>
#include <string>
#include <vector>

#include "kinecal/files/cameras/camera_info.hpp"
#include "kinecal/files/images/png_bytes.hpp"
#include "kinecal/files/poses/poses.hpp"
#include "kinecal/files/samples/write_samples.hpp"
#include "kinecal/files/yaml/yaml_text.hpp"
#include "kinecal/surface/outline.hpp"
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

/// The sample of a cloud: of its points those of every n-th column and row, as calibrations take few thousand.
[[nodiscard]] Sample cloud_sample(const SimulationPlan& plan, const View& view,
                                  const MeasuredJoints& joints) {
  constexpr double kPixels = 10000.0;
  const PointCloud& points = view.points;
  const int step = std::max(
      1, static_cast<int>(std::ceil(std::sqrt(double(points.width) * points.height / kPixels))));
  Sample sample;
  sample.joint_names = joints.names;
  sample.joint_positions = joints.positions;
  Observation seen{plan.setup.camera_name, {}, view.camera};
  for (int v = step / 2; v < points.height; v += step) {
    for (int u = step / 2; u < points.width; u += step) {
      const Vector3<double> p = points(u, v).cast<double>();
      if (p.allFinite()) seen.features.push_back({.frame = view.frame, .point = p});
    }
  }
  sample.observations.push_back(std::move(seen));
  return sample;
}

/// The robot in the image of a camera.
[[nodiscard]] GrayImage mask_of(const Outliner& outliner, const RobotSurface& surface,
                                const SimulatedRobot& robot) {
  std::vector<Pose<double>> links;
  for (const SurfaceLink& link : surface.links()) links.push_back(robot.in_camera(link.name));
  const SimulatedLens& lens = robot.lens();
  const auto pixel_of = [&](const Vector3<double>& p) -> Eigen::Vector2d {
    if (p.z() > 0.0) return lens.project(p);
    return Eigen::Vector2d::Constant(std::numeric_limits<double>::quiet_NaN());
  };
  const CameraInfo& info = robot.setup().camera.info;
  return outliner.mask(links, pixel_of, info.width, info.height);
}

/// Why a mask shows too little of the robot; empty if it does not.
[[nodiscard]] std::string too_little_of_robot(const GrayImage& mask) {
  constexpr double kLeast = 0.01;
  const auto robot = std::count(mask.pixels.begin(), mask.pixels.end(), 255);
  const double share = static_cast<double>(robot) / static_cast<double>(mask.pixels.size());
  return share >= kLeast ? ""
                         : fmt::format(
                               "the robot is {:.1f} % of the image; at least {:.0f} % are "
                               "needed",
                               100.0 * share, 100.0 * kLeast);
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
  std::vector<OutputFile> files = {
      {"truth.yaml", truth},
      {"poses.yaml", list.str()},
      {"camera.yaml", to_camera_info_yaml(plan.setup.camera.info, plan.setup.camera_name)},
      {"calibrate.yaml", plan.config}};
  if (plan.surface == nullptr) files.push_back({"capture.yaml", detail::finder_text(plan)});
  return files;
}

PhotographFiles take_photographs(const SimulationPlan& plan, const std::vector<JointTarget>& poses,
                                 const std::function<void(std::size_t)>& progress) {
  SimulatedRobot robot(plan.setup);
  PhotographFiles files;
  detail::PoseTable table;
  const RobotSurface none, &surface = plan.surface != nullptr ? *plan.surface : none;
  const Outliner outliner(surface);
  std::vector<Sample> clouds;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    if (progress) progress(i);
    const std::string name = fmt::format("{:04d}.png", i + 1);
    try {
      robot.move(poses[i]);
      robot.wait_for_rest();
      GrayImage mask;
      if (plan.surface != nullptr) {
        mask = detail::mask_of(outliner, surface, robot);
        const std::string why = detail::too_little_of_robot(mask);
        if (!why.empty()) throw PoseError(why);
      }
      const View view = robot.next_view(robot.now());
      const MeasuredJoints joints = robot.next_joints(view.stamp);
      table.add(name, joints);
      files.images.push_back({name, detail::png_bytes(view.image)});
      if (plan.surface != nullptr && view.points.empty()) {
        files.masks.push_back({name, detail::png_bytes(mask)});
      }
      if (view.points.empty()) continue;
      if (plan.surface != nullptr) clouds.push_back(detail::cloud_sample(plan, view, joints));
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
  if (!clouds.empty()) {
    std::ostringstream text;
    write_samples(text, clouds);
    files.others.push_back({"samples.yaml", text.str()});
  }
  return files;
}

}  // namespace kinecal
