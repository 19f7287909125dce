#include "kinecal/trust/judge_input.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "kinecal/trust/calibrate_and_judge.hpp"
#include "support/noisy_scene.hpp"

namespace kinecal {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

/// The procedure with these samples.
JudgedResult judged(const test::NoisyScene& scene, const std::vector<std::string>& doubts = {}) {
  Calibration calibration = make_calibration(scene.problem({}), scene.free(), scene.samples);
  ProcedureOptions options;
  options.doubts = doubts;
  return calibrate_and_judge(calibration, scene.samples, options);
}
Observation& camera_of(Sample& sample) {
  return sample.observations[0].sensor == "camera" ? sample.observations[0]
                                                   : sample.observations[1];
}

TEST(JudgeInput, SaysNothingOfSamplesThatAreUsed) {
  test::NoisyScene scene(40);
  for (Sample& sample : scene.samples) sample.observations.push_back({"gripper", {}, {}});
  const JudgedResult result = judged(scene);
  EXPECT_THAT(result.unused, IsEmpty());
  EXPECT_THAT(result.judgement.reasons, IsEmpty());
}

TEST(JudgeInput, NamesAMisspeltSensorAndDoubtsTheResultIfManySamplesHaveIt) {
  test::NoisyScene scene(40);
  const auto misspell = [&](std::size_t from, std::size_t to) {
    for (std::size_t i = from; i < to; ++i) camera_of(scene.samples[i]).sensor = "camra";
  };
  const auto expected = [&](const std::string& count) {
    return "'camra' is observed in " + count + " of 40 samples (the first is " +
           scene.samples[0].source +
           "), and is not a sensor of the calibration; did you mean 'camera'?";
  };
  misspell(0, 1);
  const JudgedResult one = judged(scene);
  EXPECT_THAT(one.unused, ElementsAre(expected("1")));
  EXPECT_EQ(one.judgement.verdict, Grade::good);
  misspell(1, 15);
  const JudgedResult many = judged(scene);
  EXPECT_THAT(many.unused, ElementsAre(expected("15")));
  EXPECT_THAT(many.judgement.reasons, Contains(expected("15")));
  EXPECT_EQ(many.judgement.verdict, Grade::use_with_care);
}

TEST(JudgeInput, NamesFeaturesThatAreNotNumbersAndDoubtsTheResultIfManySamplesLackAll) {
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  test::NoisyScene scene(40);
  camera_of(scene.samples[2]).features[1].point.x() = kNaN;
  const JudgedResult one = judged(scene);
  EXPECT_THAT(one.unused,
              ElementsAre("features of sensor 'camera' are not numbers in 1 of 40 samples (the "
                          "first is " +
                          scene.samples[2].source + "); they are left out"));
  EXPECT_EQ(one.judgement.verdict, Grade::good);
  for (std::size_t i = 10; i < 25; ++i) {
    for (Feature& feature : camera_of(scene.samples[i]).features) feature.point.y() = kNaN;
  }
  const std::string left_out = "15 of 40 samples (the first is " + scene.samples[10].source +
                               ") are left out: features are not numbers";
  const JudgedResult many = judged(scene);
  EXPECT_THAT(many.unused, ElementsAre(HasSubstr("in 16 of 40 samples"), left_out));
  EXPECT_THAT(many.judgement.reasons, Contains(left_out));
}

TEST(JudgeInput, CountsSamplesThatNoErrorBlockCompares) {
  test::NoisyScene scene(40);
  for (std::size_t i = 3; i < 6; ++i) camera_of(scene.samples[i]).features.clear();
  const JudgedResult result = judged(scene);
  EXPECT_THAT(result.unused,
              ElementsAre("3 of 40 samples (the first is " + scene.samples[3].source +
                          ") are compared by no error block: not all of its "
                          "sensors observe something"));
  EXPECT_EQ(result.judgement.verdict, Grade::good);
}

TEST(JudgeInput, CountsCopiesUnlessADoubtNamesThem) {
  test::NoisyScene scene(40);
  for (std::size_t i = 20; i < 25; ++i) scene.samples[i] = scene.samples[i - 20];
  camera_of(scene.samples[20]).features[0].point.x() += 1e-11;  // printed with fewer digits
  const std::string copies = "5 of 40 samples (the first is " + scene.samples[20].source +
                             ") are copies of others; copies count twice and say nothing new; "
                             "remove them";
  const JudgedResult result = judged(scene);
  EXPECT_THAT(result.unused, ElementsAre(copies));
  EXPECT_THAT(result.judgement.reasons, Contains(copies));
  const std::string known =
      "s.yaml:3: the sample is a copy of that at s.yaml:1; " + std::string(kCopiesCountTwice);
  const JudgedResult again = judged(scene, {known});
  EXPECT_THAT(again.judgement.reasons, Contains(known));
  EXPECT_THAT(again.judgement.reasons, Not(Contains(copies)));
}

TEST(JudgeInput, RefusesCopiesOfOneSample) {
  test::NoisyScene scene(40);
  scene.samples.assign(40, scene.samples[0]);
  const JudgedResult result = judged(scene);
  EXPECT_EQ(result.judgement.verdict, Grade::do_not_use);
  EXPECT_THAT(result.judgement.reasons,
              Contains("all 40 samples are the same one; record different poses"));
}

}  // namespace
}  // namespace kinecal
