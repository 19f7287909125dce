// The robot of a calibration as a scene: its links and joints before and after, and what was measured
// and predicted in each sample.  The HTML report and --scene draw it.
//
// A joint's pose is  parent_T_child = origin * correction * motion(q + offset),  with the corrections of
// the initial values (before) and of the result (after).
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
#include "kinecal/kinematics/joint_model.hpp"
#include "kinecal/linkage.hpp"
#include "kinecal/report/findings.hpp"

namespace kinecal {

/// A point, metres.
using ScenePoint = std::array<double, 3>;

/// A visual of a link, and its mesh if it was found.
struct SceneVisual {
  Visual visual;
  int mesh = -1;  ///< index into RobotScene::meshes; negative: none
};

/// A link, or a virtual frame beyond one.
struct SceneLink {
  std::string name;
  std::vector<SceneVisual> visuals = {};
};

/// What calibration adds to a joint.
struct SceneCorrection {
  std::array<double, 3> t{};         ///< translation, metres, in the joint's frame
  std::array<double, 3> r{};         ///< rotation vector, radians
  double offset = 0.0;               ///< of the joint's position, radians or metres
  OfJointModels<double> model = {};  ///< parameters of joint models of the joint that drives it
};

/// A joint, or the frame of something beyond a link: a board, a tracker.
struct SceneJoint {
  std::string name;
  JointType type = JointType::fixed;
  int parent = 0, child = 0;                  ///< links
  Pose<double> origin;                        ///< of the joint in the parent link, metres
  std::array<double, 3> axis{1.0, 0.0, 0.0};  ///< unit vector, in the joint's frame
  int drive = -1;                             ///< of RobotScene::names; negative: it does not move
  double multiplier = 1.0, offset = 0.0;      ///< position = multiplier * q[drive] + offset
  std::optional<SceneCorrection> before = {}, after = {};  ///< nullopt: none
  bool is_virtual = false;                                 ///< a free frame that the URDF lacks
};

/// A measured and a predicted point, metres, in the base link.
using ScenePair = std::array<ScenePoint, 2>;

/// What an error block compares: a feature.
struct SceneFeature {
  int block = 0;                           ///< index into RobotScene::blocks
  std::string name;                        ///< "feature 2"
  std::optional<ScenePair> before, after;  ///< nullopt: undefined, such as behind a camera
  std::optional<double> distance = {};     ///< of the residual, unit of the block
  std::string error = {};                  ///< the same for people: "3.2 mm"
};

/// A sample.
struct SceneSample {
  int number = 0;         ///< from 1, in the order of the files
  std::string source;     ///< source location
  bool bad = false;       ///< it does not fit the others
  std::string note;       ///< why; empty if it is not bad
  std::vector<double> q;  ///< positions of RobotScene::names; zero if not measured
  std::vector<SceneFeature> features;
  std::optional<std::chrono::nanoseconds> stamp = {};  ///< see Sample::stamp
  std::vector<float> cloud = {};  ///< x y z ..., metres, in `cloud_link`; see add_clouds()
  int cloud_link = -1;            ///< link
};

/// A camera; its optical frame is that of its link, z forward.
struct SceneCamera {
  std::string name;
  int link = 0;
  double width = 0.0, height = 0.0;               ///< pixels
  double fx = 0.0, fy = 0.0, cx = 0.0, cy = 0.0;  ///< calibrated, pixels
};

/// All of it.
struct RobotScene {
  std::string robot;  ///< its name
  int base = 0;       ///< the link in which points are given
  std::vector<SceneLink> links;
  std::vector<SceneJoint> joints;
  std::vector<Mesh> meshes;
  std::vector<std::string> names;  ///< joints whose positions samples have
  std::vector<SceneSample> samples;
  std::vector<std::string> blocks;  ///< names of error blocks
  std::vector<SceneCamera> cameras;
  std::string thinned;  ///< "200 of 10000 samples", if not all are here
  /// x, y, z in metres, in the base, and the error there in metres: for a map.
  std::vector<std::array<double, 4>> workspace;
};

/// How much a scene holds.
struct SceneLimits {
  std::size_t samples = 200;    ///< bad and worst ones are kept, and others evenly
  std::size_t features = 6000;  ///< of all samples; the worst ones of each are kept
};

/// The scene of a calibration that has run.  Visuals are not in it: see add_visuals().  Error blocks that
/// do not compare points, pixels or planes have no features in it.
/// @param samples  those of the calibration, in their order
[[nodiscard]] RobotScene robot_scene(const Calibration& calibration, const Findings& findings,
                                     std::span<const Sample> samples,
                                     const SceneLimits& limits = {});

/// The pose of a joint's child link in its parent link.
/// @param q          of RobotScene::names
/// @param corrected  with the corrections after the calibration, or else with those before it
[[nodiscard]] Pose<double> child_in_parent(const SceneJoint& joint, std::span<const double> q,
                                           bool corrected);

}  // namespace kinecal

#ifdef KINECAL_HEADER_ONLY
#include "kinecal/report/robot_scene.ipp"
#endif
