// SPDX-License-Identifier: Apache-2.0
#include "kinecal/tools/detect/joint_tracks.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

namespace kinecal {
namespace {

using std::chrono::milliseconds;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

const Stamp kStart = std::chrono::seconds(1'700'000'000);

double seconds(Stamp stamp) {
  return std::chrono::duration<double>(stamp - kStart).count();
}

/// Where a joint is at a time, seconds.
using Motion = std::function<double(double time)>;

/// At 0 until 1 s, then to 1 within a second.
double one_move(double t) {
  return std::clamp(t - 1.0, 0.0, 1.0);
}
double stands(double) {
  return 0.5;
}

/// Three seconds of joint states.
void record(JointTracks& tracks, const std::string& topic, const std::string& joint,
            const Motion& motion, milliseconds period = milliseconds(20), Stamp start = kStart) {
  for (Stamp t{}; t <= std::chrono::seconds(3); t += period) {
    const double time = std::chrono::duration<double>(t).count();
    const double noise = 2e-4 * std::sin(1e3 * time);
    tracks.add(topic, {start + t, {joint}, {motion(time) + noise}});
  }
}

Diagnostics chosen(JointTracks& tracks, const std::vector<std::string>& topics = {}) {
  Diagnostics diagnostics;
  tracks.choose(topics, "a.bag", diagnostics);
  return diagnostics;
}

TEST(JointTracks, APositionThatIsNoNumberIsAGapOrNoJoint) {
  JointTracks tracks;
  for (int n = 0; n <= 150; ++n) {
    const double time = 0.02 * n, lost = n % 50 == 20 ? std::nan("") : stands(time);
    tracks.add("joint_states", {kStart + n * milliseconds(20),
                                {"arm", "wrist", "finger"},
                                {one_move(time), lost, std::nan("")}});
  }
  const Diagnostics found = chosen(tracks);
  EXPECT_THAT(found.errors, IsEmpty());
  EXPECT_THAT(found.warnings,
              ElementsAre(HasSubstr("the position of joint 'finger' is not a number in 151"),
                          HasSubstr("the position of joint 'wrist' is not a number in 3")));
  EXPECT_THAT(tracks.names(), ElementsAre("arm", "wrist"));
  EXPECT_THAT(tracks.standstills(), SizeIs(2));
}

TEST(JointTracks, TheRobotStandsStillBeforeAndAfterAMotion) {
  for (const auto period : {milliseconds(1), milliseconds(20), milliseconds(100)}) {
    JointTracks tracks;
    record(tracks, "joint_states", "arm", one_move, period);
    EXPECT_THAT(chosen(tracks).errors, IsEmpty());
    const auto rests = tracks.standstills();
    ASSERT_THAT(rests, SizeIs(2)) << period.count();
    EXPECT_NEAR(seconds(rests[0].begin), 0.0, 0.02);
    EXPECT_NEAR(seconds(rests[0].end), 1.0, 0.11);
    EXPECT_NEAR(seconds(rests[1].begin), 2.0, 0.11);
    EXPECT_NEAR(seconds(rests[1].end), 3.0, 0.02);
    const MeasuredJoints joints = tracks.positions(kStart + milliseconds(2500), rests[1]);
    EXPECT_NEAR(joints.position("arm").value(), 1.0, 2e-4);
  }
}

TEST(JointTracks, ItStandsStillOnlyWhileAllJointsOfAllNodesDo) {
  JointTracks tracks;
  record(tracks, "joint_states", "arm", one_move);
  record(
      tracks, "base/joint_states", "wheel", [](double t) { return one_move(t - 1.5); },
      milliseconds(33));
  EXPECT_THAT(chosen(tracks).errors, IsEmpty());
  const auto rests = tracks.standstills();
  ASSERT_THAT(rests, SizeIs(2));  // from 0 to 1 s and from 2 to 2.5 s
  EXPECT_NEAR(seconds(rests[1].end), 2.5, 0.1);
  const MeasuredJoints joints = tracks.positions(kStart + milliseconds(2200), rests[1]);
  EXPECT_NEAR(joints.position("arm").value(), 1.0, 2e-4);
  EXPECT_NEAR(joints.position("wheel").value(), 0.0, 2e-4);
}

TEST(JointTracks, ASlowMotionIsNoStandstill) {
  JointTracks tracks;
  record(tracks, "joint_states", "arm", [](double t) { return 0.02 * t; });
  (void)chosen(tracks);
  EXPECT_THAT(tracks.standstills(), IsEmpty());
  EXPECT_THAT(tracks.never_still(), ElementsAre("arm"));
}

TEST(JointTracks, AJointThatAlwaysTurnsCanBeLeftOut) {
  JointTracks tracks;
  record(tracks, "joint_states", "arm", one_move);
  record(tracks, "joint_states", "scanner", [](double t) { return 3.0 * t; });
  (void)chosen(tracks);
  EXPECT_THAT(tracks.standstills(), IsEmpty());
  EXPECT_THAT(tracks.never_still(), ElementsAre("scanner"));
  EXPECT_THAT(tracks.standstills({"scanner"}), SizeIs(2));
}

TEST(JointTracks, NobodyKnowsWhatHappensInAGap) {
  JointTracks tracks;
  record(tracks, "joint_states", "arm", stands);
  record(tracks, "joint_states", "arm", stands, milliseconds(20),
         kStart + std::chrono::seconds(10));
  (void)chosen(tracks);
  EXPECT_THAT(tracks.standstills(), SizeIs(2));
}

TEST(JointTracks, MessagesOutOfOrderAreSorted) {
  JointTracks tracks;
  for (int i = 0; i < 100; ++i) {
    const int late = i % 2 == 0 ? i + 1 : i - 1;
    tracks.add("joint_states", {kStart + milliseconds(20 * late), {"arm"}, {0.1}});
  }
  EXPECT_THAT(chosen(tracks).errors, IsEmpty());
  EXPECT_THAT(tracks.standstills(), SizeIs(1));
}

TEST(JointTracks, StampsThatGoBackAreAnError) {
  JointTracks tracks;
  record(tracks, "joint_states", "arm", stands);
  record(tracks, "joint_states", "arm", stands);
  EXPECT_THAT(chosen(tracks).errors,
              ElementsAre(HasSubstr("a.bag: topic 'joint_states': stamps go back from")));
}

TEST(JointTracks, AJointOnTwoTopicsHasToBeChosen) {
  JointTracks tracks;
  record(tracks, "arm/states", "arm", stands);
  record(tracks, "arm/goals", "arm", one_move);
  JointTracks some = tracks;
  EXPECT_THAT(
      chosen(tracks).errors,
      ElementsAre(HasSubstr("joint 'arm' is on several topics: 'arm/goals', 'arm/states'")));
  EXPECT_THAT(chosen(some, {"arm/states"}).errors, IsEmpty());
  EXPECT_THAT(some.standstills(), SizeIs(1));
}

TEST(JointTracks, OfTwoTopicsJointStatesIsTaken) {
  JointTracks tracks;
  record(tracks, "goals", "arm", one_move);
  record(tracks, "joint_states", "arm", stands);
  const Diagnostics diagnostics = chosen(tracks);
  EXPECT_THAT(diagnostics.errors, IsEmpty());
  EXPECT_THAT(diagnostics.notes, ElementsAre(HasSubstr("'arm' are taken from topic")));
  EXPECT_THAT(tracks.standstills(), SizeIs(1));
}

TEST(JointTracks, AJointThatIsMeasuredForAWhileOnlyIsAWarning) {
  JointTracks tracks;
  record(tracks, "joint_states", "arm", stands);
  record(tracks, "joint_states", "arm", stands, milliseconds(20), kStart + std::chrono::seconds(4));
  record(tracks, "gripper", "finger", stands);
  const Diagnostics diagnostics = chosen(tracks);
  EXPECT_THAT(diagnostics.errors, IsEmpty());
  EXPECT_THAT(diagnostics.warnings,
              ElementsAre(HasSubstr("joints 'finger' were measured for 3 s of 7 s")));
  EXPECT_THAT(tracks.standstills(), SizeIs(1));
  EXPECT_THAT(tracks.standstills({"finger"}), SizeIs(2));
}

TEST(JointTracks, WithoutPositionsThereIsNothing) {
  JointTracks none;
  EXPECT_THAT(chosen(none).errors, ElementsAre(HasSubstr("has no joint positions")));
  JointTracks silent;
  silent.add("wheels", {kStart, {"wheel"}, {}});
  const Diagnostics diagnostics = chosen(silent, {"weels"});
  EXPECT_THAT(diagnostics.warnings, ElementsAre(HasSubstr("without positions")));
  EXPECT_THAT(diagnostics.errors, ElementsAre(HasSubstr("no joint positions on topic 'weels'")));
  JointTracks few;
  few.add("joint_states", {kStart, {"arm"}, {1.0}});
  EXPECT_THAT(chosen(few).warnings,
              ElementsAre(HasSubstr("'arm' of topic 'joint_states' are left")));
}

}  // namespace
}  // namespace kinecal
