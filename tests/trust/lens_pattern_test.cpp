// SPDX-License-Identifier: Apache-2.0
#include "kinecal/trust/lens_pattern.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "support/photographs.hpp"
#include "support/pixel_scene.hpp"
#include "support/repetitions.hpp"

namespace kinecal {
namespace {

using testing::HasSubstr;

TEST(LensPattern, FindsK1OfBoardsWithItsSize) {
  for (const double k1 : {0.05, -0.05, 0.1, -0.1, 0.2, -0.2, 0.3, -0.3}) {
    const auto found = test::PixelScene{.k1 = k1}.found();
    ASSERT_TRUE(found) << k1;
    EXPECT_EQ(found->sensor, "eye");
    EXPECT_EQ(found->taken, TakenLens::none);
    constexpr double kLinear = 0.3;  // the fit is linearized, and other parameters have moved
    EXPECT_NEAR(found->k1, k1, kLinear * std::abs(k1)) << k1;
    EXPECT_GT(found->pixels * k1, 0.0) << k1;
    EXPECT_LT(found->noise_left, 0.95) << k1;
  }
}

TEST(LensPattern, FindsK1OfAnArmWithFourFeatures) {
  for (const double k1 : {0.05, -0.1, 0.2, -0.3}) {
    EXPECT_TRUE((test::PixelScene{.count = 40, .columns = 2, .rows = 2, .k1 = k1}.found())) << k1;
  }
}

/// Joints that do not repeat move all features of a view: these are one error, not thirty-five.
TEST(LensPattern, FindsK1BesideJointsThatDoNotRepeat) {
  for (const double k1 : {-0.1, 0.2, -0.3}) {
    EXPECT_TRUE((test::PixelScene{.k1 = k1, .joints = 1e-3}.found())) << k1;
  }
}

TEST(LensPattern, FindsK1BesideFreeIntrinsics) {
  test::PixelScene scene{.k1 = -0.1};
  for (const char* name : {"eye_fx", "eye_fy", "eye_cx", "eye_cy"}) scene.free.emplace_back(name);
  EXPECT_TRUE(scene.found());
}

/// Free parameters absorb most of a lens: the reported pixels are the part that is left in residuals.
TEST(LensPattern, ReportsPixelsThatResidualsShow) {
  test::PixelScene scene{.k1 = -0.3};
  for (const char* name : {"eye_fx", "eye_fy", "eye_cx", "eye_cy"}) scene.free.emplace_back(name);
  const JudgedResult judged = scene.judged();
  const std::optional<LensPattern>& found = judged.assessments.back().lens;
  ASSERT_TRUE(found);
  EXPECT_LT(std::abs(found->pixels), judged.result.blocks.front().after.max);
  EXPECT_LT(found->pixels, 0.0);
}

/// Free coefficients look like k1: what is left is chance.
TEST(LensPattern, IsNoneOfALensWithFreeCoefficients) {
  const std::vector<std::string> free = {"fx", "fy", "cx", "cy", "k1", "k2", "k3", "k4"};
  for (unsigned seed = 1; seed <= 10; ++seed) {
    const test::Photographs photographs(test::fisheye_camera(390.0), "equidistant",
                                        {.views = 30, .noise = 0.5, .aside = 2.5, .seed = seed});
    Calibration calibration = photographs.calibration(free);
    const JudgedResult judged = calibrate_and_judge(calibration, photographs.samples);
    EXPECT_FALSE(judged.assessments.back().lens) << seed;
  }
}

TEST(LensPattern, FindsALensOtherThanTheGivenOne) {
  const auto found = test::PixelScene{.k1 = -0.1, .taken = {-0.3, 0.0, 0.0, 0.0, 0.0}}.found();
  ASSERT_TRUE(found);
  EXPECT_EQ(found->taken, TakenLens::given);
  EXPECT_NEAR(found->k1, 0.2, 0.08);
}

/// Boards and arms; joints that repeat or do not; a focal length that is held and wrong: at most 1 in 100.
TEST(LensPattern, IsNoneInPinholes) {
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
TEST(LensPattern, IsNoneWhereNothingIsLeftToExplain) {
  const std::vector<double> lens = {-0.2, 0.05, 0.0, 0.0, 0.0};
  EXPECT_FALSE((test::PixelScene{.k1 = -0.2, .k2 = 0.05, .taken = lens}.found()));
  EXPECT_FALSE((test::PixelScene{.noise = 0.0}.found()));
}

TEST(LensPattern, IsTheCauseInFrontOfWhatItExplains) {
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
