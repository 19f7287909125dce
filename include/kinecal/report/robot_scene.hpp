// The robot of a calibration as a scene: links and joints before and after, and the measured and
// predicted points of each sample.  The HTML report and --scene draw it.
//
// A joint's pose is  parent_T_child = origin * correction * motion(q + offset),  with the
// corrections of the initial values (before) and of the result (after).
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <chrono>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "kinecal/files/meshes/mesh.hpp"
#include "kinecal/files/urdf/visuals.hpp"
#include "kinecal/kinematics/joint.hpp"
#include "kinecal/report/findings.hpp"

namespace kinecal {

/// A point, metres.
using ScenePoint = std::array<double, 3>;

/// A visual of a link, with its mesh if found.
struct SceneVisual {
  Visual visual;
  int mesh = -1;  ///< index into RobotScene::meshes; negative: none
};

/// A link, or a virtual frame beyond one.
struct SceneLink {
  std::string name;
  std::vector<SceneVisual> visuals = {};
};

/// The calibration of a joint.
struct SceneCorrection {
  std::array<double, 3> t{};  ///< translation, metres, in the joint's frame
  std::array<double, 3> r{};  ///< rotation vector, radians
  double offset = 0.0;        ///< of the joint's position, radians or metres; without joint models
};

/// A joint, or a frame beyond a link: of a board, a tracker.
struct SceneJoint {
  std::string name;
  JointType type = JointType::fixed;
  int parent = 0, child = 0;                  ///< links
  Pose<double> origin;                        ///< of the joint in the parent link, metres
  std::array<double, 3> axis{1.0, 0.0, 0.0};  ///< unit vector, in the joint's frame
  int drive = -1;                             ///< of RobotScene::names; negative: it does not move
  double multiplier = 1.0, offset = 0.0;      ///< position = multiplier * q[drive] + offset
  std::optional<SceneCorrection> before = {}, after = {};  ///< nullopt: none
  bool is_virtual = false;  ///< a free frame that is not in the URDF, or in a floating joint
};

/// A measured and a predicted point, metres, in the base link.
using ScenePair = std::array<ScenePoint, 2>;

/// A feature compared by an error block.
struct SceneFeature {
  int block = 0;                           ///< index into RobotScene::blocks
  std::string name;                        ///< "feature 2"
  std::optional<ScenePair> before, after;  ///< nullopt: undefined, such as behind a camera
  std::optional<double> distance = {};     ///< of the residual, unit of the block
  std::string error = {};                  ///< the same as text: "3.2 mm"
};

/// Points of cameras that error blocks compare with the surface of the robot.
struct SceneCloud {
  std::vector<ScenePoint> points = {};  ///< metres, in the base
  std::vector<double> distances = {};   ///< of each from the surface: |residual|, metres
};

/// A sample.
struct SceneSample {
  int number = 0;         ///< from 1, in the order of the files
  std::string source;     ///< source location
  bool bad = false;       ///< it does not fit the others, or is left out
  bool left_out = false;  ///< the result does not use it
  std::string note;       ///< the fault; empty if it is not bad
  std::vector<double> q;  ///< positions of RobotScene::names; zero if not measured
  std::vector<SceneFeature> features;
  std::optional<std::chrono::nanoseconds> stamp = {};  ///< see Sample::stamp
  std::vector<float> cloud = {};  ///< x y z ..., metres, in `cloud_link`; see add_clouds()
  int cloud_link = -1;            ///< link
  SceneCloud matched_before = {}, matched_after = {};  ///< empty: none, or undefined
};

/// A camera; its optical frame is that of its link, z forward.
struct SceneCamera {
  std::string name;
  int link = 0;
  double width = 0.0, height = 0.0;               ///< pixels
  double fx = 0.0, fy = 0.0, cx = 0.0, cy = 0.0;  ///< calibrated, pixels
};

/// The whole scene.
struct RobotScene {
  std::string robot;  ///< its name
  int base = 0;       ///< link in which points are given
  std::vector<SceneLink> links;
  std::vector<SceneJoint> joints;
  std::vector<Mesh> meshes;
  std::vector<std::string> names;  ///< joints with positions in the samples
  std::vector<SceneSample> samples;
  std::vector<std::string> blocks;  ///< names of error blocks
  std::vector<SceneCamera> cameras;
  std::string thinned;  ///< "200 of 10000 samples"; empty if complete
  /// x, y, z in metres, in the base, and the error there in metres: for a map.
  std::vector<std::array<double, 4>> workspace;
};

/// Limits on the size of a scene.
struct SceneLimits {
  std::size_t samples = 200;    ///< keeps bad and worst ones, and others evenly
  std::size_t features = 6000;  ///< of all samples; keeps the worst ones of each
  std::size_t points = 15'000;  ///< of clouds on the surface, of all samples; evenly of each
};

/// The scene of a finished calibration, without visuals: see add_visuals().  Error blocks that
/// compare neither points, pixels nor planes have no features in it; points on the surface of the robot are clouds.
/// @param samples   those of the calibration, in their order
/// @param left_out  those of Findings::left_out, in their order; empty: they are not shown
[[nodiscard]] RobotScene robot_scene(const Calibration& calibration, const Findings& findings,
                                     std::span<const Sample> samples,
                                     const SceneLimits& limits = {},
                                     std::span<const Sample> left_out = {});

/// The pose of a joint's child link in its parent link.
/// @param q          of RobotScene::names
/// @param corrected  with the corrections after the calibration; else those before it
[[nodiscard]] Pose<double> child_in_parent(const SceneJoint& joint, std::span<const double> q,
                                           bool corrected);

}  // namespace kinecal
