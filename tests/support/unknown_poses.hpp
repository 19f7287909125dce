// Calibrations in which nobody gives the pose of a tracker, a board or a camera.
//
// Real recordings, with what the tracker measured moved by any rigid motion; and a gantry whose hand
// carries a camera that sees a board on the table, or a board that a camera on a bracket sees.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "kinecal/config/assemble.hpp"
#include "kinecal/config/read_config.hpp"
#include "kinecal/files/samples/read_samples.hpp"
#include "kinecal/files/urdf/read_urdf.hpp"
#include "support/camera_infos.hpp"
#include "support/data.hpp"
#include "support/temporary_folder.hpp"

namespace kinecal::test {

/// Random numbers that are the same with every library.
class Chance {
 public:
  explicit Chance(std::uint64_t seed) : engine_(seed) { engine_.discard(16); }
  double operator()(double lower, double upper) {
    return lower + static_cast<double>(engine_() >> 11) * 0x1p-53 * (upper - lower);
  }
  double normal() {
    const double radius = std::sqrt(-2.0 * std::log1p(-(*this)(0.0, 1.0)));
    return radius * std::cos(2.0 * std::numbers::pi * (*this)(0.0, 1.0));
  }
  Vector3<double> box(double half) {
    const double x = (*this)(-half, half), y = (*this)(-half, half), z = (*this)(-half, half);
    return {x, y, z};
  }
  /// Any rotation, uniformly.
  Matrix3<double> rotation() {
    const double w = normal(), x = normal(), y = normal(), z = normal();
    return Eigen::Quaterniond(w, x, y, z).normalized().toRotationMatrix();
  }
  Pose<double> pose(double half) {
    const Matrix3<double> turn = rotation();
    return {turn, box(half)};
  }

 private:
  std::mt19937_64 engine_;
};

/// What is needed to calibrate again and again.
struct Scenario {
  Robot robot;
  Config config;
  std::vector<Sample> samples;
  /// The frames' true poses, by name; empty if nobody knows them.
  std::vector<std::pair<std::string, Pose<double>>> truth;

  [[nodiscard]] Calibration calibration() const {
    Diagnostics diagnostics;
    Calibration all = assemble(config, robot, samples, diagnostics);
    diagnostics.throw_if_errors();
    return all;
  }
};

inline Config config_of(const std::string& text) {
  const TemporaryFolder folder;
  Diagnostics diagnostics;
  const std::string file = (folder.path() / "calibrate.yaml").string();
  std::ofstream(file) << text;
  Config config = read_config(file, diagnostics);
  diagnostics.throw_if_errors();
  return config;
}

/// A recording of the shared data.  Initial values of frames are forgotten.
inline Scenario recorded(const std::string& urdf, const std::string& config,
                         const std::string& samples) {
  Diagnostics diagnostics;
  Scenario scenario{read_urdf((data_folder() / urdf).string()),
                    read_config((data_folder() / config).string(), diagnostics),
                    read_samples((data_folder() / samples).string(), diagnostics),
                    {}};
  diagnostics.throw_if_errors();
  for (StepConfig& step : scenario.config.steps) step.frame_initial_values.clear();
  return scenario;
}

/// Moves what a sensor measured, as if it stood elsewhere.
inline void move_sensor(std::vector<Sample>& samples, const std::string& sensor,
                        const Pose<double>& motion) {
  for (Sample& sample : samples) {
    for (Observation& seen : sample.observations) {
      if (seen.sensor != sensor) continue;
      for (Feature& feature : seen.features) feature.point = motion * feature.point;
    }
  }
}

// ---- a camera and a board

/// Slides along x, y, z, and turns about z, y, x: it reaches every pose.
inline Robot gantry(const std::string& camera_parent) {
  using enum JointType;
  const Pose<double> here{Matrix3<double>::Identity(), {0, 0, 0}};
  return Robot("gantry", {{"slide_x", prismatic, "base_link", "x", here, {1, 0, 0}},
                          {"slide_y", prismatic, "x", "y", here, {0, 1, 0}},
                          {"slide_z", prismatic, "y", "z", here, {0, 0, 1}},
                          {"turn_z", revolute, "z", "yaw", here, {0, 0, 1}},
                          {"turn_y", revolute, "yaw", "pitch", here, {0, 1, 0}},
                          {"turn_x", revolute, "pitch", "hand", here, {1, 0, 0}},
                          {"bracket", fixed, camera_parent, "camera", here}});
}

inline const char* kBoardConfig = R"(
base_link: base_link
models:
 - {name: board_holder, type: chain, frame: HOLDER}
 - {name: eye, type: camera2d, frame: camera}
free_params: [turn_y, eye_fx, eye_fy]
free_frames:
 - {name: bracket, x: true, y: true, z: true, roll: true, pitch: true, yaw: true}
 - {name: board, x: true, y: true, z: true, roll: true, pitch: true, yaw: true}
error_blocks:
 - {name: pixels, type: chain3d_to_camera2d, model_3d: board_holder, model_2d: eye}
)";

