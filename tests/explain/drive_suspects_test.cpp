// Mistakes in the readings of a base are named.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <numbers>
#include <string>
#include <utility>

#include "kinecal/config/read_config.hpp"
#include "kinecal/procedure/calibrate_robot.hpp"
#include "kinecal/study/simulated_base.hpp"
#include "support/robots.hpp"
#include "support/wrong_base.hpp"

namespace kinecal {
namespace {

using testing::HasSubstr;

/// The first reason of the verdict on a drive whose samples were changed.
std::string reason_for(const std::function<void(std::map<std::string, double>&)>& change) {
  Diagnostics found;
  CalibrationSetup setup{
      .robot = test::mobile_manipulator(),
      .config = parse_config(
          "base_link: base_link\nmodels: []\nfree_params: [base_track_width_scale, "
          "base_left_rollout_scale, base_right_rollout_scale, base_x, base_y, base_yaw, imu_scale, "
          "imu_bias]\nerror_blocks:\n"
          "- {name: base, type: differential_to_pose, wheel_radius: 0.0605, track_width: 0.37476, "
          "translation_scale: 500, rotation_scale: 500}\n- {name: imu, type: gyro_to_pose}\n",
          "base.yaml", found)};
  EXPECT_THAT(found.errors, testing::IsEmpty());
  setup.samples = simulate_base(test::wrong_base(), all_runs(), 6).samples;
  for (Sample& sample : setup.samples) change(sample.conditions);
  const CalibratedRobot calibrated = calibrate_robot(std::move(setup));
  EXPECT_EQ(calibrated.judgement.verdict, Grade::do_not_use);
  return calibrated.judgement.reasons.empty() ? "" : calibrated.judgement.reasons.front();
}
std::string with_factor(const std::vector<std::string>& names, double factor) {
  return reason_for([&](std::map<std::string, double>& of) {
    for (const std::string& name : names) of[name] *= factor;
  });
}

constexpr double kDegrees = 180.0 / std::numbers::pi;

TEST(DriveSuspects, SignsAndOrderOfWheelsAreNamed) {
  EXPECT_THAT(with_factor({"left_wheel"}, -1.0), HasSubstr("'left_wheel' negated"));
  EXPECT_THAT(reason_for([](auto& of) { std::swap(of["left_wheel"], of["right_wheel"]); }),
              HasSubstr("'left_wheel' and 'right_wheel' exchanged"));
  EXPECT_THAT(with_factor({"gyro_yaw"}, -1.0), HasSubstr("'gyro_yaw' negated"));
}

TEST(DriveSuspects, UnitsAreNamed) {
  EXPECT_THAT(with_factor({"track_x", "track_y"}, 1e3), HasSubstr("taken as millimetres"));
  EXPECT_THAT(with_factor({"track_yaw"}, kDegrees), HasSubstr("'track_yaw' taken as degrees"));
  EXPECT_THAT(with_factor({"gyro_yaw"}, kDegrees), HasSubstr("'gyro_yaw' taken as degrees"));
  EXPECT_THAT(with_factor({"left_wheel", "right_wheel"}, kDegrees),
              HasSubstr("'left_wheel' and 'right_wheel' taken as degrees"));
}

}  // namespace
}  // namespace kinecal
