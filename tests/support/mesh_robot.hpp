// An arm with meshes that a depth camera beside it sees: URDF, mesh files, clouds.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <fstream>
#include <map>
#include <random>
#include <string>
#include <vector>

#include "kinecal/files/urdf/read_urdf.hpp"
#include "kinecal/geometry/rpy.hpp"
#include "kinecal/kinematics/chain.hpp"
#include "kinecal/kinematics/forward_kinematics.hpp"
#include "kinecal/parameters/parameter_table.hpp"
#include "kinecal/samples/sample.hpp"
#include "kinecal/surface/robot_surface.hpp"
#include "support/shapes.hpp"

namespace kinecal::test {

inline constexpr std::array kMeshLinks = {"base", "upper", "fore", "hand"};
inline constexpr std::array kMeshJoints = {"pan", "lift", "elbow", "wrist"};

/// The shape of a link: a long box with a bumpy ball at its side, no two alike.
inline Shape link_shape(std::size_t link) {
  const std::array<Shape, 2> parts = [&]() -> std::array<Shape, 2> {
    switch (link) {
      case 0:
        return {box({-0.12, -0.10, 0.0}, {0.10, 0.12, 0.25}),
                ball({0.12, 0.05, 0.1}, 0.08, 10, 0.2)};
      case 1:
        return {box({-0.05, -0.04, 0.03}, {0.05, 0.06, 0.37}),
                ball({0.06, -0.03, 0.2}, 0.07, 10, 0.2)};
      case 2:
        return {box({-0.04, -0.05, 0.03}, {0.03, 0.04, 0.30}),
                ball({-0.03, 0.05, 0.12}, 0.06, 10, 0.2)};
      default:
        return {box({-0.06, -0.02, 0.03}, {0.06, 0.02, 0.12}), ball({0.02, 0.0, 0.16}, 0.05, 10)};
    }
  }();
  Shape all = parts[0];
  const auto first = static_cast<std::uint32_t>(all.vertices.size());
  all.vertices.insert(all.vertices.end(), parts[1].vertices.begin(), parts[1].vertices.end());
  for (auto corners : parts[1].triangles) {
    for (std::uint32_t& corner : corners) corner += first;
    all.triangles.push_back(corners);
  }
  return all;
}

/// @param mesh  the element of a link: its name in "%"
inline std::string mesh_robot_urdf(const std::string& suffix = ".stl",
                                   const std::string& scale = "1 1 1") {
  std::string text = "<robot name=\"arm\">\n";
  for (const char* link : kMeshLinks) {
    text += std::string("<link name=\"") + link + "\"><visual><geometry><mesh filename=\"" + link +
            suffix + "\" scale=\"" + scale + "\"/></geometry></visual></link>\n";
  }
  const std::array axes = {"0 0 1", "0 1 0", "0 1 0", "0 0 1"};
  const std::array origins = {"0 0 0.27", "0 0 0.40", "0 0 0.33"};
  text +=
      "<link name=\"camera\"/>\n<joint name=\"camera_joint\" type=\"fixed\"><parent link=\"base\"/>"
      "<child link=\"camera\"/></joint>\n";
  for (std::size_t i = 0; i < 3; ++i) {
    text += std::string("<joint name=\"") + kMeshJoints[i] +
            "\" type=\"revolute\"><parent link=\"" + kMeshLinks[i] + "\"/><child link=\"" +
            kMeshLinks[i + 1] + "\"/><origin xyz=\"" + origins[i] + "\"/><axis xyz=\"" + axes[i] +
            "\"/><limit lower=\"-2.5\" upper=\"2.5\" effort=\"1\" velocity=\"1\"/></joint>\n";
  }
  return text + "</robot>\n";
}

/// Writes the meshes of all links.
inline void write_meshes(const std::filesystem::path& folder, double scale = 1.0) {
  for (std::size_t i = 0; i < kMeshLinks.size(); ++i) {
    Shape shape = link_shape(i);
    for (Vector3<double>& vertex : shape.vertices) vertex *= scale;
    std::ofstream(folder / (std::string(kMeshLinks[i]) + ".stl"), std::ios::binary)
        << binary_stl(shape.for_file());
  }
}

/// The surface of the arm, without files.
inline RobotSurface mesh_robot_surface() {
  std::vector<SurfaceLink> links;
  for (std::size_t i = 0; i < kMeshLinks.size(); ++i) {
    const Shape shape = link_shape(i);
    links.push_back({kMeshLinks[i], TriangleTree(shape.vertices, shape.triangles)});
  }
  return RobotSurface(std::move(links));
}

/// Poses of all links in the base.
inline std::vector<Pose<double>> mesh_robot_poses(const Robot& robot,
                                                  const std::map<std::string, double>& q) {
  std::vector<Pose<double>> poses;
  for (const char* link : kMeshLinks) {
    poses.push_back(forward_kinematics(make_chain(robot, "base", link), [&](const auto& joint) {
      return q.at(std::string(joint));
    }));
  }
  return poses;
}

/// Joint positions of a sample by name.
inline std::map<std::string, double> positions_of(const Sample& sample) {
  std::map<std::string, double> q;
  for (std::size_t j = 0; j < sample.joint_names.size(); ++j) {
    q[sample.joint_names[j]] = sample.joint_positions[j];
  }
  return q;
}

/// How clouds are made.
struct CloudPlan {
  int samples = 8;
  int pixels = 50;                             ///< along a side of the image
  double noise = 0.0;                          ///< metres, along the line of sight
  bool background = false;                     ///< a wall behind the robot
  std::map<std::string, double> offsets = {};  ///< of joints: the truth less what is recorded
  std::vector<Vector3<double>> shifts = {};    ///< of the links against their meshes, metres
  unsigned seed = 1;
};

/// base_T_camera of the clouds.
inline Pose<double> true_camera() {
  return {rotation_from_rpy(Vector3<double>(-1.7, 0.1, -1.2)), Vector3<double>(-1.3, -0.6, 0.75)};
}

/// Clouds of the arm, seen by true_camera().
inline std::vector<Sample> mesh_robot_samples(const Robot& robot, const CloudPlan& plan,
                                              const RobotSurface& surface = mesh_robot_surface()) {
  std::mt19937 engine(plan.seed);
  std::uniform_real_distribution<double> turn(-1.0, 1.0);
  std::normal_distribution<double> noise(0.0, 1.0);
  const Pose<double> base_T_camera = true_camera();
  std::vector<Sample> samples;
  for (int s = 0; s < plan.samples; ++s) {
    Sample& sample = samples.emplace_back();
    sample.source = "sample " + std::to_string(s);
    std::map<std::string, double> q;
    for (std::size_t j = 0; j < 3; ++j) {
      const std::string joint = kMeshJoints[j];
      const double offset = plan.offsets.contains(joint) ? plan.offsets.at(joint) : 0.0;
      const double position = (joint == "pan" ? 1.5 : 1.0) * turn(engine);
      sample.joint_names.push_back(joint);
      sample.joint_positions.push_back(position);
      q[joint] = position + offset;
    }
    std::vector<Pose<double>> links = mesh_robot_poses(robot, q);
    for (std::size_t l = 0; l < plan.shifts.size(); ++l) {
      links[l].translation += links[l].rotation * plan.shifts[l];
    }
    Observation seen{.sensor = "camera", .features = {}, .camera = CameraInfo{}};
    const double center = 0.5 * plan.pixels, focal = center / 0.45;
    seen.camera->width = seen.camera->height = plan.pixels;
    seen.camera->p = {focal, 0.0, center, 0.0, 0.0, focal, center, 0.0, 0.0, 0.0, 1.0, 0.0};
    seen.camera->k = {focal, 0.0, center, 0.0, focal, center, 0.0, 0.0, 1.0};
    for (int u = 0; u < plan.pixels; ++u) {
      for (int v = 0; v < plan.pixels; ++v) {
        const double half = 0.5 * plan.pixels;
        const Vector3<double> ray((u + 0.5 - half) / half * 0.45, (v + 0.5 - half) / half * 0.45,
                                  1.0);
        double depth = surface
                           .cast(links, base_T_camera.translation,
                                 Vector3<double>(base_T_camera.rotation * ray))
                           .distance;
        if (!std::isfinite(depth)) {
          if (!plan.background) continue;
          depth = 2.5 + 0.2 * ray.x();
        }
        depth += plan.noise * noise(engine);
        seen.features.push_back({.frame = "camera", .point = depth * ray});
      }
    }
    sample.observations.push_back(std::move(seen));
  }
  return samples;
}

/// @param more  lines of the step, with two spaces before them
inline std::string mesh_config(const std::string& initial, const std::string& block = "",
                               const std::string& free_params = "") {
  return "base_link: base\nmodels:\n- {name: camera, type: camera3d, frame: camera}\n" +
         (free_params.empty() ? "" : "free_params: [" + free_params + "]\n") +
         "free_frames:\n- {name: camera_joint, x: true, y: true, z: true, roll: true, pitch: true, "
         "yaw: true}\n" +
         (initial.empty()
              ? ""
              : "free_frames_initial_values:\n- {name: camera_joint, " + initial + "}\n") +
         "error_blocks:\n- {name: surface, type: chain3d_to_mesh, model: camera" + block + "}\n";
}

/// The arm with a camera that stands where the URDF says: true_camera().
inline std::string watched_arm() {
  std::string urdf = mesh_robot_urdf();
  const std::string joint = "<child link=\"camera\"/>";
  urdf.insert(urdf.find(joint), "<origin xyz=\"-1.3 -0.6 0.75\" rpy=\"-1.7 0.1 -1.2\"/>");
  return urdf;
}

/// The start of the tests: 6 cm and 6 degrees off true_camera().
inline constexpr const char* kStart =
    "x: -1.26, y: -0.63, z: 0.79, roll: -1.62, pitch: 0.03, yaw: -1.24";

/// The pose of the camera in a table.
inline Pose<double> camera_in(const ParameterTable& table,
                              const std::string& joint = "camera_joint") {
  const auto value = [&](const char* axis) { return table[joint + "_" + axis].value; };
  return {exp(Vector3<double>(value("a"), value("b"), value("c"))),
          Vector3<double>(value("x"), value("y"), value("z"))};
}

inline double distance_of(const Pose<double>& one, const Pose<double>& other) {
  return (one.translation - other.translation).norm();
}

inline double angle_of(const Pose<double>& one, const Pose<double>& other) {
  return Eigen::AngleAxisd(one.rotation.transpose() * other.rotation).angle();
}

}  // namespace kinecal::test
