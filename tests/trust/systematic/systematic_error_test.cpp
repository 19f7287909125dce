// SPDX-License-Identifier: Apache-2.0
#include "kinecal/trust/systematic/systematic_error.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <random>

#include "kinecal/trust/judge.hpp"
#include "support/noisy_scene.hpp"
#include "support/photographs.hpp"
#include "support/pixel_scene.hpp"
#include "support/repetitions.hpp"

namespace kinecal {
namespace {

using testing::HasSubstr;

std::optional<SystematicError> error_in(test::NoisyScene& scene) {
  return scene.solve_and_assess({.folds = 0, .meter = {}}).systematic;
}

double position(const Sample& sample, const std::string& joint) {
  return sample.position(joint).value();
}

TEST(SystematicError, IsNoneInSamplesAsTheyShouldBe) {
  for (const int count : {8, 12, 20, 60}) {
    for (unsigned seed = 1; seed <= 50; ++seed) {
      test::NoisyScene scene(count, seed);
      EXPECT_FALSE(error_in(scene)) << count << " samples, seed " << seed;
    }
  }
}

TEST(SystematicError, IsNoneIfNothingIsLeftToExplain) {
  test::NoisyScene scene(40);
  scene.samples =
      test::exact_samples(test::scene_problem(), test::NoisyScene::span(scene.truth), 40);
  EXPECT_FALSE(error_in(scene));
}

TEST(JointError, FindsTheGearOfAJoint) {
  test::NoisyScene scene(40);
  test::misread(scene, "elbow", [](std::size_t, double q) { return 0.02 * q; });
  const auto found = error_in(scene);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->owner, "elbow");
  EXPECT_EQ(found->course, ErrorCourse::gear);
  EXPECT_NEAR(found->size, 0.02, 0.002);
  EXPECT_LT(found->noise_left, 0.5);
}

TEST(JointError, FindsAZeroThatIsHeld) {
  test::NoisyScene scene(40);
  std::erase(scene.names, "elbow");
  test::misread(scene, "elbow", [](std::size_t, double) { return 0.02; });
  const auto found = error_in(scene);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->owner, "elbow");
  EXPECT_EQ(found->course, ErrorCourse::zero);
}

TEST(JointError, FindsAnEccentricEncoder) {
  test::NoisyScene scene(40);
  test::misread(scene, "shoulder_lift",
                [](std::size_t, double q) { return 0.02 * std::sin(q + 1.0); });
  const auto found = error_in(scene);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->owner, "shoulder_lift");
  EXPECT_EQ(found->course, ErrorCourse::turn);
  EXPECT_NEAR(found->size, 0.02, 0.006);
}

TEST(JointError, FindsBacklashByTheDirectionOfMotion) {
  test::NoisyScene scene(40);
  const std::vector<Sample> before = scene.samples;
  test::misread(scene, "elbow", [&](std::size_t s, double q) {
    if (s == 0) return 0.0;
    return q > position(before[s - 1], "elbow") ? 0.01 : -0.01;
  });
  const auto found = error_in(scene);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->owner, "elbow");
  EXPECT_EQ(found->course, ErrorCourse::backlash);
  EXPECT_NEAR(found->size, 0.02, 0.002);
}

TEST(JointError, FindsSamplesThatWereTakenBeforeTheRobotStood) {
  test::NoisyScene scene(40);
  const std::vector<Sample> before = scene.samples;
  for (std::size_t s = 1; s < before.size(); ++s) {
    for (std::size_t j = 0; j < before[s].joint_positions.size(); ++j) {
      scene.samples[s].joint_positions[j] +=
          0.02 * (before[s].joint_positions[j] - before[s - 1].joint_positions[j]);
    }
  }
  const auto found = error_in(scene);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->course, ErrorCourse::lag);
  EXPECT_NEAR(found->size, 0.02, 0.003);
}

