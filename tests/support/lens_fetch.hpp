// Simulated Fetches whose arm holds a board before a camera with a distorted lens.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "kinecal/sensors/lenses/lens.hpp"
#include "support/simulated.hpp"

namespace kinecal::test {

inline constexpr const char* kOptical = "head_camera_rgb_optical_frame";

inline constexpr double kCornerNoise = 0.3;  // pixels

/// A robot with errors, and what it measures.
struct TrueFetch {
  Robot robot = read_urdf(source_folder() + "/examples/robots/fetch/fetch.urdf");
  CameraInfo nominal = camera_info(), lens = nominal;
  std::map<std::string, double> truth;
  std::vector<Sample> samples, held_out;

  /// @param joint_noise  of each joint at each stop, radians: what no parameter explains
  TrueFetch(std::uint64_t seed, double joint_noise) {
    Chance chance(seed);
    for (const std::size_t k : {0, 4}) lens.k[k] *= chance(0.98, 1.02);
    for (const std::size_t k : {2, 5}) lens.k[k] += chance(-8.0, 8.0);
    lens.p = {lens.k[0], 0, lens.k[2], 0, 0, lens.k[4], lens.k[5], 0, 0, 0, 1, 0};
    lens.d = {chance(-0.25, 0.15), chance(-0.05, 0.1), chance(-2e-3, 2e-3), chance(-2e-3, 2e-3),
              0.0};
    for (const char* joint : {"shoulder_lift_joint", "upperarm_roll_joint", "elbow_flex_joint",
                              "forearm_roll_joint", "wrist_flex_joint"}) {
      truth[joint] = chance(-0.04, 0.04);
    }
    for (const char axis : std::string("xyzabc")) {
      const bool length = axis >= 'x';
      truth[std::string("head_camera_rgb_joint_") + axis] = (length ? 0.01 : 0.03) * chance(-1, 1);
    }
    const Pose<double> board{chance.rotation(), chance.box(0.03) + Vector3<double>(0.05, 0.0, 0.0)};
    const Vector3<double> turn = log(board.rotation);
    for (int k = 0; k < 3; ++k) {
      truth[std::string("board_") + "xyz"[k]] = board.translation(k);
      truth[std::string("board_") + "abc"[k]] = turn(k);
    }
    const ParameterTable parameters = table();
    const Eigen::VectorXd numbers = parameters.values();
    const OracleValues<double> values(parameters, numbers);
    while (samples.size() < 40) look(chance, values, joint_noise, samples);
    while (held_out.size() < 20) look(chance, values, joint_noise, held_out);
  }

  /// A table with the truth.
  [[nodiscard]] ParameterTable table() const {
    ParameterTable all;
    for (const auto& [name, value] : truth) all.add({.name = name, .value = value});
    return all;
  }

 private:
  /// Turns the head towards the gripper, so that it is somewhere in the image.
  void turn_head(Chance& chance, const OracleValues<double>& values, Sample& sample) const {
    const auto place = [&](const char* link) {
      return oracle_pose(robot, "base_link", link, "", sample, values).t;
    };
    const Vector3<double> way = place("gripper_link") - place("head_pan_link");
    for (std::size_t i = 0; i < sample.joint_names.size(); ++i) {
      double& q = sample.joint_positions[i];
      if (sample.joint_names[i] == "head_pan_joint")
        q = std::atan2(way.y(), way.x()) + chance(-0.4, 0.4);
      if (sample.joint_names[i] == "head_tilt_joint") {
        q = std::atan2(-way.z(), std::hypot(way.x(), way.y())) + chance(-0.3, 0.3);
      }
    }
  }

  /// Adds a sample, unless the camera does not see all of the board's face.
  void look(Chance& chance, const OracleValues<double>& values, double joint_noise,
            std::vector<Sample>& into) {
    Sample sample = fetch::anywhere(robot, chance);
    turn_head(chance, values, sample);
    const auto pose = [&](const char* link, const char* frame) {
      return oracle_pose(robot, "base_link", link, frame, sample, values);
    };
    const OraclePose<double> camera_T_board =
        pose(kOptical, "").inverse().then(pose("gripper_link", "board"));
    const Vector3<double> middle = camera_T_board(Vector3<double>(0.09, 0.06, 0.0));
    const double facing = -(camera_T_board.r.col(2).dot(middle.normalized()));
    if (middle.z() < 0.3 || middle.z() > 1.2 || facing < 0.5) return;
    Observation holder{"board", {}, {}}, eye{"camera", {}, nominal};
    const Lens camera(lens, ImageKind::raw);
    for (const Vector3<double>& corner : corners()) {
      const Eigen::Vector2d at = camera.project(camera_T_board(corner));
      if (!(at.x() > 0 && at.x() < 640 && at.y() > 0 && at.y() < 480)) return;
      const double u = at.x() + kCornerNoise * chance.normal(),
                   v = at.y() + kCornerNoise * chance.normal();
      holder.features.push_back({"board", corner});
      eye.features.push_back({kOptical, {u, v, 0.0}});
    }
    sample.observations = {holder, eye};
    sample.source = "fetch:" + std::to_string(into.size());
    for (double& q : sample.joint_positions) q += joint_noise * chance.normal();
    into.push_back(std::move(sample));
  }
};

}  // namespace kinecal::test
