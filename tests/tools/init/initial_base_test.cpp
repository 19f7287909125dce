// First configurations of mobile bases.
#include "kinecal/tools/init/initial_base.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "kinecal/config/read_config.hpp"
#include "kinecal/files/urdf/read_urdf.hpp"
#include "kinecal/study/simulated_base.hpp"
#include "support/thrown.hpp"

namespace kinecal {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

/// Links of a base with a wheel at each place.
std::string urdf_with(const std::vector<std::pair<std::string, std::string>>& wheels) {
  std::string text = "<robot name=\"b\">\n<link name=\"base_link\"/>\n";
  for (const auto& [name, place] : wheels) {
    text += "<link name=\"" + name +
            "_link\"><collision><geometry><cylinder radius=\"0.0605\" length=\"0.02\"/></geometry>"
            "</collision></link>\n<joint name=\"" +
            name + "_joint\" type=\"continuous\"><origin xyz=\"" + place +
            "\"/><parent link=\"base_link\"/><child link=\"" + name +
            "_link\"/><axis xyz=\"0 1 0\"/></joint>\n";
  }
  return text + "</robot>\n";
}
BaseSizes sizes_of(const std::string& urdf, const std::string& drive) {
  return sizes_of_urdf(parse_urdf(urdf, "robot.urdf"), urdf, "base_link", drive);
}

TEST(InitialBase, EveryDriveIsAConfiguration) {
  for (const std::string_view drive : kBaseDrives) {
    for (const std::string_view seen : kBaseSeen) {
      BaseAnswers answers;
      answers.drive = drive;
      answers.seen = seen;
      answers.has_gyro = true;
      answers.sizes = {0.06, 0.375, 0.4};
      answers.gyro_scale = 0.0012;
      const std::string text = initial_base(answers);
      Diagnostics found;
      const Config config = parse_config(text, "base.yaml", found);
      EXPECT_THAT(found.errors, IsEmpty()) << text;
      EXPECT_THAT(found.warnings, IsEmpty()) << text;
      ASSERT_EQ(config.steps.size(), 1u);
      ASSERT_EQ(config.steps[0].error_blocks.size(), 2u);
      EXPECT_EQ(config.steps[0].error_blocks[0].type, answers.drive + "_to_" + answers.seen);
      EXPECT_EQ(config.steps[0].error_blocks[1].numbers.at("gyro_scale"), 0.0012);
    }
  }
}

TEST(InitialBase, WhatTheDriveDoesNotShowIsHeld) {
  BaseAnswers answers;
  answers.drive = "odometry";
  answers.seen = "pose";
  answers.runs = false;
  const std::string text = initial_base(answers);
  EXPECT_THAT(text, AllOf(HasSubstr("\n- base_track_width_scale"),
                          HasSubstr("# held: base_rollout_scale: the drive goes nowhere"),
                          HasSubstr("# held: base_x, base_y, base_yaw: it takes turns"),
                          Not(HasSubstr("\n- base_x"))));
}

TEST(InitialBase, ARecordingSaysWhatItHas) {
  const std::vector<Sample> samples =
      simulate_base(SimulatedBase{}, turns_and_straight_runs(), 1).samples;
  const RecordedBase all = recorded_base(samples);
  EXPECT_THAT(all.drives, ElementsAre("odometry", "differential"));
  EXPECT_THAT(all.seen, ElementsAre("wall", "pose"));
  EXPECT_TRUE(all.has_gyro && all.turns && all.runs);
  const std::vector<BaseRun> ahead{{0.3, 0.0, 5.0}};
  const RecordedBase straight = recorded_base(simulate_base(SimulatedBase{}, ahead, 1).samples);
  EXPECT_TRUE(straight.runs);
  EXPECT_FALSE(straight.turns);
  const std::vector<BaseRun> turn{{0.0, 0.5, 12.0}};
  std::vector<Sample> turning = simulate_base(SimulatedBase{}, turn, 1).samples;
  for (Sample& sample : turning) {
    for (const char* name : {"track_x", "track_y", "track_yaw"}) sample.conditions.erase(name);
  }
  EXPECT_FALSE(recorded_base(turning).runs);
  EXPECT_TRUE(recorded_base(turning).turns);
}

/// A tracked sensor off the axis moves when the base turns in place, and noise is no motion.
TEST(InitialBase, TurnsAloneAreNoStraightRuns) {
  const std::vector<BaseRun> turns{{0.0, 0.5, 12.0}, {0.0, -1.5, 4.0}}, rest{{0.0, 0.0, 200.0}};
  const RecordedBase turning = recorded_base(simulate_base(SimulatedBase{}, turns, 1).samples);
  EXPECT_TRUE(turning.turns);
  EXPECT_FALSE(turning.runs);
  const RecordedBase still = recorded_base(simulate_base(SimulatedBase{}, rest, 1).samples);
  EXPECT_FALSE(still.turns || still.runs);
}

TEST(InitialBase, WhatADriveToTheSideOrSteeringShowsIsFree) {
  std::vector<Sample> samples(40);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const double at = 0.1 * static_cast<double>(i);
    samples[i].conditions = {{"front_left_wheel", at},
                             {"front_right_wheel", at},
                             {"rear_left_wheel", at},
                             {"rear_right_wheel", at},
                             {"steering", 0.05}};
  }
  EXPECT_FALSE(recorded_base(samples).sideways || recorded_base(samples).steers);
  for (std::size_t i = 20; i < samples.size(); ++i) {
    samples[i].conditions["front_left_wheel"] = samples[i].conditions["rear_right_wheel"] = 2.0;
    samples[i].conditions["steering"] = -0.5;
  }
  const RecordedBase has = recorded_base(samples);
  EXPECT_TRUE(has.sideways && has.steers);
  BaseAnswers answers;
  answers.seen = "pose";
  for (const auto& [drive, scale] :
       {std::pair("mecanum", "base_lateral_scale"), {"tricycle", "base_steering_scale"}}) {
    answers.drive = drive;
    answers.sideways = answers.steers = false;
    EXPECT_THAT(initial_base(answers), HasSubstr(std::string("# held: ") + scale));
    answers.sideways = answers.steers = true;
    EXPECT_THAT(initial_base(answers), HasSubstr(std::string("\n- ") + scale));
  }
}

