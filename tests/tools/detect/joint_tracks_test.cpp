// SPDX-License-Identifier: Apache-2.0
#include "kinecal/tools/detect/joint_tracks.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>
#include <vector>

namespace kinecal {
namespace {

using std::chrono::milliseconds;
using testing::AllOf;
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

/// Joint states of an arm of two joints: at (0.8, -0.6) until 1 s, then to (0.3, 0.4) within a second.
std::vector<double> place(double time) {
  const double way = one_move(time);
  return {0.8 - 0.5 * way, -0.6 + way};
}

/// A recording of 20 readings a second, with those of a second node.
/// @param zeros_after  a reading of zeros 10 ms after each n-th one; 0: none
JointTracks with_second_node(int zeros_after, milliseconds period = milliseconds(50)) {
  JointTracks tracks;
  int count = 0;
  for (Stamp t{}; t <= std::chrono::seconds(3); t += period) {
    tracks.add("joint_states",
               {kStart + t, {"pan", "tilt"}, place(std::chrono::duration<double>(t).count())});
    if (zeros_after == 0 || ++count % zeros_after != 0) continue;
    tracks.add("joint_states", {kStart + t + period / 5, {"tilt", "pan"}, {0.0, 0.0}});
  }
  return tracks;
}

TEST(JointTracks, TwoNodesThatPublishOneJointAreAnError) {
  for (const int zeros_after : {1, 2, 3, 20}) {
    for (const auto period : {milliseconds(50), milliseconds(5), milliseconds(1)}) {
      JointTracks tracks = with_second_node(zeros_after, period);
      EXPECT_THAT(chosen(tracks).errors,
                  ElementsAre(AllOf(HasSubstr("topic 'joint_states': joint 'pan' jumps from"),
                                    HasSubstr("and back"), HasSubstr("two nodes publish it"))))
          << zeros_after << ", " << period.count();
    }
  }
  JointTracks alone = with_second_node(0);
  EXPECT_THAT(chosen(alone).errors, IsEmpty());
  EXPECT_THAT(alone.standstills(), SizeIs(2));
}

TEST(JointTracks, ARestlessJointMayJump) {
  JointTracks tracks({"scanner"});
  for (int i = 0; i <= 60; ++i) {  // turns by half a turn from reading to reading
    tracks.add("joint_states",
               {kStart + i * milliseconds(50), {"arm", "scanner"}, {0.4, 1.5 * (i % 2)}});
  }
  EXPECT_THAT(chosen(tracks).errors, IsEmpty());
  EXPECT_THAT(tracks.standstills({"scanner"}), SizeIs(1));
}

TEST(JointTracks, TwoNodesWithDifferentListsOfJointsAreAnError) {
  for (const double of_second : {0.0, 0.8}) {  // the same as the driver, at first
    JointTracks tracks;
    for (int i = 0; i < 60; ++i) {
      const Stamp t = i * milliseconds(50);
      tracks.add("joint_states", {kStart + t, {"pan", "tilt"}, place(0.05 * i)});
      tracks.add("joint_states",
                 {kStart + t + milliseconds(20), {"pan", "finger"}, {of_second, 0.01}});
    }
    EXPECT_THAT(chosen(tracks).errors,
                ElementsAre(AllOf(HasSubstr("joint 'pan' is in two lists of joints, at"),
                                  HasSubstr("two nodes publish it"))));
  }
  JointTracks agree;
  for (int i = 0; i < 60; ++i) {
    const Stamp t = i * milliseconds(50);
    agree.add("joint_states", {kStart + t, {"pan", "tilt"}, place(0.05 * i)});
    agree.add(
        "joint_states",
        {kStart + t + milliseconds(20), {"pan", "finger"}, {place(0.05 * i + 0.02)[0], 0.01}});
  }
  EXPECT_THAT(chosen(agree).errors, IsEmpty());
}

TEST(JointTracks, ASingleFalseReadingIsLeftOutWithAWarning) {
  JointTracks broken;
  for (int i = 0; i <= 150; ++i) {
    broken.add("joint_states", {kStart + i * milliseconds(20),
                                {"pan", "tilt"},
                                i == 25 ? std::vector{0.0, 0.0} : place(0.02 * i)});
  }
  const Diagnostics diagnostics = chosen(broken);
  EXPECT_THAT(diagnostics.errors, IsEmpty());
  EXPECT_THAT(diagnostics.warnings,
              ElementsAre(HasSubstr("joint 'pan' jumps from 0.8 to 0 and back; so in 1 of 151 "
                                    "messages, which are left out")));
  const auto rests = broken.standstills();
  ASSERT_THAT(rests, SizeIs(2));
  EXPECT_NEAR(broken.positions(kStart + milliseconds(500), rests[0]).position("pan").value(), 0.8,
              1e-12);
}

TEST(JointTracks, ZerosBeforeTheFirstRealReadingAreLeftOut) {
  JointTracks tracks;
  for (int i = 0; i <= 150; ++i) {
    tracks.add("joint_states", {kStart + i * milliseconds(20),
                                {"pan", "tilt"},
                                i < 25 ? std::vector{0.0, 0.0} : place(0.02 * i)});
  }
  EXPECT_THAT(chosen(tracks).warnings,
              testing::Contains(HasSubstr("are zero in the first 25 messages, and jump")));
  const auto rests = tracks.standstills();
  ASSERT_THAT(rests, SizeIs(2));
  EXPECT_NEAR(seconds(rests[0].begin), 0.5, 0.02);
  JointTracks simulated;  // jumps from pose to pose, the first of which is zero
  for (int i = 0; i < 150; ++i) {
    const double pan = 0.4 * (i / 50);
    simulated.add("joint_states", {kStart + i * milliseconds(20), {"pan", "tilt"}, {pan, -pan}});
  }
  EXPECT_THAT(chosen(simulated).warnings, IsEmpty());
  EXPECT_THAT(simulated.standstills(), SizeIs(3));
}

TEST(JointTracks, ReadingsThatFlickerByACountAreARest) {
  for (const double count : {0.0042, 0.0015, 0.012}) {  // radians
    for (int seed = 1; seed <= 20; ++seed) {
      std::mt19937_64 random(static_cast<std::uint64_t>(seed));
      std::normal_distribution<double> noise(0.0, 0.36 * count);
      std::uniform_real_distribution<double> anywhere(-1.0, 1.0);
      const double from = anywhere(random), to = from + 0.7;
      JointTracks tracks;
      for (int i = 0; i <= 100; ++i) {  // 2 s, a move of 1 s, 2 s
        const double true_q = from + (to - from) * std::clamp(0.05 * i - 2.0, 0.0, 1.0);
        const double read = std::round((true_q + noise(random)) / count) * count;
        tracks.add("joint_states", {kStart + i * milliseconds(50), {"arm"}, {read}});
      }
      EXPECT_THAT(chosen(tracks).errors, IsEmpty());
      const auto rests = tracks.standstills();
      ASSERT_THAT(rests, SizeIs(2)) << count << ", seed " << seed;
      EXPECT_NEAR(seconds(rests[0].end), 2.0, 0.25);
      EXPECT_NEAR(seconds(rests[1].begin), 3.0, 0.25);
      // Twenty readings: a quarter of a count is five standard deviations of their mean.
      EXPECT_NEAR(tracks.positions(kStart + milliseconds(1000), rests[0]).position("arm").value(),
                  from, 0.4 * count);
    }
  }
}

TEST(JointTracks, AJointThatIsReportedWrappedAtHalfATurnStandsStill) {
  JointTracks tracks;
  for (int i = 0; i <= 60; ++i) {
    const double pi = std::acos(-1.0), q = pi + 1e-3 * std::sin(7.0 * i);
    tracks.add("joint_states",
               {kStart + i * milliseconds(50), {"roll"}, {std::remainder(q, 2.0 * pi)}});
  }
  EXPECT_THAT(chosen(tracks).errors, IsEmpty());
  const auto rests = tracks.standstills();
  ASSERT_THAT(rests, SizeIs(1));
  const double mean =
      tracks.positions(kStart + milliseconds(1500), rests[0]).position("roll").value();
  EXPECT_NEAR(std::cos(mean), -1.0, 1e-6);
}

}  // namespace
}  // namespace kinecal
