// Monte Carlo: the truth is within the +- of simulated hand-eye calibrations, from no guess.
#include <gtest/gtest.h>

#include "kinecal/tools/init/hand_eye.hpp"
#include "support/interval_coverage.hpp"
#include "support/unknown_poses.hpp"

namespace kinecal {
namespace {

using test::Chance, test::IntervalCoverage;

constexpr double kPixelNoise = 0.3;

/// A camera of known intrinsics on the hand, or beside the robot; exact poses of the flange.
void cover_hand_eye(IntervalCoverage& coverage, bool on_hand, std::uint64_t seed) {
  using Names = HandEyeNames;
  Chance chance(seed);
  const Pose<double> mount = chance.pose(on_hand ? 0.2 : 1.5),
                     board = chance.pose(on_hand ? 1.5 : 0.2);
  std::vector<Sample> samples;
  for (int n = 0; n < 15; ++n) {
    const Pose<double> camera_T_board = test::view(chance);
    Sample sample;
    sample.source = "view " + std::to_string(n);
    sample.poses[Names::kFlangeJoint] = on_hand ? board * camera_T_board.inverse() * mount.inverse()
                                                : mount * camera_T_board * board.inverse();
    Observation holder{Names::kObject, {}, {}}, eye{Names::kCamera, {}, test::camera_info()};
    for (const Vector3<double>& corner : test::corners()) {
      const Vector3<double> p = camera_T_board * corner;
      const double u = 550 * p.x() / p.z() + 320 + kPixelNoise * chance.normal();
      const double v = 545 * p.y() / p.z() + 240 + kPixelNoise * chance.normal();
      holder.features.push_back({Names::kTarget, corner});
      eye.features.push_back({Names::kCamera, {u, v, 0.0}});
    }
    sample.observations = {holder, eye};
    samples.push_back(sample);
  }
  const std::string free = ", x: true, y: true, z: true, roll: true, pitch: true, yaw: true}\n";
  const Config config = test::config_of(
      std::string("base_link: base_link\nmodels:\n - {name: object, type: chain3d, frame: ") +
      (on_hand ? "base_link" : "flange") +
      "}\n - {name: camera, type: camera2d, frame: camera}\nfree_frames:\n - {name: camera_joint" +
      free + " - {name: target" + free +
      "error_blocks:\n - {name: pixels, type: chain3d_to_camera2d, model_3d: object, model_2d: "
      "camera}\n");
  Diagnostics diagnostics;
  const Calibration calibration =
      assemble(config, parse_urdf(hand_eye_urdf(on_hand), "hand_eye.urdf"), samples, diagnostics);
  diagnostics.throw_if_errors();
  const CalibrationResult result = calibrate(calibration);
  coverage.add(result, test::assessment_of(calibration, result, samples),
               [&](const std::string& name) {
                 return test::of_frame(name.back(), name.starts_with("target_") ? board : mount);
               });
}

TEST(HandEyeCoverage, OfACameraOnTheHandAndBesideTheRobot) {
  for (const bool on_hand : {true, false}) {
    IntervalCoverage coverage(on_hand ? "hand-eye, camera on the hand"
                                      : "hand-eye, camera beside the robot");
    const int runs = test::repetitions_of_study(200, 12);
    for (int run = 0; run < runs; ++run)
      cover_hand_eye(coverage, on_hand, (on_hand ? 4000 : 5000) + std::uint64_t(run));
    coverage.check();
  }
}

}  // namespace
}  // namespace kinecal
