// Calibrations whose truth is known: a robot, what it was calibrated with, samples without noise, and
// noise of a known size that is drawn again and again.
//
// The Fetch with LEDs that its head camera sees in 3-D; a six-axis arm and a laser tracker, at real
// poses; a camera in a gantry's hand and a board.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <vector>

#include "kinecal/trust.hpp"
#include "support/oracle.hpp"
#include "support/paths.hpp"
#include "support/unknown_poses.hpp"

namespace kinecal::test {

/// A frame beyond a link; empty: the link itself.
struct Place {
  std::string link, frame = {};
};

/// A calibration with a truth.
struct Simulated {
  std::string name;
  Robot robot;
  Config config;
  std::vector<Sample> exact;            ///< what the sensors see without noise
  std::map<std::string, double> truth;  ///< of parameters; zero of others
  std::string noisy = {};               ///< sensor of which the measurements have noise
  double sigma = 0.0;                   ///< of each of their coordinates
  int coordinates = 3;                  ///< 2: pixels
  Place gripper = {}, camera = {};      ///< what is asked: the pose of the one in the other
  double outliers = 0.0;                ///< share of features whose noise is five times as large

  /// The samples with the noise of a seed.
  [[nodiscard]] std::vector<Sample> samples(std::uint64_t seed) const {
    Chance chance(seed);
    std::vector<Sample> drawn = exact;
    for (Sample& sample : drawn) {
      for (Observation& seen : sample.observations) {
        if (seen.sensor != noisy) continue;
        for (Feature& feature : seen.features) {
          const double s = chance(0.0, 1.0) < outliers ? 5.0 * sigma : sigma;
          for (int k = 0; k < coordinates; ++k) feature.point(k) += s * chance.normal();
        }
      }
    }
    return drawn;
  }

  /// The calibration of samples, with frames that are nowhere on the robot started at the truth.
  [[nodiscard]] Calibration calibration(const std::vector<Sample>& with) const {
    Diagnostics diagnostics;
    Calibration all = assemble(config, robot, with, diagnostics);
    diagnostics.throw_if_errors();
    for (CalibrationStep& step : all.steps) {
      for (const UnknownFrame& unknown : step.unknown_frames) start_at_truth(all.table, unknown);
      step.unknown_frames.clear();
    }
    return all;
  }
  [[nodiscard]] double truth_of(const std::string& parameter) const {
    const auto at = truth.find(parameter);
    return at == truth.end() ? 0.0 : at->second;
  }
  [[nodiscard]] Eigen::VectorXd truth_of(const ParameterTable& table) const {
    Eigen::VectorXd all(table.size());
    for (int i = 0; i < table.size(); ++i) all(i) = truth_of(table[i].name);
    return all;
  }
  /// Position of the gripper in the camera's frame.
  template <class Values>
  [[nodiscard]] Vector3<double> gripper_in_camera(const ParameterTable& table, const Sample& sample,
                                                  const Values& values) const {
    const OracleValues<double> by_name(table, values);
    const auto pose = [&](const Place& place) {
      return oracle_pose(robot, config.base_link, place.link, place.frame, sample, by_name);
    };
    return pose(camera).inverse()(pose(gripper).t);
  }

