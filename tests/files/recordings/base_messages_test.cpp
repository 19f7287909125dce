// Drives of a mobile base from bags.
#include "kinecal/files/recordings/base_messages.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <functional>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "kinecal/files/messages/make.hpp"
#include "kinecal/files/messages/message_fields.hpp"
#include "kinecal/files/recordings/bag_output.hpp"
#include "kinecal/files/recordings/read_recording.hpp"
#include "kinecal/study/simulated_base.hpp"
#include "support/temporary_folder.hpp"

namespace kinecal {
namespace {

using detail::fields;
using testing::HasSubstr;
using testing::IsEmpty;

/// What is wrong with a bag.
struct BagOptions {
  bool has_scans = true, has_tracked = false, has_odometry = true;
  std::vector<std::string> wheels = {};  ///< joints
  double gyro_sign = 1.0;
  double late_imu = 0.0;          ///< stamps of the IMU behind those of the odometry, seconds
  bool has_bad_messages = false;  ///< each tenth of the odometry and of the IMU has no numbers
  bool has_goal = false;          ///< another topic of poses, far away
  double silent_from = 1e9, silent_to = 1e9;  ///< seconds without an IMU
};

MessageFields header(double time, std::string_view frame) {
  return fields("stamp", detail::time_fields(Stamp(std::llround(1e9 * (1000.0 + time)))),
                "frame_id", frame);
}
MessageFields pose(double x, double y, double yaw) {
  return fields("position", fields("x", x, "y", y, "z", 0.0), "orientation",
                fields("x", 0.0, "y", 0.0, "z", std::sin(0.5 * yaw), "w", std::cos(0.5 * yaw)));
}

/// A scan of a wall; of nothing if the wall is not seen.
MessageFields scan(double time, double angle, double distance) {
  constexpr double kFirst = -1.5, kStep = 0.01;
  std::vector<double> ranges;
  for (int i = 0; i <= 300; ++i) {
    const double ahead = std::cos(kFirst + kStep * i - angle);
    ranges.push_back(ahead > 0.1 ? distance / ahead : std::numeric_limits<double>::infinity());
  }
  return fields("header", header(time, "laser_link"), "angle_min", kFirst, "angle_max", 1.5,
                "angle_increment", kStep, "range_min", 0.05, "range_max", 30.0, "ranges",
                detail::numbers(ranges));
}

/// Writes a drive: each run, then a second at rest.
void write_drive(const std::string& path, const SimulatedBase& base, const BagOptions& of) {
  BagOutput bag(path, Encoding::ros1);
  const std::vector<Sample> samples = simulate_base(base, turns_and_straight_runs(), 1).samples;
  double time = 0.0, gyro = 0.0;
  const auto write = [&](const char* topic, const char* type, double stamp,
                         const MessageFields& message) {
    bag.write({topic, type}, std::llround(1e9 * (1000.01 + stamp)), message);
  };
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const auto& now = samples[i].conditions;
    const bool begins = i == 0 || samples[i - 1].conditions.at(kRun) != now.at(kRun);
    const double step = begins ? 1.0 : now.at("time") - samples[i - 1].conditions.at("time");
    const double rate = begins ? 0.0 : of.gyro_sign * (now.at("gyro_yaw") - gyro) / step;
    gyro = now.at("gyro_yaw");
    // The rate is constant over the step: stamped just inside of it.
    for (const double part : {1e-3, 0.25, 0.5, 0.75, 1.0}) {
      const double at = time + step * part;
      if (at > of.silent_from && at < of.silent_to) continue;
      const auto write_rate = [&](double stamp, double z) {
        const MessageFields imu = fields("header", header(stamp - of.late_imu, "imu_link"),
                                         "angular_velocity", fields("x", 0.0, "y", 0.0, "z", z));
        write("imu", "sensor_msgs/Imu", stamp, imu);
      };
      write_rate(at, rate);
      if (of.has_bad_messages && i % 10 == 5) {
        write_rate(at + 1e-4, std::numeric_limits<double>::quiet_NaN());
      }
    }
    const int steps = begins ? 4 : 1;
    for (int n = 1; n <= steps; ++n) {
      const double at = time + step * n / steps;
      if (of.has_odometry) {
        write(
            "odom", "nav_msgs/Odometry", at,
            fields("header", header(at, "odom"), "child_frame_id", std::string("base_link"), "pose",
                   fields("pose", pose(now.at("odom_x"), now.at("odom_y"), now.at("odom_yaw")))));
      }
      if (of.has_bad_messages && i % 10 == 5) {
        const MessageFields lost =
            fields("position", fields("x", 9.0, "y", 9.0, "z", 0.0), "orientation",
                   fields("x", 0.0, "y", 0.0, "z", 0.0, "w", 0.0));
        write("odom", "nav_msgs/Odometry", at + 1e-4,
              fields("header", header(at + 1e-4, "odom"), "child_frame_id",
                     std::string_view("base_link"), "pose", fields("pose", lost)));
      }
      if (of.has_goal && i % 10 == 5) {
        write("goal", "geometry_msgs/PoseWithCovarianceStamped", at + 1e-4,
              fields("header", header(at + 1e-4, "world"), "pose",
                     fields("pose", pose(90.0, 90.0, 0.0))));
      }
      if (!of.wheels.empty()) {
        std::vector<double> positions;
        for (const std::string& wheel : of.wheels) {
          positions.push_back(wheel.find("left") != std::string::npos ? now.at("left_wheel")
                                                                      : now.at("right_wheel"));
        }
        write("joint_states", "sensor_msgs/JointState", at,
              fields("header", header(at, ""), "name", detail::texts(of.wheels), "position",
                     detail::numbers(positions)));
      }
      if (of.has_tracked) {
        write("tracker", "geometry_msgs/PoseStamped", at,
              fields("header", header(at, "world"), "pose",
                     pose(now.at("track_x"), now.at("track_y"), now.at("track_yaw"))));
      }
      if (of.has_scans) {
        const double angle = now.at("wall_angle");
        const double seen = std::isfinite(angle) ? angle : 3.0;
        write("base_scan", "sensor_msgs/LaserScan", at,
              scan(at, seen, std::isfinite(angle) ? now.at("wall_distance") : 1.0));
      }
    }
    time += step;
  }
  bag.finish();
}

class BaseDriveFromBag : public testing::Test {
 protected:
  std::vector<Sample> read(const BagOptions& of) {
    const std::string path = (folder_.path() / "drive.bag").string();
    write_drive(path,
                SimulatedBase{.tracked_position = 1e-6,
                              .tracked_angle = 1e-6,
                              .wall_distance = 1e-6,
                              .rolling = 1e-5},
                of);
    found_ = {};
    return read_recording(path, found_).samples;
  }

