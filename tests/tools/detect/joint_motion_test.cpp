// SPDX-License-Identifier: Apache-2.0
#include "kinecal/tools/detect/joint_motion.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "kinecal/tools/detect/joint_tracks.hpp"

namespace kinecal {
namespace {

using std::chrono::milliseconds;
using testing::HasSubstr;
using testing::IsEmpty;

const Stamp kMotionStart = std::chrono::seconds(1'700'000'000);

Stamp at(double time) {
  return kMotionStart + std::chrono::round<Stamp>(std::chrono::duration<double>(time));
}

/// Reads a joint for some time, seconds.
void read_joint(JointTracks& tracks, const std::string& joint, double begin, double end,
                milliseconds period, const std::function<double(double)>& position) {
  for (Stamp stamp = at(begin); stamp <= at(end); stamp += period) {
    const double time = std::chrono::duration<double>(stamp - kMotionStart).count();
    tracks.add("joint_states", {stamp, {joint}, {position(time)}});
  }
}

JointTracks chosen_for_motion(JointTracks tracks) {
  Diagnostics diagnostics;
  tracks.choose({}, "a.bag", diagnostics, true);
  EXPECT_THAT(diagnostics.errors, IsEmpty());
  return tracks;
}

/// Up to 0.5 rad/s and 0.5 rad/s^2.
double swing(double time) {
  return 0.5 * std::sin(time);
}

TEST(JointMotion, OfASwingIsFoundBetweenReadings) {
  constexpr double kPosition = 1e-4, kVelocity = 1e-2;  // rad, rad/s
  for (const auto period : {milliseconds(2), milliseconds(20), milliseconds(100)}) {
    JointTracks tracks;
    read_joint(tracks, "arm", 0.0, 8.0, period, swing);
    tracks = chosen_for_motion(tracks);
    for (double time = 0.3; time < 7.7; time += 0.0937) {
      const JointsInMotion found = tracks.motion(at(time));
      ASSERT_EQ(found.refusal, "") << time;
      ASSERT_EQ(found.joints.velocities.size(), 1U);
      EXPECT_EQ(found.joints.stamp, at(time));
      EXPECT_NEAR(found.joints.positions[0], swing(time), kPosition) << period.count();
      EXPECT_NEAR(found.joints.velocities[0], 0.5 * std::cos(time), kVelocity) << period.count();
    }
  }
}

TEST(JointMotion, OfNoisyReadingsIsTheirMean) {
  constexpr double kNoise = 3e-4;
  const auto noisy = [](double time) { return swing(time) + kNoise * std::sin(1e4 * time); };
  JointTracks tracks;
  read_joint(tracks, "arm", 0.0, 4.0, milliseconds(20), noisy);
  tracks = chosen_for_motion(tracks);
  for (double time = 0.3; time < 3.7; time += 0.031) {
    const MeasuredJoints joints = tracks.motion(at(time)).joints;
    EXPECT_NEAR(joints.positions.at(0), swing(time), kNoise);
    EXPECT_NEAR(joints.velocities.at(0), 0.5 * std::cos(time), 1e-2);
  }
}

TEST(JointMotion, OfAWheelGoesOnOverHalfATurn) {
  for (const auto period : {milliseconds(2), milliseconds(20)}) {
    for (const double speed : {0.7, -0.7}) {
      const auto wheel = [&](double time) {
        return std::remainder(3.0 + speed * time, 2.0 * std::numbers::pi);
      };
      JointTracks tracks;
      read_joint(tracks, "wheel", 0.0, 9.0, period, wheel);
      tracks = chosen_for_motion(tracks);
      for (double time = 0.1; time < 8.9; time += 0.013) {
        const MeasuredJoints joints = tracks.motion(at(time)).joints;
        const double away = joints.positions.at(0) - 3.0 - speed * time;
        EXPECT_NEAR(std::remainder(away, 2.0 * std::numbers::pi), 0.0, 1e-9) << time;
        EXPECT_NEAR(joints.velocities.at(0), speed, 1e-6) << time;
      }
    }
  }
}

TEST(JointMotion, IsNotKnownWhereAJointWasNotRead) {
  JointTracks tracks;
  read_joint(tracks, "arm", 0.0, 5.0, milliseconds(20), swing);
  read_joint(tracks, "wrist", 0.0, 2.0, milliseconds(20), swing);
  read_joint(tracks, "wrist", 2.6, 5.0, milliseconds(20), swing);
  tracks = chosen_for_motion(tracks);
  EXPECT_EQ(tracks.motion(at(1.5)).refusal, "");
  EXPECT_THAT(tracks.motion(at(2.3)).refusal,
              HasSubstr("joint 'wrist' of topic 'joint_states' was not read within 0.25 s"));
  EXPECT_THAT(tracks.motion(at(5.2)).refusal, HasSubstr("joint 'arm'")) << "nothing is after it";
  EXPECT_THAT(tracks.motion(at(-0.1)).refusal, HasSubstr("joint 'arm'")) << "nothing is before it";
}

TEST(JointMotion, HasAReadingOnEitherSideOfAGap) {
  JointTracks tracks;
  read_joint(tracks, "arm", 0.0, 2.0, milliseconds(10), swing);
  read_joint(tracks, "arm", 2.2, 4.0, milliseconds(10), swing);
  tracks = chosen_for_motion(tracks);
  const MeasuredJoints joints = tracks.motion(at(2.02)).joints;
  EXPECT_NEAR(joints.positions.at(0), swing(2.02), 1e-4);
  EXPECT_NEAR(joints.velocities.at(0), 0.5 * std::cos(2.02), 1e-2);
}

}  // namespace
}  // namespace kinecal
