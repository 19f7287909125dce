#include "kinecal/capture/session/settling.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "support/thrown.hpp"
#include "support/toy_robot.hpp"

namespace kinecal {
namespace {

using std::chrono::milliseconds;
using test::ToyArm;
using test::ToyCamera;
using ::testing::AllOf;
using ::testing::HasSubstr;

JointTarget target(double pan, double tilt) {
  return {{"pan", "tilt"}, {pan, tilt}};
}

TEST(Settling, WaitsUntilTheJointsHaveArrivedAndAveragesTheirNoise) {
  ToyArm arm;
  const Stamp start = arm.now;
  arm.move(target(0.5, -0.8));
  const MeasuredJoints joints = settle_joints(arm, target(0.5, -0.8), start);
  EXPECT_NEAR(joints.positions[0], 0.5, 1e-4);
  EXPECT_NEAR(joints.positions[1], -0.8, 1e-3);  // its last step may be in the window
  EXPECT_GE(joints.stamp - start, milliseconds(100 + 800 + 250));  // latency, motion, window
  EXPECT_LE(joints.stamp - start, milliseconds(1600));
}

TEST(Settling, DoesNotTakeTheRestBeforeTheMotionForTheEnd) {
  ToyArm arm;
  for (int i = 0; i < 100; ++i) arm.advance();
  arm.move(target(0.01, 0.0));  // less than the tolerance of arrival
  const MeasuredJoints joints = settle_joints(arm, target(0.01, 0.0), arm.now);
  EXPECT_NEAR(joints.positions[0], 0.01, 1e-3);
}

TEST(Settling, NamesTheJointThatDoesNotArrive) {
  ToyArm arm;
  arm.stuck = "tilt";
  arm.move(target(0.5, 0.8));
  EXPECT_THAT(test::thrown<PoseError>([&] { (void)settle_joints(arm, target(0.5, 0.8), arm.now); }),
              AllOf(HasSubstr("joint 'tilt' did not arrive"), HasSubstr("0.8 was asked for")));
}

TEST(Settling, NamesWhatDoesNotStopOrIsNotMeasured) {
  ToyArm arm;
  arm.creeping = "pan";
  EXPECT_THAT(test::thrown<PoseError>([&] { (void)settle_joints(arm, {}, arm.now); }),
              HasSubstr("joints do not stop; waited 30"));
  ToyArm other;
  const JointTarget misspelt{{"tlit"}, {0.0}};
  EXPECT_THAT(test::thrown<PoseError>([&] { (void)settle_joints(other, misspelt, other.now); }),
              AllOf(HasSubstr("joint 'tlit' of the pose is not measured"), HasSubstr("'tilt'")));
}

TEST(Settling, RefusesReadingsThatCannotBe) {
  JointRest rest(SettleOptions{});
  rest.add({milliseconds(10), {"pan"}, {0.0}});
  EXPECT_THROW(rest.add({milliseconds(10), {"pan"}, {0.0}}), PoseError);  // the same stamp
  EXPECT_THROW(rest.add({milliseconds(20), {"tilt"}, {0.0}}), PoseError);
  EXPECT_THROW(rest.add({milliseconds(20), {"pan"}, {std::nan("")}}), PoseError);
  EXPECT_THROW(rest.add({milliseconds(20), {"pan", "tilt"}, {0.0}}), PoseError);
  EXPECT_THROW(rest.add({milliseconds(20), {}, {}}), PoseError);
}

TEST(Settling, WaitsForAnImageInWhichNothingMoves) {
  ToyArm arm;
  ToyCamera camera{arm};
  arm.move(target(1.0, 0.0));
  for (int i = 0; i < 20; ++i) arm.advance();
  const View view = settle_image([&](Stamp after) { return camera.next_view(after); }, arm.now);
  // The square moves by one pixel in 50 ms, which changes 40 of 4096 pixels.
  EXPECT_GE(view.stamp, std::chrono::seconds(1000) + milliseconds(1100));
}

TEST(Settling, SaysThatTheImageDoesNotRestOrHasAnotherClock) {
  ToyArm arm;
  ToyCamera camera{arm};
  const auto next = [&](Stamp after) { return camera.next_view(after); };
  camera.flickers = true;
  EXPECT_THAT(test::thrown<PoseError>([&] { (void)settle_image(next, arm.now); }),
              HasSubstr("the image does not come to rest"));
  camera.flickers = false;
  camera.ahead = std::chrono::seconds(100);
  EXPECT_THAT(test::thrown<PoseError>([&] { (void)settle_image(next, arm.now); }),
              HasSubstr("the camera's stamps are 100 s ahead"));
}

TEST(Settling, SaysThatTheSizeOfTheImageChanges) {
  ToyArm arm;
  ToyCamera camera{arm};
  const auto next = [&](Stamp after) {
    camera.size += 2;
    return camera.next_view(after);
  };
  EXPECT_THAT(test::thrown<PoseError>([&] { (void)settle_image(next, arm.now); }),
              HasSubstr("changes from 66 x 66 to 68 x 68"));
}

/// Whether a joint that is read every 20 ms counts as still.
template <class Read>
bool rests(Read&& read, const SettleOptions& options = {}) {
  JointRest rest(options);
  for (int i = 0; i < 40; ++i) rest.add({i * milliseconds(20), {"pan"}, {read(i)}});
  return rest.still();
}

TEST(Settling, TwoNodesThatPublishAJointInTurnAreNoRest) {
  EXPECT_TRUE(rests([](int) { return 0.8; }));
  EXPECT_TRUE(rests([](int i) { return 0.8 + 0.004 * (i % 2); }));  // a count of an encoder
  EXPECT_FALSE(rests([](int i) { return i % 2 == 0 ? 0.8 : 0.0; }));
  EXPECT_FALSE(rests([](int i) { return i % 3 == 0 ? 0.8 : 0.0; }));
  EXPECT_FALSE(rests([](int i) { return i % 16 == 0 ? 0.0 : 0.8; }));
  JointRest rest(SettleOptions{});
  for (int i = 0; i < 40; ++i) rest.add({i * milliseconds(20), {"pan"}, {i % 2 == 0 ? 0.8 : 0.0}});
  EXPECT_THAT(rest.why_not_still(),
              AllOf(HasSubstr("joint 'pan' jump between 0 and 0.8"), HasSubstr("two nodes")));
}

TEST(Settling, AContinuousJointArrivesAWholeTurnAway) {
  const double turn = 2.0 * std::acos(-1.0);
  SettleOptions options;
  options.continuous = {"pan"};
  for (const double turns : {-2.0, -1.0, 0.0, 1.0}) {
    JointRest rest(options), revolute(SettleOptions{});
    for (int i = 0; i < 20; ++i) {
      rest.add({i * milliseconds(20), {"pan"}, {0.5 + turns * turn}});
      revolute.add({i * milliseconds(20), {"pan"}, {0.5 + turns * turn}});
    }
    ASSERT_TRUE(rest.still());
    const JointTarget goal{{"pan"}, {0.5}}, elsewhere{{"pan"}, {0.6}};
    EXPECT_EQ(rest.not_arrived(goal), "");
    EXPECT_NE(rest.not_arrived(elsewhere), "");
    EXPECT_EQ(revolute.not_arrived(goal).empty(), turns == 0.0);
  }
}

TEST(Settling, AJointThatIsReportedWrappedAtHalfATurnIsStill) {
  const double pi = std::acos(-1.0);
  EXPECT_TRUE(rests([&](int i) { return i % 2 == 0 ? pi - 2e-4 : -pi + 2e-4; }));
}

}  // namespace
}  // namespace kinecal
