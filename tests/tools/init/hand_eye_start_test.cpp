// The general search finds the start of a hand-eye calibration: a closed form is not needed.
#include <gtest/gtest.h>

#include <cstdio>
#include <fstream>

#include "kinecal/config/assemble.hpp"
#include "kinecal/files/poses/hand_eye_samples.hpp"
#include "kinecal/files/urdf/read_urdf.hpp"
#include "kinecal/solve/calibrate.hpp"
#include "kinecal/tools/init/hand_eye.hpp"
#include "support/hand_eye_poses.hpp"
#include "support/repetitions.hpp"
#include "support/temporary_folder.hpp"

namespace kinecal {
namespace {

/// Distance of the camera found from its true place, metres.
double calibrated_error(bool on_hand, int count, std::uint64_t seed) {
  const test::TemporaryFolder folder;
  const std::string file = (folder.path() / "samples.yaml").string();
  const test::HandEyePoses poses(on_hand, count, seed);
  std::ofstream(file) << poses.moveit_text();
  Diagnostics diagnostics;
  const std::vector<Sample> samples = read_hand_eye_samples(file, {}, diagnostics);
  const Calibration calibration =
      assemble(test::config_of(hand_eye_pose_config(on_hand)),
               parse_urdf(hand_eye_urdf(on_hand), "hand_eye.urdf"), samples, diagnostics);
  diagnostics.throw_if_errors();
  const CalibrationResult result = calibrate(calibration, {}, {});
  Vector3<double> found;
  for (int k = 0; k < 3; ++k) {
    const std::string name = std::string(HandEyeNames::kCameraJoint) + "_" + "xyz"[k];
    found(k) = result.table[result.table.index(name)].value;
  }
  return (found - poses.mount.translation).norm();
}

/// Noise of 1 mm and 5 mrad moves the camera by a few millimetres, a wrong minimum by decimetres.
TEST(HandEyeStart, IsFoundFromFourToTwelvePoses) {
  constexpr double kFound = 0.05;  // metres; four poses may turn little about a second axis
  const int runs = test::repetitions_of_study(200, 20);
  for (const bool on_hand : {true, false}) {
    int found = 0;
    double worst = 0.0;
    for (int run = 0; run < runs; ++run) {
      const double error = calibrated_error(on_hand, 4 + run % 9, 100 + std::uint64_t(run));
      found += error < kFound ? 1 : 0;
      worst = std::max(worst, error);
    }
    std::printf("camera %s: %d of %d found, the worst %.1f mm off\n",
                on_hand ? "on the hand" : "beside the robot", found, runs, 1e3 * worst);
    EXPECT_EQ(found, runs);
  }
}

}  // namespace
}  // namespace kinecal