TEST(InitialBase, DimensionsAreThoseOfTheUrdf) {
  const std::string two =
      urdf_with({{"l_wheel", "0 0.18738 0.06"}, {"r_wheel", "0 -0.18738 0.06"}});
  EXPECT_NEAR(sizes_of(two, "differential").wheel_radius, 0.0605, 1e-9);
  EXPECT_NEAR(sizes_of(two, "differential").track_width, 0.37476, 1e-9);
  const std::string four = urdf_with({{"front_left_wheel", "0.2 0.15 0"},
                                      {"front_right_wheel", "0.2 -0.15 0"},
                                      {"rear_left_wheel", "-0.2 0.15 0"},
                                      {"rear_right_wheel", "-0.2 -0.15 0"}});
  EXPECT_NEAR(sizes_of(four, "mecanum").track_width, 0.3, 1e-9);
  EXPECT_NEAR(sizes_of(four, "mecanum").wheelbase, 0.4, 1e-9);
  EXPECT_EQ(sizes_of(urdf_with({}), "differential").track_width, 0.0);
}

TEST(InitialBase, ColumnsHaveTheirMeaningByName) {
  const std::string text =
      base_columns("t,enc_l,enc_r,x,y,theta,battery\n0,0,0,0,0,0,7\n1,1,1,0.1,0,0,7\n", "d.csv");
  EXPECT_THAT(text, AllOf(HasSubstr("  left_wheel: enc_l\n"), HasSubstr("  track_yaw: theta\n"),
                          HasSubstr("  time: t\n"), HasSubstr("# Not used: battery")));
  const auto refused = [](const char* table) {
    return test::thrown<InputError>([&] { (void)base_columns(table, "d.csv"); });
  };
  EXPECT_THAT(refused("enc_l,enc_r\n1,2\n2,3\n"),
              HasSubstr("d.csv: no columns of what shows how the base moved"));
  EXPECT_THAT(refused("x,y,theta\n1,2,3\n2,3,4\n"), HasSubstr("d.csv: no columns of a drive"));
  EXPECT_THAT(base_columns("enc_l,enc_r,x,y,theta_deg\n1,2,1,2,30\n1,2,1,2,40\n", "d.csv"),
              HasSubstr("  track_yaw: {column: theta_deg, unit: degrees}\n"));
  EXPECT_THAT(refused("odom_x,odom_y,odom_yaw,x,y,yaw\n0,0,3.1,0,0,0\n0,0,-3.1,0,0,0\n"),
              HasSubstr("column 'odom_yaw' jumps by a full turn in row 2"));
  EXPECT_THAT(refused("run,enc_l,enc_r,x,y,yaw\nleft,0,0,0,0,0\nback,1,1,0,0,0\n"),
              HasSubstr("column 'run' has words, such as 'left': number the runs"));
  EXPECT_THAT(
      base_columns("odom_x,odom_y,odom_yaw,x,y,yaw\n0,0,0,0,0,0\n0,0,6.3,0,0,0.1\n0,0,12.6,0,"
                   "0,0.2\n",
                   "d.csv"),
      HasSubstr("odom_yaw: odom_yaw"))
      << "degrees, which do not wrap";
}

}  // namespace
}  // namespace kinecal