 private:
  void start_at_truth(ParameterTable& table, const UnknownFrame& unknown) const {
    for (const auto axis : kFrameAxes) {
      const int i = table.find(parameter_name(unknown.name, axis));
      if (i >= 0) table[i].value = table[i].initial = truth_of(table[i].name);
    }
  }
};

/// What a depth camera must record to see a point, at these camera parameters.
inline Vector3<double> recorded_depth(const CameraInfo& info, const Vector3<double>& seen,
                                      const std::string& camera,
                                      const OracleValues<double>& values) {
  const double fx = info.p[0], fy = info.p[5], cx = info.p[2], cy = info.p[6];
  const auto of = [&](const char* part) { return values(camera + "_" + part); };
  const double raw = seen.z() / (1.0 + of("z_scaling")) - of("z_offset");
  const double z = info.z_scaling * (raw + info.z_offset);
  const double u = seen.x() / seen.z() * fx * (1.0 + of("fx")) + cx * (1.0 + of("cx"));
  const double v = seen.y() / seen.z() * fy * (1.0 + of("fy")) + cy * (1.0 + of("cy"));
  return {(u - cx) / fx * z, (v - cy) / fy * z, z};
}

namespace fetch {

/// The shipped configuration without priors: what only they determine is held.
inline Config config(bool floor) {
  Diagnostics diagnostics;
  Config read = read_config(source_folder() + "/examples/robots/fetch/calibrate.yaml", diagnostics);
  diagnostics.throw_if_errors();
  StepConfig& step = read.steps.front();
  step.error_blocks.resize(floor ? 2 : 1);
  for (BlockConfig& block : step.error_blocks) {
    block.sigma.reset();
    block.loss = {};
  }
  std::erase_if(step.free_params, [](const auto& p) { return p.name == "shoulder_pan_joint"; });
  step.free_frames.back().axes[4] = false;  // the camera's pitch is the head's tilt
  return read;
}

/// Angles within 0.02 rad, lengths within 5 mm, intrinsics within 0.5 %.
inline std::map<std::string, double> truth(const Robot& robot, const StepConfig& step,
                                           Chance& chance) {
  std::map<std::string, double> all;
  for (const FreeParamConfig& parameter : free_parameters(step)) {
    const std::string& n = parameter.name;
    const bool length = n.ends_with("_x") || n.ends_with("_y") || n.ends_with("_z");
    const bool angle = robot.has_joint(n) || n.find("joint_") != std::string::npos;
    all[n] = (angle && !length ? 0.02 : 0.005) * chance(-1.0, 1.0);
  }
  return all;
}

/// Random positions of all joints.
inline Sample anywhere(const Robot& robot, Chance& chance) {
  Sample sample;
  for (const Joint& joint : robot.joints()) {
    if (!moves(joint.type) || joint.mimic) continue;
    const bool limited = joint.type != JointType::continuous && joint.limits;
    sample.joint_names.push_back(joint.name);
    sample.joint_positions.push_back(limited ? chance(joint.limits->lower, joint.limits->upper)
                                             : chance(-3.0, 3.0));
  }
  return sample;
}

/// Adds what camera and arm observe; false if the camera does not see all of it.
inline bool observe(const Robot& robot, bool floor, const OracleValues<double>& values,
                    Chance& chance, Sample& sample) {
  static const std::vector<Vector3<double>> kLeds = {
      {-0.01, -0.04, 0.01}, {-0.01, 0.04, 0.0}, {0.02, 0.03, -0.02}, {0.02, -0.02, -0.01}};
  const auto pose = [&](const std::string& link) {
    return oracle_pose(robot, "base_link", link, "", sample, values);
  };
  const OraclePose<double> camera = pose("head_camera_rgb_optical_frame");
  const OraclePose<double> gripper = pose("gripper_led_frame");
  const CameraInfo info = camera_info();
  Observation arm{"arm", {}}, seen{"camera", {}, info};
  for (std::size_t f = 0; f < (floor ? 60 : kLeds.size()); ++f) {
    Vector3<double> p;
    if (floor) {  // where a ray of the camera meets z = 0 of the base
      const Vector3<double> ray(chance(-0.5, 0.5), chance(-0.38, 0.38), 1.0);
      p = -camera.t.z() / (camera.r * ray).z() * ray;
    } else {
      arm.features.push_back({"gripper_led_frame", kLeds[f]});
      p = camera.inverse()(gripper(kLeds[f]));
    }
    const bool in_view = p.z() > 0.4 && p.z() < (floor ? 3.0 : 1.6) &&
                         std::abs(p.x()) <= 0.5 * p.z() && std::abs(p.y()) <= 0.38 * p.z();
    if (!in_view) return false;
    seen.features.push_back(
        {"head_camera_rgb_optical_frame", recorded_depth(info, p, "camera", values)});
  }
  if (!floor) sample.observations.push_back(arm);
  sample.observations.push_back(seen);
  return true;
}

}  // namespace fetch

/// The shipped Fetch; its head camera measures four LEDs in the gripper to 1 mm.
/// @param floor  number of samples of the floor in addition
inline Simulated fetch_and_leds(int count = 100, int floor = 0) {
  Chance chance(11);
  const Config config = fetch::config(floor > 0);
  Simulated all{"Fetch and LEDs",
                read_urdf(source_folder() + "/examples/robots/fetch/fetch.urdf"),
                config,
                {},
                {},
                "camera",
                1e-3,
                3,
                {"gripper_led_frame"},
                {"head_camera_rgb_optical_frame"}};
  all.truth = fetch::truth(all.robot, config.steps.front(), chance);
  ParameterTable table;
  for (const auto& [name, value] : all.truth) table.add({.name = name, .value = value});
  const Eigen::VectorXd numbers = table.values();
  const OracleValues<double> values(table, numbers);
  while (std::ssize(all.exact) < count + floor) {
    Sample sample = fetch::anywhere(all.robot, chance);
    sample.source = "fetch:" + std::to_string(all.exact.size());
    const bool of_floor = std::ssize(all.exact) >= count;
    if (fetch::observe(all.robot, of_floor, values, chance, sample)) {
      all.exact.push_back(std::move(sample));
    }
  }
  return all;
}

/// UR5 and laser tracker, at the 20 random poses of the shared data; the tracker measures to 0.1 mm.
inline Simulated ur5_and_tracker(const std::string& config = "full.yaml") {
  Scenario scenario =
      recorded("ur5_tracker/ur5.urdf", "ur5_tracker/" + config, "ur5_tracker/random.yaml");
  Simulated ur5{"UR5 and tracker",
                scenario.robot,
                scenario.config,
                scenario.samples,
                {},
                "tracker",
                1e-4,
                3,
                {"tool0", "smr"},
                {"base_link", "tracker_frame"}};
  const Calibration real = scenario.calibration();
  const CalibrationResult fit = calibrate(real);
  for (const int p : fit.calibrated) ur5.truth[fit.table[p].name] = fit.table[p].value;
  const Eigen::VectorXd all = fit.table.values();
  const OracleValues<double> values(fit.table, all);
  for (Sample& sample : ur5.exact) {
    const auto arm = oracle_pose(ur5.robot, ur5.config.base_link, "tool0", "smr", sample, values);
    for (Observation& seen : sample.observations) {
      if (seen.sensor != "tracker") continue;
      seen.features[0].point = oracle_frame("tracker_frame", values).inverse()(arm.t);
    }
  }
  return ur5;
}

/// A camera in a gantry's hand, and a board that it sees to 0.3 pixels.
inline Simulated camera_and_board() {
  const Scenario scenario = board_scenario(true, 3);
  Simulated board{
      "camera and board",     scenario.robot, scenario.config, scenario.samples, {}, "eye", 0.3, 2,
      {"base_link", "board"}, {"camera"}};
  ParameterTable table = scenario.calibration().table;
  board.truth = {{"turn_y", 0.026}, {"eye_fx", 0.01}, {"eye_fy", 0.008}};
  for (const auto& [frame, pose] : scenario.truth) {
    const Vector3<double> turn = log(pose.rotation);
    for (std::size_t k = 0; k < 6; ++k) {
      board.truth[parameter_name(frame, kFrameAxes[k])] =
          k < 3 ? pose.translation(static_cast<Eigen::Index>(k))
                : turn(static_cast<Eigen::Index>(k - 3));
    }
  }
  const Eigen::VectorXd all = board.truth_of(table);
  const OracleValues<double> values(table, all);
  for (Sample& sample : board.exact) {
    const auto camera = oracle_pose(board.robot, "base_link", "camera", "", sample, values);
    const auto corner = camera.inverse().then(oracle_frame("board", values));
    const std::vector<Vector3<double>> points = corners();
    for (Observation& seen : sample.observations) {
      if (seen.sensor != "eye") continue;
      for (std::size_t f = 0; f < points.size(); ++f) {
        const auto pixel = oracle_pixel(*seen.camera, corner(points[f]), "eye", values);
        seen.features[f].point = {pixel.x(), pixel.y(), 0.0};
      }
    }
  }
  return board;
}

}  // namespace kinecal::test