TEST(JointError, FindsAnAxisOfASensorWithAnotherScale) {
  test::NoisyScene scene(40);
  std::erase(scene.names, "camera_fx");
  for (Sample& sample : scene.samples) {
    for (Observation& seen : sample.observations) {
      if (seen.sensor != "camera") continue;
      for (Feature& feature : seen.features) feature.point.x() *= 1.03;
    }
  }
  const auto found = error_in(scene);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->owner, "camera");
  EXPECT_EQ(found->course, ErrorCourse::axis);
  EXPECT_THAT(found->text, HasSubstr("with the x of sensor 'camera' multiplied by 0.9"));
  EXPECT_NEAR(1.0 + found->size, 1.0 / 1.03, 0.005);
}

/// Named by five standard errors, however much noise is left.
TEST(JointError, FindsTheScaleOfASensor) {
  test::NoisyScene scene(40);
  for (const char* name : {"camera_fx", "camera_cy", "camera_z_scaling", "camera_z_offset"}) {
    std::erase(scene.names, name);
  }
  EXPECT_FALSE(error_in(scene));
  for (Sample& sample : scene.samples) {
    for (Observation& seen : sample.observations) {
      if (seen.sensor != "camera") continue;
      for (Feature& feature : seen.features) feature.point *= 1.03;
    }
  }
  const auto found = error_in(scene);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->owner, "camera");
  EXPECT_EQ(found->course, ErrorCourse::scale);
  EXPECT_NEAR(1.0 + found->size, 1.0 / 1.03, 0.005);
}

/// Moves a joint of all samples from one on: it slipped.
void slip(test::NoisyScene& scene, const char* joint, std::size_t from, double by) {
  test::misread(scene, joint, [=](std::size_t s, double) { return s < from ? 0.0 : -by; });
}

TEST(RecordingChange, OfAJointIsFoundWithItsPlace) {
  test::NoisyScene scene(40);
  slip(scene, "elbow", 25, 0.03);
  const auto found = error_in(scene);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->owner, "elbow");
  EXPECT_EQ(found->course, ErrorCourse::step);
  EXPECT_EQ(found->samples.front(), 25);
  EXPECT_LT(found->noise_left, 0.3);
}

TEST(RecordingChange, ThatIsADriftIsFoundWithItsSize) {
  test::NoisyScene scene(40);
  test::misread(scene, "elbow",
                [](std::size_t s, double) { return -0.04 * static_cast<double>(s) / 39.0; });
  const auto found = error_in(scene);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->owner, "elbow");
  EXPECT_EQ(found->course, ErrorCourse::drift);
  EXPECT_NEAR(found->size, 0.04, 0.004);
  EXPECT_THAT(sentence(*found), HasSubstr("'elbow' drifts by 2."));
  EXPECT_THAT(sentence(*found), HasSubstr(" deg from the first sample to the last: with an even "
                                          "drift, the noise falls to "));
  EXPECT_LT(found->noise_left, 0.4);
}

/// In poses sorted by a joint, an error that depends on the joint looks like a drift.
TEST(RecordingChange, SaysIfTheOrderOfSamplesIsThatOfTheirPoses) {
  for (const bool sorted : {false, true}) {
    test::NoisyScene scene(40);
    if (sorted) {
      std::sort(scene.samples.begin(), scene.samples.end(), [](const Sample& a, const Sample& b) {
        return position(a, "elbow") < position(b, "elbow");
      });
    }
    slip(scene, "elbow", 20, 0.05);
    const auto found = error_in(scene);
    ASSERT_TRUE(found);
    EXPECT_EQ(sentence(*found).ends_with("record in a random order"), sorted);
    EXPECT_EQ(found->refuse, !sorted && found->noise_left < 1.0 / 3.0);
  }
}

TEST(RecordingChange, IsSaidWithItsSizeAndPlace) {
  test::NoisyScene scene(40);
  slip(scene, "elbow", 25, 0.03);
  const auto found = error_in(scene);
  ASSERT_TRUE(found);
  EXPECT_THAT(found->text, HasSubstr("'elbow' seems to have changed by 1.7"));
  EXPECT_THAT(sentence(*found), HasSubstr("with one value before and another after, the noise "
                                          "falls to"));
}

