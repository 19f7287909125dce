#include "kinecal/tools/init/hand_eye_fit.hpp"

#include <gtest/gtest.h>

#include <fstream>

#include "kinecal/files/poses/hand_eye_samples.hpp"
#include "support/hand_eye_poses.hpp"
#include "support/temporary_folder.hpp"

namespace kinecal {
namespace {

std::vector<Sample> samples_of(const test::HandEyePoses& poses) {
  const test::TemporaryFolder folder;
  const std::string file = (folder.path() / "samples.yaml").string();
  std::ofstream(file) << poses.moveit_text();
  Diagnostics diagnostics;
  std::vector<Sample> samples = read_hand_eye_samples(file, {}, diagnostics);
  diagnostics.throw_if_errors();
  return samples;
}

TEST(HandEyeFit, IsExactWithoutNoise) {
  for (const bool on_hand : {true, false}) {
    const test::HandEyePoses poses(on_hand, 6, 3, test::FlangeTurns::any, 0.0, 0.0);
    const HandEyeFit fit = fit_hand_eye(samples_of(poses), on_hand);
    EXPECT_LE(fit.difference, 1e-9);
    EXPECT_LE((fit.mount.translation - poses.mount.translation).norm(), 1e-8);
    EXPECT_LE((fit.mount.rotation - poses.mount.rotation).norm(), 1e-8);
  }
}

/// With six poses or more, 1 mm and 5 mrad of noise.
TEST(HandEyeFit, TellsWhereTheCameraIs) {
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    const bool on_hand = seed % 2 == 0;
    const test::HandEyePoses poses(on_hand, 6 + static_cast<int>(seed % 7), 500 + seed);
    const std::vector<Sample> samples = samples_of(poses);
    const HandEyeFit right = fit_hand_eye(samples, on_hand);
    EXPECT_GT(fit_hand_eye(samples, !on_hand).difference, 3.0 * right.difference) << seed;
    EXPECT_LE((right.mount.translation - poses.mount.translation).norm(), 0.03) << seed;
  }
}

}  // namespace
}  // namespace kinecal
