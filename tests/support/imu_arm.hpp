// An arm with an IMU that rests in some poses, simulated, and its bag.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <string>
#include <vector>

#include "kinecal/files/messages/make.hpp"
#include "kinecal/files/messages/message_fields.hpp"
#include "kinecal/files/recordings/bag_output.hpp"
#include "kinecal/kinematics/chain.hpp"
#include "kinecal/kinematics/forward_kinematics.hpp"
#include "support/robots.hpp"

namespace kinecal::test {

/// Three joints and an IMU behind a fixed one.
inline Robot imu_arm() {
  using enum JointType;
  return Robot("imu_arm",
               {{"pan", revolute, "base_link", "one", origin({0, 0, 0.3}), {0, 0, 1}},
                {"lift", revolute, "one", "two", origin({0.1, 0, 0}), {0, 1, 0}},
                {"roll", revolute, "two", "three", origin({0.3, 0, 0}), {1, 0, 0}},
                {"imu_joint", fixed, "three", "imu_link", origin({0, 0.05, 0}, {0.2, -0.1, 0.3})}});
}

/// What the IMU is like: readings are Q times what they should be.
struct SimulatedImu {
  Matrix3<double> acceleration = Matrix3<double>::Identity();
  Matrix3<double> rate = Matrix3<double>::Identity();
  std::string frame = "imu_link";
  bool rests = true;               ///< else the arm always moves
  bool has_latched_joint = false;  ///< another publisher of joints writes one message

  static std::vector<double> pose(int n) {
    return {0.6 * std::sin(1.0 * n), 0.6 * std::sin(2.3 * n), 0.8 * std::cos(1.7 * n)};
  }
  static constexpr int kPoses = 9;

  /// Writes a bag with joints at 50 Hz and the IMU at 100 Hz; an IMU on the base, too.
  void write(const std::string& path) const {
    constexpr double kRest = 1.0, kMove = 1.0, kStep = 0.01;
    BagOutput bag(path, Encoding::ros1);
    const Robot robot = imu_arm();
    const RuntimeChain chain = make_chain(robot, "base_link", "imu_link");
    const auto at = [&](double time) {
      const int n = static_cast<int>(time / (kRest + kMove));
      double part = (time - n * (kRest + kMove) - kRest) / kMove;
      part = rests ? std::max(0.0, part) : 0.5 * (part + kRest);
      std::vector<double> q = pose(n);
      for (std::size_t j = 0; j < q.size(); ++j) q[j] += part * (pose(n + 1)[j] - q[j]);
      return q;
    };
    const auto axes = [&](double time) {
      const std::vector<double> q = at(time);
      return forward_kinematics(chain,
                                [&](const std::string& joint) {
                                  return q[joint == "pan" ? 0 : joint == "lift" ? 1 : 2];
                                })
          .rotation;
    };
    const auto xyz = [](const Vector3<double>& v) {
      return detail::fields("x", v.x(), "y", v.y(), "z", v.z());
    };
    const int count =
        static_cast<int>(std::lround(((kPoses - 1) * (kRest + kMove) + kRest) / kStep));
    if (has_latched_joint) {
      const Stamp start(std::llround(1e9 * 1000.0));
      bag.write({"joint_states", "sensor_msgs/JointState"}, start.count(),
                detail::fields("header",
                               detail::fields("stamp", detail::time_fields(start), "frame_id",
                                              std::string_view("")),
                               "name", detail::texts({"gripper"}), "position",
                               detail::numbers(std::vector<double>{0.02})));
    }
    for (int i = 0; i < count; ++i) {
      const double time = kStep * i;
      const Stamp stamp(std::llround(1e9 * (1000.0 + time)));
      const auto header = [&](const std::string& name) {
        return detail::fields("stamp", detail::time_fields(stamp), "frame_id", name);
      };
      if (i % 2 == 0) {
        bag.write(
            {"joint_states", "sensor_msgs/JointState"}, stamp.count(),
            detail::fields("header", header(""), "name", detail::texts({"pan", "lift", "roll"}),
                           "position", detail::numbers(at(time))));
      }
      const Matrix3<double> now = axes(time), next = axes(time + kStep);
      const Vector3<double> turned = log(Matrix3<double>(now.transpose() * next)) / kStep;
      const Vector3<double> up = now.transpose() * Vector3<double>(0, 0, 9.81);
      bag.write({"wrist/imu", "sensor_msgs/Imu"}, stamp.count(),
                detail::fields("header", header(frame), "angular_velocity",
                               xyz(Vector3<double>(rate * turned)), "linear_acceleration",
                               xyz(Vector3<double>(acceleration * up))));
      bag.write({"base/imu", "sensor_msgs/Imu"}, stamp.count(),
                detail::fields("header", header("base_link"), "linear_acceleration",
                               xyz(Vector3<double>(0, 0, 9.81))));
    }
    bag.finish();
  }
};

}  // namespace kinecal::test
