// What samples determine of the blocks of a base.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/base_problem.hpp"
#include "support/wrong_base.hpp"

namespace kinecal {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;

/// Samples of a drive in which some readings keep a value.
std::vector<Sample> with_frozen(const std::vector<std::string>& names) {
  std::vector<Sample> samples = simulate_base(test::wrong_base(), all_runs(), 6).samples;
  for (Sample& sample : samples) {
    for (const std::string& name : names) sample.conditions[name] = 0.25;
  }
  return samples;
}
void expect_refused(const JudgedResult& judged) {
  EXPECT_EQ(judged.judgement.verdict, Grade::do_not_use);
  EXPECT_THAT(judged.judgement.reasons,
              Contains(AllOf(HasSubstr("'base'"), HasSubstr("do not determine"))));
}

TEST(JudgeBlocks, ABaseWithoutAnyScaleIsNotCalibrated) {
  const SimulatedBase base = test::wrong_base();
  const std::vector<std::string> scales = {"track_width_scale", "left_rollout_scale",
                                           "right_rollout_scale"};
  const auto wheels = test::block_of<DifferentialToPose>(base);
  expect_refused(test::judged_base(wheels, scales, with_frozen({"left_wheel", "right_wheel"})));
  expect_refused(test::judged_base(test::block_of<GyroToPose>(base), {"scale", "bias"},
                                   with_frozen({"gyro_yaw"})));
  EXPECT_EQ(test::judged_base(wheels, scales, with_frozen({})).judgement.verdict, Grade::good);
  EXPECT_NE(test::judged_base(wheels, scales, with_frozen({"left_wheel"})).judgement.verdict,
            Grade::good);
}

}  // namespace
}  // namespace kinecal
