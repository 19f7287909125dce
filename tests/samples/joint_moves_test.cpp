// Directions and velocities from the order and the stamps of a recording.
#include "kinecal/samples/joint_moves.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace kinecal {
namespace {

using testing::DoubleNear;
using testing::ElementsAre;
using testing::IsEmpty;

Sample at(double a, double b, double seconds = 0.0) {
  Sample sample;
  sample.joint_names = {"a", "b"};
  sample.joint_positions = {a, b};
  if (seconds > 0.0) sample.stamp = std::chrono::nanoseconds(static_cast<long>(1e9 * seconds));
  return sample;
}

TEST(JointMoves, AreFromWhereAJointStoodBefore) {
  std::vector<Sample> samples = {at(0.0, 1.0), at(0.5, 1.0), at(0.5004, 0.7), at(0.2, 0.7)};
  set_joint_moves(samples);
  EXPECT_THAT(samples[0].joint_moves, ElementsAre(0.0, 0.0));
  EXPECT_THAT(samples[1].joint_moves, ElementsAre(0.5, 0.0));
  EXPECT_THAT(samples[2].joint_moves, ElementsAre(0.5, DoubleNear(-0.3, 1e-12)))
      << "noise of an encoder is no move";
  EXPECT_LT(*samples[3].move("a"), 0.0);
  EXPECT_LT(*samples[3].move("b"), 0.0) << "as it came";
  EXPECT_EQ(samples[3].move("c"), std::nullopt);
}

TEST(JointVelocities, AreTheSlopeBetweenNeighbours) {
  std::vector<Sample> samples = {at(0.0, 0.0, 10.0), at(0.01, 0.0, 10.1), at(0.03, -0.02, 10.2),
                                 at(1.0, 1.0, 12.0)};
  set_joint_velocities(samples);
  EXPECT_NEAR(*samples[0].velocity("a"), 0.1, 1e-9);
  EXPECT_NEAR(*samples[1].velocity("a"), 0.15, 1e-9);
  EXPECT_NEAR(*samples[2].velocity("b"), -0.2, 1e-9);
  EXPECT_THAT(samples[3].joint_velocities, IsEmpty()) << "nothing is near it";
}

TEST(JointVelocities, AreNotOfSamplesWithMissingPositions) {
  std::vector<Sample> samples = {at(0.0, 0.0, 10.0), at(0.01, 0.0, 10.1)};
  samples[1].joint_positions.pop_back();  // the reader has reported it
  set_joint_velocities(samples);
  set_joint_moves(samples);
  EXPECT_THAT(samples[0].joint_velocities, IsEmpty());
}

TEST(JointVelocities, OfARecordingThatHasThemAreKept) {
  std::vector<Sample> samples = {at(0.0, 0.0, 10.0), at(0.01, 0.0, 10.1)};
  samples[1].joint_velocities = {3.0, 4.0};
  set_joint_velocities(samples);
  EXPECT_THAT(samples[0].joint_velocities, IsEmpty());
  EXPECT_THAT(samples[1].joint_velocities, ElementsAre(3.0, 4.0));
}

Sample of_recording(const std::string& source, double run, double ticks) {
  Sample sample;
  sample.source = source;
  sample.conditions = {{std::string(kRun), run}, {"left", ticks}};
  return sample;
}

TEST(Before, IsOfTheSameRecordingAndRun) {
  std::vector<Sample> samples = {
      of_recording("a.csv:1", 1.0, 0.0), of_recording("a.csv:2", 1.0, 5.0),
      of_recording("a.csv:3", 2.0, 6.0), of_recording("b.csv:1", 2.0, 7.0),
      of_recording("b.csv:2", 2.0, 9.0)};
  set_before(samples, {"left"});
  EXPECT_THAT(samples[0].before, IsEmpty());
  EXPECT_EQ(samples[1].before.at("left"), 0.0);
  EXPECT_THAT(samples[2].before, IsEmpty()) << "another run";
  EXPECT_THAT(samples[3].before, IsEmpty()) << "another recording, whose run has the same number";
  EXPECT_EQ(samples[4].before.at("left"), 7.0);
}

}  // namespace
}  // namespace kinecal