/// Corners of the board, 7 x 5, 3 cm apart.
inline std::vector<Vector3<double>> corners() {
  std::vector<Vector3<double>> all;
  for (int row = 0; row < 5; ++row) {
    for (int column = 0; column < 7; ++column) all.push_back({0.03 * column, 0.03 * row, 0.0});
  }
  return all;
}

/// A view of the board's face: 0.3 to 0.7 m away, tilted by up to 40 degrees, all of it in the image.
inline Pose<double> view(Chance& chance) {
  const double kDegree = std::numbers::pi / 180.0;
  const Vector3<double> tilt =
      chance(5, 40) * kDegree * Vector3<double>(chance.normal(), chance.normal(), 0.0).normalized();
  const Vector3<double> roll(0.0, 0.0, chance(-60, 60) * kDegree);
  const double z = chance(0.3, 0.7), x = chance(-0.1, 0.1) * z, y = chance(-0.1, 0.1) * z;
  Pose<double> camera_T_board{Matrix3<double>(exp(tilt) * exp(roll)), {x, y, z}};
  camera_T_board.translation -= camera_T_board.rotation * Vector3<double>(0.09, 0.06, 0.0);
  return camera_T_board;
}

/// Joint positions at which the hand has a pose.
inline Sample at(const Pose<double>& base_T_hand) {
  const Matrix3<double>& r = base_T_hand.rotation;
  Sample sample;
  sample.joint_names = {"slide_x", "slide_y", "slide_z", "turn_z", "turn_y", "turn_x"};
  const Vector3<double>& t = base_T_hand.translation;
  sample.joint_positions = {t.x(),
                            t.y(),
                            t.z(),
                            std::atan2(r(1, 0), r(0, 0)),
                            std::atan2(-r(2, 0), std::hypot(r(2, 1), r(2, 2))),
                            std::atan2(r(2, 1), r(2, 2))};
  return sample;
}

/// A camera and a board whose poses are anything, 0.3 pixels of noise, a joint 1.5 degrees off.
/// @param in_hand  the camera is in the hand and the board on the table; or the reverse
inline Scenario board_scenario(bool in_hand, std::uint64_t seed, int count = 25) {
  Chance chance(seed);
  std::string text = kBoardConfig;
  text.replace(text.find("HOLDER"), 6, in_hand ? "base_link" : "hand");
  Scenario scenario{gantry(in_hand ? "hand" : "base_link"), config_of(text), {}, {}};
  const Pose<double> bracket = chance.pose(in_hand ? 0.2 : 2.0),
                     board = chance.pose(in_hand ? 2.0 : 0.2);
  scenario.truth = {{"bracket", bracket}, {"board", board}};
  const double focal = 1.01, offset = 1.5 * std::numbers::pi / 180.0;
  for (int n = 0; n < count; ++n) {
    const Pose<double> camera_T_board = view(chance);
    Sample sample = at(in_hand ? board * camera_T_board.inverse() * bracket.inverse()
                               : bracket * camera_T_board * board.inverse());
    sample.source = "board:" + std::to_string(n);
    sample.joint_positions[4] -= offset;
    Observation holder{"board_holder", {}}, eye{"eye", {}, camera_info()};
    for (const Vector3<double>& corner : corners()) {
      const Vector3<double> p = camera_T_board * corner;
      holder.features.push_back({"board", corner});
      eye.features.push_back({"camera",
                              {550 * focal * p.x() / p.z() + 320 + 0.3 * chance.normal(),
                               545 * focal * p.y() / p.z() + 240 + 0.3 * chance.normal(), 0.0}});
    }
    sample.observations = {holder, eye};
    scenario.samples.push_back(std::move(sample));
  }
  return scenario;
}

/// The cost from the truth, with everything free.
inline double cost_from_truth(const Scenario& scenario, const Calibration& calibration) {
  Eigen::VectorXd values = calibration.table.values();
  for (const auto& [frame, pose] : scenario.truth) {
    Eigen::Matrix<double, 6, 1> numbers;
    numbers << pose.translation, log(pose.rotation);
    for (std::size_t k = 0; k < 6; ++k) {
      values(calibration.table.index(parameter_name(frame, kFrameAxes[k]))) =
          numbers(static_cast<Eigen::Index>(k));
    }
  }
  const CalibrationStep& step = calibration.steps.front();
  return solve(*step.problem, step.free, values).final_cost;
}

}  // namespace kinecal::test
