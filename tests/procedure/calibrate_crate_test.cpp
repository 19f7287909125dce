#include "kinecal/procedure/calibrate_crate.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "kinecal/errors.hpp"
#include "support/oracle.hpp"
#include "support/static_robot.hpp"
#include "support/unknown_poses.hpp"

namespace kinecal {
namespace {

using test::StaticRobot;
using testing::HasSubstr;

template <FixedString Tip>
using FromBase = Chain<StaticRobot, "base", Tip>;
using Elbow = JointOffset<"elbow">;
using Moved = FrameOffset<"mount", Axes::xyz>;
using Tracked = Crate<Chain3d<"arm", FromBase<"tip">>, Chain3d<"tracker", FromBase<"base">>, Elbow,
                      Moved, Block<"tracking", PointToPoint, "arm", "tracker">>;

TEST(CalibrateAndJudge, GivesACrateValuesWithTheirDeviationsAndTheVerdict) {
  constexpr double kElbow = 0.02, kNoise = 1e-4;
  ParameterTable truth = Tracked().table({});
  truth["elbow"].value = kElbow;
  const test::OracleValues<double> of_robot(truth, truth.values());
  test::Chance chance(5);
  std::vector<Sample> samples;
  for (int n = 0; n < 40; ++n) {
    Sample& sample = samples.emplace_back();
    sample.source = "sample " + std::to_string(n);
    for (const char* joint : {"lift", "pan", "elbow", "wrist"}) {
      sample.joint_names.emplace_back(joint);
      sample.joint_positions.push_back(chance(-1.0, 1.0));
    }
    const auto tip =
        test::oracle_pose(robot_from<StaticRobot>(), "base", "tip", "", sample, of_robot);
    sample.observations = {{"arm", {}, {}}, {"tracker", {}, {}}};
    for (int i = 0; i < 3; ++i) {
      const Vector3<double> p(0.1 * i, 0.05, 0.02 * i * i);
      const Vector3<double> noise(chance.normal(), chance.normal(), chance.normal());
      sample.observations[0].features.push_back({"tip", p});
      sample.observations[1].features.push_back({"base", Vector3<double>(tip(p) + kNoise * noise)});
    }
  }
  samples[11].joint_positions[2] += 0.3;
  const JudgedCrate<Tracked> judged = calibrate_and_judge(Tracked(), samples);
  EXPECT_EQ(judged.judgement.verdict, Grade::good) << judged.judgement.reasons.front();
  const double deviation = judged.deviation<Elbow>();
  EXPECT_GT(deviation, 0.0);
  EXPECT_LT(deviation, 1e-3);
  EXPECT_NEAR(judged.value<Elbow>(), kElbow, 4.0 * deviation);
  const Vector3<double> of_mount = judged.deviation<Moved>();
  EXPECT_TRUE((of_mount.array() > 0.0).all());
  ASSERT_EQ(judged.left_out.size(), 1u);
  EXPECT_EQ(judged.left_out[0].number, 12);
  EXPECT_THAT(judged.left_out[0].why, HasSubstr("likely cause: 'elbow' reads"));
}

}  // namespace
}  // namespace kinecal
