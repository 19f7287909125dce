// Calibrations of an arm and a camera by pixels, with a lens that can be another than camera_info says.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

#include "kinecal/evaluation/any_evaluator.hpp"
#include "support/noisy_scene.hpp"

namespace kinecal::test {

/// A camera that looks at features of the hand: a board's corners, or a few LEDs.
struct PixelScene {
  static constexpr std::size_t kOff = 3;
  int count = 30;             ///< samples
  int columns = 7, rows = 5;  ///< of the board; 2 x 2 are LEDs
  double k1 = 0.0, k2 = 0.0;  ///< of the lens
  double noise = 0.3;         ///< pixels
  double joints = 0.0;        ///< radians, by which joints do not repeat
  double focal = 1.0;         ///< true over recorded focal length
  unsigned seed = 1;
  std::optional<double> sigma = {};  ///< stated, pixels
  double off = 0.0;                  ///< pixels, by which features of the sample kOff are off
  std::vector<double> taken = {};    ///< distortion in camera_info
  std::vector<std::string> free = {"shoulder_lift", "elbow",      "wrist",     "head_tilt",
                                   "head_pan_x",    "head_pan_y", "head_pan_z"};

  [[nodiscard]] CameraInfo info() const {
    CameraInfo info = camera_info();
    if (!taken.empty()) info.d = taken;
    return info;
  }

  /// Places of a flat board in the frame of the camera, metres.
  [[nodiscard]] std::vector<Vector3<double>> board(std::mt19937& random) const {
    std::uniform_real_distribution<double> side(-0.25, 0.25), depth(0.5, 0.9), tilt(-0.6, 0.6);
    const double z = depth(random);
    const Vector3<double> middle{side(random) * z, 0.8 * side(random) * z, z};
    const Vector3<double> turn{tilt(random), tilt(random), tilt(random)};
    const Pose<double> pose{exp(turn), middle};
    std::vector<Vector3<double>> corners;
    constexpr double kWidth = 0.3, kHeight = 0.2;
    for (int r = 0; r < rows; ++r) {
      for (int c = 0; c < columns; ++c) {
        corners.push_back(pose * Vector3<double>{kWidth * (c / (columns - 1.0) - 0.5),
                                                 kHeight * (r / (rows - 1.0) - 0.5), 0.0});
      }
    }
    return corners;
  }

  /// The pixel that the lens shows.
  [[nodiscard]] Eigen::Vector2d pixel(const Vector3<double>& p) const {
    const CameraInfo of = info();
    const double x = p.x() / p.z(), y = p.y() / p.z(), r2 = x * x + y * y;
    const double radial = 1.0 + k1 * r2 + k2 * r2 * r2;
    return {of.k[0] * focal * x * radial + of.k[2], of.k[4] * focal * y * radial + of.k[5]};
  }

  [[nodiscard]] std::vector<Sample> samples() const {
    const auto scene = scene_problem();
    const Eigen::VectorXd truth = scene.table().values();
    const auto values = NoisyScene::span(truth);
    std::vector<Sample> all = exact_samples(scene, values, count, "hand", seed);
    std::mt19937 random(seed + 4000);
    std::normal_distribution<double> normal;
    for (Sample& sample : all) {
      const auto tip = [&](std::size_t sensor, const std::string& frame) {
        return tip_pose(scene, sensor, frame, sample, values);
      };
      const Pose<double> hand_T_camera = tip(0, "hand").inverse() * tip(1, "camera_optical_frame");
      Observation arm{"arm", {}}, eye{"eye", {}, info()};
      for (const Vector3<double>& p : board(random)) {
        arm.features.push_back({"hand", hand_T_camera * p});
        const Eigen::Vector2d seen = pixel(p);
        const double u = noise * normal(random), v = noise * normal(random);
        const double by = &sample == &all[kOff] ? off : 0.0;
        eye.features.push_back({"camera_optical_frame", {seen.x() + u + by, seen.y() + v, 0}});
      }
      for (double& q : sample.joint_positions) q += joints * normal(random);
      sample.observations = {arm, eye};
    }
    return all;
  }

  /// A problem without samples.
  [[nodiscard]] std::unique_ptr<AnyProblem> problem() const {
    std::unique_ptr<AnyProblem> made =
        make_problem(mobile_manipulator(), "base_link", table_with_units(), kSceneFrames);
    made->add_built_in(ChainPoint{}, {"arm", "hand"});
    made->add_built_in(PinholeCamera{}, {"eye", "camera_optical_frame"});
    made->add_built_in("pixels", PointToPixel{}, {"arm", "eye"}, {.sigma = sigma});
    return made;
  }
  [[nodiscard]] FreeSet free_set() const { return free_of(table_with_units(), free); }

  /// Calibrates and judges.
  [[nodiscard]] JudgedResult judged() const {
    const std::vector<Sample> all = samples();
    std::unique_ptr<AnyProblem> filled = problem();
    for (const Sample& sample : all) filled->add_sample(sample);
    Calibration calibration{table_with_units(), {}};
    calibration.steps.push_back({"calibrate", 1000, std::move(filled), free_set(), {}});
    return calibrate_and_judge(calibration, all);
  }
  [[nodiscard]] std::optional<SystematicError> found() const {
    const JudgedResult of = judged();
    EXPECT_FALSE(of.assessments.empty());
    return of.assessments.empty() ? std::nullopt : of.assessments.back().systematic;
  }
};

}  // namespace kinecal::test
