#include "kinecal/files/results/homing_offsets.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>

#include "kinecal/files/json/json_value.hpp"

namespace kinecal {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;

constexpr double kTick = 2.0 * std::numbers::pi / 4096.0;  // radians

/// As LeRobot writes it, and with what people write by hand.
constexpr const char* kHoming = R"({
    "shoulder_pan": {
        "id": 1,
        "drive_mode": 0,
        "homing_offset": -46,
        "range_min": 758,
        "range_max": 3292
    },
    "elbow_flex": {"homing_offset" : 214 , "id":2, "drive_mode":1, "note": "\"homing_offset\": 7",
      "range_min": 0, "range_max": 4095},
    "gripper": {"id": 6, "drive_mode": 0, "homing_offset": 1407, "range_min": 2031, "range_max": 3476}
}
)";

Robot arm() {
  return Robot("arm",
               {{.name = "shoulder_pan", .type = JointType::revolute, .parent = "a", .child = "b"},
                {.name = "elbow_flex", .type = JointType::revolute, .parent = "b", .child = "c"},
                {.name = "wrist", .type = JointType::revolute, .parent = "c", .child = "d"}});
}

HomingPatch patched(const std::vector<JointPatch>& zeros, ServoMake make = ServoMake::feetech,
                    const std::string& text = kHoming) {
  return patch_homing_offsets(text, "arm.json", arm(), zeros, make);
}

std::string with(std::string text, const std::string& old, const std::string& replaced) {
  return text.replace(text.find(old), old.size(), replaced);
}

TEST(HomingOffsets, OnlyTheNumberThatChangesIsRewritten) {
  const HomingPatch patch = patched({{"shoulder_pan", 10.4 * kTick, {}}});
  EXPECT_EQ(patch.text, with(kHoming, "-46", "-56"));
  EXPECT_THAT(patch.changes, ElementsAre("shoulder_pan: homing_offset -46 becomes -56 "
                                         "(0.914 degrees are 10.40 ticks)"));
  EXPECT_THAT(patch.unused, ElementsAre("gripper"));
  EXPECT_THAT(patch.missing, IsEmpty());
}

/// The position that a servo reports, and the joint's: what LeRobot computes in degrees, less its zero.
double joint_position(const std::string& text, const std::string& motor, ServoMake make,
                      double encoder) {
  const detail::JsonValue of = detail::JsonValue::parse(text).at(motor);
  const double homing = of.number("homing_offset");
  const double ticks = make == ServoMake::feetech ? encoder - homing : encoder + homing;
  return (of.number("drive_mode") == 0.0 ? kTick : -kTick) * ticks;
}

TEST(HomingOffsets, TheServosThenReportThePositionPlusTheZero) {
  const double zero = 25.0 * kTick;
  for (const ServoMake make : {ServoMake::feetech, ServoMake::dynamixel}) {
    for (const std::string motor : {"shoulder_pan", "elbow_flex"}) {
      const std::string text = patched({{motor, zero, {}}}, make).text;
      EXPECT_NEAR(joint_position(text, motor, make, 3000.0),
                  joint_position(kHoming, motor, make, 3000.0) + zero, 1e-12)
          << motor;
    }
  }
}

TEST(HomingOffsets, NoZerosGiveTheSameBytes) {
  EXPECT_EQ(patched({}).text, kHoming);
  JointPatch frame{"elbow_flex", 0.0, {}};
  frame.correction.translation.x() = 0.1;
  EXPECT_EQ(patched({frame}).text, kHoming);
}

TEST(HomingOffsets, AJointWithoutAMotorIsNamed) {
  EXPECT_THAT(patched({{"wrist", 0.1, {}}}).missing, ElementsAre("wrist"));
}

std::string refusal(const std::string& text, const std::vector<JointPatch>& zeros = {}) {
  try {
    return "accepted: " + patched(zeros, ServoMake::feetech, text).text;
  } catch (const InputError& e) {
    return e.what();
  }
}

TEST(HomingOffsets, WhatAServoCannotHoldIsAnError) {
  EXPECT_THAT(refusal(kHoming, {{"shoulder_pan", std::numbers::pi, {}}}),
              AllOf(StartsWith("arm.json: shoulder_pan: homing_offset -46 becomes -2094"),
                    HasSubstr("-2047 to 2047")));
}

TEST(HomingOffsets, OtherFilesAreErrors) {
  EXPECT_THAT(refusal(""), StartsWith("arm.json: "));
  EXPECT_THAT(refusal("[1]"), StartsWith("arm.json: "));
  EXPECT_THAT(refusal("{\"elbow_flex\": {\"id\": 1}}"),
              AllOf(StartsWith("arm.json: "), HasSubstr("homing_offset")));
  EXPECT_THAT(refusal("{\"elbow_flex\": {\"homing_offset\": 0.5}}"), HasSubstr("homing_offset"));
  EXPECT_THAT(refusal("{\"elbow_flex\": {\"homing_offset\": 5, \"drive_mode\": 2}}"),
              HasSubstr("drive_mode of 'elbow_flex' must be 0 or 1, is 2"));
  EXPECT_THAT(refusal(R"({"motor_names": ["a"], "homing_offset": [1]})"), HasSubstr("June 2025"));
  EXPECT_THAT(refusal(R"({"elbow": {"homing_offset": 5}})"),
              AllOf(HasSubstr("motors: elbow"), HasSubstr("joints: shoulder_pan, elbow_flex")));
}

}  // namespace
}  // namespace kinecal