TEST(RecordingChange, OfTheLastSamplesIsABadCapture) {
  test::NoisyScene scene(40);
  slip(scene, "elbow", 39, 0.03);
  EXPECT_FALSE(error_in(scene));
}

/// A third of the samples, here and there, has another elbow.
TEST(RecordingChange, OfSamplesHereAndThereIsFoundWithThem) {
  test::NoisyScene scene(40);
  test::misread(scene, "elbow", [](std::size_t s, double) { return s % 3 == 0 ? -0.03 : 0.0; });
  const auto found = error_in(scene);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->owner, "elbow");
  EXPECT_EQ(found->samples.size(), 14u);
}

/// A joint that does not repeat is no two joints.
TEST(RecordingChange, IsNoneOfAJointThatScatters) {
  for (unsigned seed = 1; seed <= 10; ++seed) {
    test::NoisyScene scene(40, seed);
    std::mt19937 random(seed);
    std::normal_distribution<double> scatter(0.0, 0.02);
    test::misread(scene, "elbow", [&](std::size_t, double) { return scatter(random); });
    EXPECT_FALSE(error_in(scene)) << seed;
  }
}

TEST(RecordingChange, OfAPartInTheMiddleIsFoundWithItsEnds) {
  test::NoisyScene scene(48);
  test::misread(scene, "elbow",
                [](std::size_t s, double) { return s >= 15 && s < 33 ? -0.03 : 0.0; });
  const auto found = error_in(scene);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->owner, "elbow");
  EXPECT_EQ(found->course, ErrorCourse::interval);
  EXPECT_NEAR(found->samples.front(), 15, 3);
  EXPECT_NEAR(found->samples.back(), 32, 3);
  EXPECT_LT(found->noise_left, 0.6);
}

TEST(RecordingChange, HereAndThereIsThatOfTwoRobots) {
  test::NoisyScene scene(40);
  for (const char* joint : {"elbow", "shoulder_lift"}) {
    test::misread(scene, joint, [](std::size_t s, double) { return s % 2 == 0 ? 0.0 : -0.02; });
  }
  const auto found = error_in(scene);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->owner, "") << "the zeros of all joints";
  EXPECT_EQ(found->samples.size(), 20u);
  EXPECT_LT(found->noise_left, 0.5);
}

/// Of "(-3.1 px at 900 px)", pixels.
double pixels_of(const SystematicError& error) {
  double pixels = std::nan("");
  EXPECT_EQ(std::sscanf(error.text.c_str() + error.text.find('('), "(%lf px", &pixels), 1);
  return pixels;
}

TEST(LensError, FindsK1OfBoardsWithItsSize) {
  for (const double k1 : {0.05, -0.05, 0.1, -0.1, 0.2, -0.2, 0.3, -0.3}) {
    const auto found = test::PixelScene{.k1 = k1}.found();
    ASSERT_TRUE(found) << k1;
    EXPECT_EQ(found->owner, "eye");
    EXPECT_THAT(found->text, HasSubstr("camera_info has no distortion"));
    constexpr double kLinear = 0.3;  // the fit is linearized, and other parameters have moved
    EXPECT_NEAR(found->size, k1, kLinear * std::abs(k1)) << k1;
    EXPECT_GT(pixels_of(*found) * k1, 0.0) << k1;
    EXPECT_LT(found->noise_left, 0.95) << k1;
  }
}

TEST(LensError, FindsK1OfAnArmWithFourFeatures) {
  for (const double k1 : {0.05, -0.1, 0.2, -0.3}) {
    EXPECT_TRUE((test::PixelScene{.count = 40, .columns = 2, .rows = 2, .k1 = k1}.found())) << k1;
  }
}

/// Joints that do not repeat move all features of a view: these are one error, not thirty-five.
TEST(LensError, FindsK1BesideJointsThatDoNotRepeat) {
  for (const double k1 : {-0.1, 0.2, -0.3}) {
    EXPECT_TRUE((test::PixelScene{.k1 = k1, .joints = 1e-3}.found())) << k1;
  }
}

