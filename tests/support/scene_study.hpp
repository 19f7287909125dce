// A study of the scene: the arm holds LEDs, the camera sees them.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/study/repeatability.hpp"
#include "kinecal/study/true_robot.hpp"
#include "support/noisy_scene.hpp"

namespace kinecal::test {

/// LEDs on the hand.
inline std::vector<Feature> scene_leds() {
  std::vector<Feature> leds;
  for (const double x : {-0.05, 0.05}) {
    for (const double y : {-0.02, 0.03}) leds.push_back({"hand", {x, y, 0.01}});
  }
  return leds;
}

/// Samples of the scene in which the camera has the hand before it, with the LEDs as features of the
/// arm; what the camera saw is somewhere in front of it.
inline std::vector<Sample> samples_with_leds(int count) {
  constexpr double kNear = 0.3;  // metres
  const TrueRobot robot(mobile_manipulator(), {}, {});
  std::vector<Sample> samples;
  for (const Sample& sample : NoisyScene(40 * count).samples) {
    Positions positions;
    for (std::size_t i = 0; i < sample.joint_names.size(); ++i) {
      positions[sample.joint_names[i]] = sample.joint_positions[i];
    }
    const Vector3<double> hand = robot.pose("camera_optical_frame", "hand", positions).translation;
    if (hand.z() < kNear || hand.head<2>().norm() > hand.z()) continue;
    Sample with_leds = sample;
    std::erase_if(with_leds.observations, [](const Observation& o) { return o.sensor == "eye"; });
    for (Observation& seen : with_leds.observations) {
      if (seen.sensor == "arm") seen.features = scene_leds();
    }
    samples.push_back(with_leds);
    if (static_cast<int>(samples.size()) == count) break;
  }
  EXPECT_EQ(static_cast<int>(samples.size()), count);
  return samples;
}

/// A study with these samples.
struct SceneStudy {
  NoisyScene scene{1};
  StudySetup setup;

  SceneStudy() {
    setup.make = [this] { return scene.problem({}); };
    setup.free = scene.free().parameters();
    const Eigen::VectorXd drawn = scene_table().values();
    setup.drawn.assign(drawn.begin(), drawn.end());
    setup.samples = samples_with_leds(30);
    setup.frame = {"hand"};
    setup.in = {"camera_optical_frame"};
    setup.fit = [this](std::span<const Sample> samples) {
      Calibration calibration{table_with_units(), {}};
      calibration.steps.push_back(
          {"calibrate", 1000, scene.problem({samples.begin(), samples.end()}), scene.free(), {}});
      const CalibrationResult result = calibrate(calibration);
      const Eigen::VectorXd values = result.table.values();
      return StudyFit{result.converged, {values.begin(), values.end()}};
    };
  }
  SceneStudy(const SceneStudy&) = delete;
  SceneStudy& operator=(const SceneStudy&) = delete;
  ~SceneStudy() = default;
};

}  // namespace kinecal::test