  test::TemporaryFolder folder_;
  Diagnostics found_;
};

TEST_F(BaseDriveFromBag, ScansShowTheWallAndRunsAreNumbered) {
  const std::vector<Sample> samples = read({});
  EXPECT_THAT(found_.errors, IsEmpty());
  EXPECT_THAT(found_.doubts, IsEmpty());
  ASSERT_FALSE(samples.empty());
  EXPECT_EQ(samples.back().conditions.at(kRun),
            static_cast<double>(turns_and_straight_runs().size()));
  double turned = 0.0;  // of the first run, by the odometry: a full turn, without a jump
  int walls = 0;
  for (const Sample& sample : samples) {
    const auto& of = sample.conditions;
    if (of.at(kRun) == 1.0) turned = of.at("odom_yaw") - samples.front().conditions.at("odom_yaw");
    if (of.at(kRun) == 1.0) {  // within a step of the drive: 0.25 s at 0.5 rad/s
      EXPECT_NEAR(of.at("gyro_yaw") - samples.front().conditions.at("gyro_yaw"), turned, 0.1);
    }
    walls += std::isfinite(of.at("wall_angle")) ? 1 : 0;
  }
  EXPECT_NEAR(turned, 2.0 * 3.14159265, 0.05) << "samples within 0.05 rad of the last are left out";
  EXPECT_GT(walls, 40);
  ASSERT_FALSE(found_.notes.empty());
  EXPECT_THAT(found_.notes.front(), HasSubstr("scans show no wall; the first: "));
}

TEST_F(BaseDriveFromBag, ATrackedPoseNeedsNoScans) {
  const std::vector<Sample> samples = read({.has_scans = false, .has_tracked = true});
  EXPECT_THAT(found_.errors, IsEmpty());
  ASSERT_GT(samples.size(), 50u);
  EXPECT_TRUE(samples[10].conditions.contains("track_yaw"));
  EXPECT_FALSE(samples[10].conditions.contains("wall_angle"));
}

TEST_F(BaseDriveFromBag, MessagesWithoutNumbersAreLeftOut) {
  const std::vector<Sample> samples = read({.has_bad_messages = true});
  EXPECT_THAT(found_.errors, IsEmpty());
  EXPECT_THAT(found_.notes, testing::Contains(HasSubstr("quaternion has no length")));
  ASSERT_GT(samples.size(), 50u);
  EXPECT_TRUE(std::isfinite(samples[samples.size() - 2].conditions.at("gyro_yaw")));
  for (const Sample& sample : samples) EXPECT_LT(sample.conditions.at("odom_x"), 8.0);
}

TEST_F(BaseDriveFromBag, PosesOfAnotherTopicAreNotThoseOfTheBase) {
  const std::vector<Sample> samples =
      read({.has_scans = false, .has_tracked = true, .has_goal = true});
  EXPECT_THAT(found_.notes, testing::Contains(HasSubstr("'tracker' is used, not 'goal'")));
  ASSERT_GT(samples.size(), 50u);
  for (const Sample& sample : samples) EXPECT_LT(sample.conditions.at("track_x"), 50.0);
}

/// The angle through which the base turned meanwhile is not known.
TEST_F(BaseDriveFromBag, NothingIsComparedAcrossASilenceOfTheGyroscope) {
  const std::vector<Sample> samples = read({.silent_from = 4.0, .silent_to = 8.0});
  EXPECT_THAT(found_.doubts, IsEmpty());
  ASSERT_GT(samples.size(), 50u);
  EXPECT_GT(samples.back().conditions.at(kRun),
            static_cast<double>(turns_and_straight_runs().size()));
  for (std::size_t i = 1; i < samples.size(); ++i) {
    const auto &now = samples[i].conditions, &before = samples[i - 1].conditions;
    if (now.at(kRun) != before.at(kRun)) continue;
    const double by = now.at("gyro_yaw") - before.at("gyro_yaw");
    if (std::isfinite(by)) {  // within a step of the drive, as above
      EXPECT_NEAR(by, now.at("odom_yaw") - before.at("odom_yaw"), 0.15);
    }
  }
}

TEST_F(BaseDriveFromBag, FourWheelsAreAlsoTwo) {
  const std::vector<Sample> samples =
      read({.has_odometry = false,
            .wheels = {"front_left_wheel", "front_right_wheel", "rear_left_wheel",
                       "rear_right_wheel", "arm_joint"}});
  EXPECT_THAT(found_.errors, IsEmpty());
  ASSERT_GT(samples.size(), 30u);
  const auto& of = samples.back().conditions;
  EXPECT_EQ(of.at("left_wheel"), of.at("front_left_wheel"));
  EXPECT_EQ(of.at("right_wheel"), of.at("rear_right_wheel"));
  EXPECT_EQ(of.count("arm_joint"), 0u);
  const BaseDrive drive = read_base_drive((folder_.path() / "drive.bag").string(), found_);
  EXPECT_EQ(drive.sensor_frame, "laser_link");
  EXPECT_EQ(drive.base_frame, "");  // it is that of the odometry
}

TEST_F(BaseDriveFromBag, WhatIsMissingIsSaid) {
  EXPECT_THAT(read({.has_scans = false}), IsEmpty());
  ASSERT_EQ(found_.errors.size(), 1u);
  EXPECT_THAT(found_.errors[0], HasSubstr("no messages of robot_calibration_msgs"));
  found_ = {};
  EXPECT_THAT(read_base_drive((folder_.path() / "drive.bag").string(), found_).samples, IsEmpty());
  ASSERT_EQ(found_.errors.size(), 1u);
  EXPECT_THAT(found_.errors[0], HasSubstr("takes scans of a wall"));
}

TEST_F(BaseDriveFromBag, AGyroscopeAloneIsEnough) {
  const std::vector<Sample> samples = read({.has_odometry = false});
  EXPECT_THAT(found_.errors, IsEmpty());
  ASSERT_GT(samples.size(), 30u);
  EXPECT_EQ(samples.back().conditions.at(kRun), 6.0);  // it does not see straight runs
}

TEST_F(BaseDriveFromBag, AGyroscopeThatTurnsTheOtherWayAndClocksThatDifferAreDoubts) {
  (void)read({.gyro_sign = -1.0});
  ASSERT_EQ(found_.doubts.size(), 1u);
  EXPECT_THAT(found_.doubts[0], HasSubstr("its z axis points down?"));
  (void)read({.late_imu = 2.0});
  ASSERT_FALSE(found_.doubts.empty());
  EXPECT_THAT(found_.doubts[0], HasSubstr("two clocks?"));
}

}  // namespace
}  // namespace kinecal
