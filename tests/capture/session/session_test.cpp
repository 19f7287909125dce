#include "kinecal/capture/session/session.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "support/thrown.hpp"
#include "support/toy_robot.hpp"

namespace kinecal {
namespace {

using std::chrono::milliseconds;
using test::ToyArm;
using test::ToyCamera;
using test::ToyFinder;
using ::testing::AllOf;
using ::testing::HasSubstr;

std::vector<CapturePose> five_poses() {
  std::vector<CapturePose> poses;
  for (int i = 0; i < 5; ++i) poses.push_back({{"pan", "tilt"}, {0.1 * i, -0.2 * i}, {}});
  return poses;
}

/// A session of the toy robot.
struct ToySession {
  ToyArm arm;
  ToyCamera camera{arm};
  std::vector<SessionFinder> finders = {session_finder("square", ToyFinder{}, camera)};
  std::vector<CapturedPose> captured = {};
  std::vector<Sample> samples = {};

  void run(const std::vector<CapturePose>& poses) {
    run_session(arm, poses_of(poses), finders, [&](const CapturedPose& pose) {
      captured.push_back(pose);
      samples.insert(samples.end(), pose.samples.begin(), pose.samples.end());
    });
  }
};

TEST(Session, RecordsASampleInEachPose) {
  ToySession session;
  session.run(five_poses());
  ASSERT_EQ(session.samples.size(), 5u);
  for (int i = 0; i < 5; ++i) {
    const Sample& sample = session.samples[static_cast<std::size_t>(i)];
    EXPECT_NEAR(sample.position("pan").value(), 0.1 * i, 1e-3);
    EXPECT_NEAR(sample.position("tilt").value(), -0.2 * i, 1e-3);
    EXPECT_EQ(sample.observation("camera")->features.front().point.x(), 20 + 2 * i);
    EXPECT_NE(sample.observation("arm"), nullptr);
  }
  EXPECT_GT(session.captured[1].duration, milliseconds(600));
}

TEST(Session, SkipsAPoseThatFailsAndSaysWhy) {
  ToySession session;
  std::vector<CapturePose> poses = five_poses();
  poses[2].joint_names = {"pan", "tlit"};
  session.run(poses);
  EXPECT_EQ(session.samples.size(), 4u);
  EXPECT_THAT(session.captured[2].failure, HasSubstr("no joint 'tlit'"));
  EXPECT_TRUE(session.captured[3].failure.empty());
}

TEST(Session, KeepsWhatAFinderSaysWhereItFindsNothing) {
  ToySession session;
  session.run({{{"pan"}, {3.0}, {}}});  // the square is out of the image
  EXPECT_TRUE(session.samples.empty());
  EXPECT_TRUE(session.captured[0].failure.empty());
  EXPECT_THAT(session.captured[0].outcomes.front().found.refusal, HasSubstr("no square"));
}

TEST(Session, EndsWithTheRobotAndResumesWithTheRest) {
  ToySession session;
  session.arm.moves_left = 3;
  EXPECT_THROW(session.run(five_poses()), ConnectionError);
  EXPECT_EQ(session.samples.size(), 3u);
  const std::vector<CapturePose> left = poses_left(five_poses(), session.samples);
  ASSERT_EQ(left.size(), 2u);
  EXPECT_EQ(left.front(), five_poses()[3]);
  ToySession rest;
  rest.run(left);
  EXPECT_EQ(rest.samples.size(), 2u);
}

TEST(Session, APoseThatIsThereTwiceIsCapturedTwice) {
  std::vector<CapturePose> poses = five_poses();
  poses.push_back(poses.front());
  ToySession session;
  session.run(five_poses());
  EXPECT_EQ(poses_left(poses, session.samples).size(), 1u);
}

TEST(Session, RunsTheFindersThatAPoseAsksFor) {
  ToySession session;
  session.finders.push_back(session_finder("other", ToyFinder{"other_camera"}, session.camera));
  session.run({{{"pan"}, {0.1}, {"other"}}, {{"pan"}, {0.2}, {}}});
  ASSERT_EQ(session.captured[0].outcomes.size(), 1u);
  EXPECT_EQ(session.captured[0].outcomes[0].finder, "other");
  // Both observe with the sensor "arm", so they give two samples of one pose.
  ASSERT_EQ(session.captured[1].samples.size(), 2u);
  EXPECT_EQ(session.captured[1].samples[0].joint_positions,
            session.captured[1].samples[1].joint_positions);
  EXPECT_TRUE(
      poses_left(std::vector{session.captured[1].pose}, session.captured[1].samples).empty());
  EXPECT_THROW(session.run({{{"pan"}, {0.1}, {"othr"}}}), std::invalid_argument);
}

TEST(Session, APersonMayMoveTheRobot) {
  ToySession session;
  int left = 3;
  const NextPose next = [&]() -> std::optional<CapturePose> {
    if (left-- == 0) return std::nullopt;
    session.arm.move({{"pan"}, {0.1 * left}});
    return CapturePose{};
  };
  run_session(session.arm, next, session.finders, [&](const CapturedPose& pose) {
    session.samples.insert(session.samples.end(), pose.samples.begin(), pose.samples.end());
  });
  ASSERT_EQ(session.samples.size(), 3u);
  EXPECT_NEAR(session.samples[0].position("pan").value(), 0.2, 2e-3);
}

TEST(Session, DropsASampleIfAJointMovesWhileFindersLook) {
  ToySession session;
  session.finders.front().find = [&](const View& view) {
    session.arm.move({{"tilt"}, {1.0}});
    return ToyFinder{}.find(view);
  };
  session.run({{{"pan"}, {0.1}, {}}});
  EXPECT_TRUE(session.samples.empty());
  EXPECT_THAT(session.captured[0].failure, HasSubstr("joint 'tilt' moved while finders looked"));
}

TEST(Session, EndsWhenAStreamIsSilentInTwoPoses) {
  ToySession session;
  session.arm.readings_left = 200;
  const std::string why = test::thrown<ConnectionError>([&] { session.run(five_poses()); });
  EXPECT_THAT(why, AllOf(HasSubstr("no joint states since 1000"), HasSubstr("in two poses")));
  ASSERT_GT(session.samples.size(), 0u);
  ASSERT_EQ(session.captured.size(), session.samples.size() + 2) << "not all that were left";
  EXPECT_THAT(session.captured.back().failure, HasSubstr("no joint states"));
}

/// Captured poses of a session of five whose camera is silent in the second and the fourth.
/// @param delivers  stamps of what it delivered before
std::size_t poses_with_silences(const std::vector<std::optional<Stamp>>& delivers) {
  ToySession session;
  int pose = 0;
  std::size_t silence = 0;
  session.finders.front().next_view = [&](Stamp after) {
    if (pose % 2 == 1) throw SilenceError("no images", "/image", delivers[silence++]);
    return session.camera.next_view(after);
  };
  NextPose next = poses_of(five_poses());
  const auto count = [&](const CapturedPose& captured) {
    session.captured.push_back(captured);
    ++pose;
  };
  try {
    run_session(session.arm, next, session.finders, count);
  } catch (const ConnectionError&) {
  }
  return session.captured.size();
}

TEST(Session, AStreamThatDeliversBetweenItsSilencesOnlySkipsPoses) {
  EXPECT_EQ(poses_with_silences({Stamp(1), Stamp(2)}), 5u);
  EXPECT_EQ(poses_with_silences({std::nullopt, Stamp(2)}), 5u);
  EXPECT_EQ(poses_with_silences({Stamp(1), Stamp(1)}), 4u);
  EXPECT_EQ(poses_with_silences({std::nullopt, std::nullopt}), 4u);
}

/// Why a session ends without hope; empty if it does not.
std::string hopeless(ToySession& session, const std::vector<CapturePose>& poses) {
  return test::thrown<HopelessError>([&] { session.run(poses); }, "");
}

TEST(Session, EndsWhenThreePosesFailAlikeAndNothingWasFound) {
  ToySession session;
  session.arm.stuck = "tilt";
  std::vector<CapturePose> poses = five_poses();
  poses.erase(poses.begin());
  EXPECT_THAT(hopeless(session, poses), AllOf(HasSubstr("the same in 3 poses in a row"),
                                              HasSubstr("joint 'tilt' did not arrive")));
  EXPECT_EQ(session.captured.size(), 3u);
  EXPECT_TRUE(session.samples.empty());
}

TEST(Session, GoesOnOnceSomethingWasFound) {
  ToySession session;
  int views = 0;
  session.finders.front().find = [&](const View& view) {
    return ++views == 1 ? ToyFinder{}.find(view) : refused("no board");
  };
  EXPECT_EQ(hopeless(session, five_poses()), "");
  EXPECT_EQ(session.captured.size(), 5u);
}

TEST(Session, LooksBeforeItMoves) {
  ToySession session;
  EXPECT_THAT(hopeless(session, {{{"pan", "titl"}, {0.1, 0.2}, {}}}),
              AllOf(HasSubstr("joint 'titl' of the poses is not measured; did you mean 'tilt'?"),
                    HasSubstr("the robot has not moved")));
  session.finders.front().fault = [](const View&) { return std::string("no camera_info"); };
  EXPECT_THAT(hopeless(session, five_poses()), HasSubstr("square: no camera_info"));
  session.finders.front().fault = {};
  session.finders.front().next_view = [&](Stamp after) {
    View view = session.camera.next_view(after);
    view.stamp += std::chrono::seconds(100);
    return view;
  };
  EXPECT_THAT(hopeless(session, five_poses()), HasSubstr("camera's stamps are"));
  EXPECT_TRUE(session.captured.empty());
}

TEST(Session, EndsWithAFrozenCamera) {
  ToySession session;
  std::optional<View> frozen;
  session.finders[0].next_view = [&](Stamp after) {
    View view = session.camera.next_view(after);
    if (session.captured.size() < 2) return view;
    if (!frozen) frozen = view;
    view.image = frozen->image;  // with stamps that advance
    return view;
  };
  const auto run = [&] { session.run(five_poses()); };
  EXPECT_THAT([&] { run(); },
              testing::ThrowsMessage<ConnectionError>(AllOf(
                  HasSubstr("square: its camera is frozen"), HasSubstr("joint 'pan' has moved"))));
  EXPECT_EQ(session.captured.size(), 5u);
  EXPECT_EQ(session.samples.size(), 3u);
}

TEST(Session, AnImageOfARobotThatDidNotMoveMayBeTheSame) {
  ToySession session;
  session.arm.noise = 0.0;
  session.run({{{"pan", "tilt"}, {0.2, 0.1}, {}}, {{"pan", "tilt"}, {0.2, 0.1}, {}}});
  EXPECT_EQ(session.samples.size(), 2u);
}

TEST(Session, EndsBeforeAMotionIfPositionsAreInDegrees) {
  const Robot robot(
      "r", {{.name = "pan",
             .type = JointType::revolute,
             .parent = "base",
             .child = "head",
             .limits = JointLimits{-1.5, 1.5}},
            {.name = "roll", .type = JointType::continuous, .parent = "head", .child = "tool"}});
  const auto said = [&](const std::string& joint, double q) {
    return like_degrees({Stamp{}, {joint}, {q}}, robot);
  };
  EXPECT_THAT(said("pan", 28.6), AllOf(HasSubstr("joint 'pan' is at 28.6"), HasSubstr("degrees")));
  EXPECT_THAT(said("pan", -6.0), HasSubstr("degrees"));
  EXPECT_EQ(said("pan", 1.6), "");    // a little beyond its limits
  EXPECT_EQ(said("roll", 25.0), "");  // four turns
  EXPECT_EQ(said("other", 90.0), "");
  ToySession session;
  SessionOptions options;
  options.fault = [](const MeasuredJoints&) { return std::string("degrees"); };
  EXPECT_THAT(
      [&] {
        run_session(
            session.arm, poses_of(five_poses()), session.finders,
            [&](const CapturedPose& pose) { session.captured.push_back(pose); }, options);
      },
      testing::ThrowsMessage<HopelessError>(HasSubstr("degrees; the robot has not moved")));
  EXPECT_TRUE(session.captured.empty());
}

TEST(Session, ResumesWhereAContinuousJointIsAWholeTurnAway) {
  Sample sample;
  sample.joint_names = {"pan"};
  sample.joint_positions = {0.3 + 2.0 * std::acos(-1.0)};
  const std::vector<CapturePose> poses = {{{"pan"}, {0.3}, {}}};
  SettleOptions settling;
  EXPECT_EQ(poses_left(poses, std::vector{sample}, settling).size(), 1u);
  settling.continuous = {"pan"};
  EXPECT_TRUE(poses_left(poses, std::vector{sample}, settling).empty());
}

}  // namespace
}  // namespace kinecal