TEST(LensError, FindsK1BesideFreeIntrinsics) {
  test::PixelScene scene{.k1 = -0.1};
  for (const char* name : {"eye_fx", "eye_fy", "eye_cx", "eye_cy"}) scene.free.emplace_back(name);
  EXPECT_TRUE(scene.found());
}

/// Free parameters absorb most of a lens: the reported pixels are the part that is left in residuals.
TEST(LensError, ReportsPixelsThatResidualsShow) {
  test::PixelScene scene{.k1 = -0.3};
  for (const char* name : {"eye_fx", "eye_fy", "eye_cx", "eye_cy"}) scene.free.emplace_back(name);
  const JudgedResult judged = scene.judged();
  const std::optional<SystematicError>& found = judged.assessments.back().systematic;
  ASSERT_TRUE(found);
  EXPECT_LT(std::abs(pixels_of(*found)), judged.result.blocks.front().after.max);
  EXPECT_LT(pixels_of(*found), 0.0);
}

/// Free coefficients look like k1: what is left is chance.
TEST(LensError, IsNoneOfALensWithFreeCoefficients) {
  const std::vector<std::string> free = {"fx", "fy", "cx", "cy", "k1", "k2", "k3", "k4"};
  for (unsigned seed = 1; seed <= 10; ++seed) {
    const test::Photographs photographs(test::fisheye_camera(390.0), "equidistant",
                                        {.views = 30, .noise = 0.5, .aside = 2.5, .seed = seed});
    Calibration calibration = photographs.calibration(free);
    const JudgedResult judged = calibrate_and_judge(calibration, photographs.samples);
    EXPECT_FALSE(judged.assessments.back().systematic) << seed;
  }
}

TEST(LensError, FindsALensOtherThanTheGivenOne) {
  const auto found = test::PixelScene{.k1 = -0.1, .taken = {-0.3, 0.0, 0.0, 0.0, 0.0}}.found();
  ASSERT_TRUE(found);
  EXPECT_THAT(found->text, HasSubstr("camera_info is not that of its lens"));
  EXPECT_NEAR(found->size, 0.2, 0.08);
}

/// Boards and arms; joints that repeat or do not; a focal length that is held and wrong: at most 1 in 100.
TEST(LensError, IsNoneInPinholes) {
  const std::vector<test::PixelScene> good = {
      {},
      {.count = 12, .joints = 1e-3},
      {.joints = 1e-3},
      {.count = 40, .columns = 2, .rows = 2},
      {.count = 20, .columns = 2, .rows = 2, .joints = 1e-3},
      {.focal = 1.03}};
  const int draws = test::repetitions(50, 5);
  int alarms = 0;
  for (test::PixelScene scene : good) {
    for (int draw = 1; draw <= draws; ++draw) {
      scene.seed = static_cast<unsigned>(draw);
      alarms += scene.found() ? 1 : 0;
    }
  }
  EXPECT_LE(alarms, draws * static_cast<int>(good.size()) / 100);
}

/// A lens that is given as it is, and samples without noise.
TEST(LensError, IsNoneWhereNothingIsLeftToExplain) {
  const std::vector<double> lens = {-0.2, 0.05, 0.0, 0.0, 0.0};
  EXPECT_FALSE((test::PixelScene{.k1 = -0.2, .k2 = 0.05, .taken = lens}.found()));
  EXPECT_FALSE((test::PixelScene{.noise = 0.0}.found()));
}

TEST(LensError, IsTheCauseInFrontOfWhatItExplains) {
  const JudgedResult judged = test::PixelScene{.k1 = -0.3}.judged();
  const Judgement& judgement = judged.judgement;
  EXPECT_EQ(judgement.verdict, Grade::use_with_care);
  ASSERT_FALSE(judgement.reasons.empty());
  EXPECT_EQ(judgement.causes, 1);
  EXPECT_THAT(
      judgement.reasons.front(),
      HasSubstr("residuals of 'eye' grow with the distance from the center of the image (-"));
  EXPECT_THAT(judgement.reasons.front(), HasSubstr("its lens is distorted"));
  EXPECT_TRUE(judged.left_out.empty());  // not the samples are wrong
}

}  // namespace
}  // namespace kinecal
