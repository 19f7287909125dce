// What names of joints and columns mean for the drive of a base.
#include "kinecal/files/recordings/base_conditions.hpp"

#include <gtest/gtest.h>

#include <utility>

namespace kinecal {
namespace {

TEST(BaseConditions, JointsOfWheels) {
  for (const auto& [joint, condition] :
       {std::pair("l_wheel_joint", "left_wheel"), std::pair("wheel_right_joint", "right_wheel"),
        std::pair("leftWheel", "left_wheel"),
        std::pair("front_left_wheel_joint", "front_left_wheel"),
        std::pair("wheel_rr", "rear_right_wheel"),
        std::pair("back_right_wheel", "rear_right_wheel"), std::pair("steering_joint", "steering"),
        std::pair("drive_wheel_joint", "wheel"), std::pair("fl_caster_l_wheel_joint", ""),
        std::pair("left_steering_joint", ""), std::pair("l_shoulder_joint", ""),
        std::pair("odom_x", "")}) {
    EXPECT_EQ(wheel_condition(joint), condition) << joint;
  }
}

TEST(BaseConditions, ColumnsOfTables) {
  for (const auto& [column, condition] : {std::pair("left_wheel", "left_wheel"),
                                          std::pair("enc_l", "left_wheel"),
                                          std::pair("ticks_right", "right_wheel"),
                                          std::pair("right", "right_wheel"),
                                          std::pair("x", "track_x"),
                                          std::pair("mocap.theta", "track_yaw"),
                                          std::pair("scan_y [m]", "track_y"),
                                          std::pair("odom_pose_x", "odom_x"),
                                          std::pair("odom.heading [rad]", "odom_yaw"),
                                          std::pair("gyro_yaw", "gyro_yaw"),
                                          std::pair("imu_z", "gyro_yaw"),
                                          std::pair("wall_angle", "wall_angle"),
                                          std::pair("wall distance", "wall_distance"),
                                          std::pair("t [s]", "time"),
                                          std::pair("yaw_deg", "track_yaw"),
                                          std::pair("run", "run"),
                                          std::pair("temperature", ""),
                                          std::pair("imu_accel_z", ""),
                                          std::pair("battery", ""),
                                          std::pair("", "")}) {
    EXPECT_EQ(base_condition(column), condition) << column;
  }
  for (const std::string_view wheel : kWheelConditions) EXPECT_EQ(base_condition(wheel), wheel);
}

}  // namespace
}  // namespace kinecal
