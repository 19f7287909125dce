#include "kinecal/robots/pipe_robot.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <thread>
#include <utility>

#include "support/error_of.hpp"
#include "support/paths.hpp"
#include "support/temporary_folder.hpp"

namespace kinecal {
namespace {

using test::error_of;
using testing::AllOf;
using testing::HasSubstr;

PipeRobot example() {
  return PipeRobot({"python3 " + test::source_folder() + "/examples/pipe_robot/robot.py"});
}

/// Waits until a program has made a file.
void wait_for(const std::string& file) {
  while (!std::filesystem::exists(file)) {
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
}

/// A program that answers each request with this.
PipeRobot answering(const std::string& answer) {
  return PipeRobot({"while read line; do echo '" + answer + "'; done"});
}

TEST(PipeRobot, TheExampleMovesAndMeasures) {
  PipeRobot robot = example();
  MeasuredJoints joints = robot.next_joints(Stamp::min());
  EXPECT_EQ(joints.position("pan").value(), 0.0);
  robot.move({{"pan"}, {0.5}, 0.5});  // takes 0.4 s
  const Stamp start = joints.stamp;
  while (joints.position("pan").value() < 0.5) {
    const MeasuredJoints next = robot.next_joints(joints.stamp);
    ASSERT_GT(next.stamp, joints.stamp);
    const std::chrono::duration<double> since = next.stamp - start;
    EXPECT_LE(joints.position("pan").value(), 0.5 / 0.4 * since.count());
    joints = next;
  }
  EXPECT_EQ(joints.position("pan").value(), 0.5);
}

TEST(PipeRobot, TheExampleSeesWhatMovesAndWhatIsLit) {
  PipeRobot robot = example();
  const Stamp lit = robot.light(8);
  const View view = robot.next_view(lit);
  EXPECT_GT(view.stamp, lit);
  EXPECT_EQ(view.frame, "camera_optical_frame");
  ASSERT_EQ(view.image.width, 64);
  ASSERT_EQ(view.image.height, 48);
  EXPECT_EQ(view.image(0, 0), 8);
  EXPECT_EQ(view.image(32, 20), 200);
  EXPECT_EQ(view.image(50, 20), 10);
  EXPECT_EQ(view.camera.value().p[2], 31.5);
}

TEST(PipeRobot, AnErrorOfTheProgramSkipsThePose) {
  PipeRobot robot = example();
  EXPECT_THAT(error_of([&] {
                robot.move({{"pan"}, {2.0}});
              }),
              AllOf(HasSubstr("pose: "), HasSubstr("robot.py': move: pan turns from -1.5")));
  robot.move({{"pan"}, {1.0}});
}

TEST(PipeRobot, AnAnswerThatCannotBeReadIsNamed) {
  const auto joints = [](const std::string& answer) {
    return error_of([&] { (void)answering(answer).next_joints(Stamp(5)); });
  };
  EXPECT_THAT(joints("garbage"),
              AllOf(HasSubstr("pose: "), HasSubstr("joints: the answer cannot be "
                                                   "read: 'garbage' is not JSON")));
  EXPECT_THAT(joints(std::string(200, ' ') + "{] " + std::string(200, ' ')),
              HasSubstr("  {]...' is not JSON, from character 202 on"));
  EXPECT_THAT(joints("{"), HasSubstr("'{' is not JSON: it ends too early"));
  EXPECT_THAT(joints(R"({"stamp": 1e999})"), HasSubstr("it has a number that is too large"));
  EXPECT_THAT(joints("{}"), HasSubstr("it has no field 'stamp'"));
  EXPECT_THAT(joints(R"({"stamp": "now"})"), HasSubstr("field 'stamp' is string"));
  EXPECT_THAT(joints(R"({"stamp": 5})"), HasSubstr("its stamp, 5, is not after 5 ns"));
  EXPECT_THAT(joints(R"({"stamp": 6, "names": ["a"], "positions": []})"),
              HasSubstr("there are 1 names and 0 positions"));
  EXPECT_THAT(joints(R"({"stamp": 6, "names": ["a"], "positions": ["b"]})"),
              HasSubstr("field 'positions[0]' is string; expected a number"));
}

TEST(PipeRobot, TheThirdUnreadableAnswerInARowEndsTheSession) {
  const auto ask = [](PipeRobot& robot) { return error_of([&] { (void)robot.light(1); }); };
  PipeRobot garbage = answering("garbage");
  EXPECT_THAT(ask(garbage), HasSubstr("pose: "));
  EXPECT_THAT(ask(garbage), HasSubstr("pose: "));
  EXPECT_THAT(ask(garbage), AllOf(HasSubstr("connection: "), HasSubstr("3 answers in a row")));
  PipeRobot other({"while read a; do echo x; read b; echo x; read c; echo '{\"stamp\": 1}'; done"});
  for (int i = 0; i < 4; ++i) {
    EXPECT_THAT(ask(other), HasSubstr("pose: "));
    EXPECT_THAT(ask(other), HasSubstr("pose: "));
    EXPECT_EQ(other.light(1), Stamp(1));
  }
}

TEST(PipeRobot, LinesThatNobodyAskedForAnswerNothing) {
  const test::TemporaryFolder folder;
  const std::string greeted = folder.path() / "greeted";
  // printf writes an answer and the line after it at once.
  PipeRobot robot(
      {"echo ready; touch " + greeted +
       "; n=0; while read a; do n=$((n+1)); printf '{\"stamp\": %d}\\nlog\\n' $n; done"});
  wait_for(greeted);
  for (int i = 1; i <= 5; ++i) EXPECT_EQ(robot.light(1), Stamp(i));
}

TEST(PipeRobot, WaitingCanBeInterrupted) {
  bool interrupted = false;
  PipeRobot robot(
      {"sleep 60", std::chrono::seconds(30), [&] { return std::exchange(interrupted, true); }});
  EXPECT_THAT(error_of([&] { (void)robot.light(1); }), HasSubstr("connection: interrupted"));
}

TEST(PipeRobot, AViewThatCannotBeReadIsNamed) {
  const auto view = [](const std::string& answer) {
    return error_of([&] {
      (void)answering(R"({"stamp": 6, "frame": "f", )" + answer + "}").next_view(Stamp(5));
    });
  };
  EXPECT_THAT(view(R"("x": 1)"), HasSubstr("it has neither 'image' nor 'depth'"));
  EXPECT_THAT(view(R"("image": "/none.png")"), HasSubstr("'/none.png' cannot be read"));
  EXPECT_THAT(view(R"("image": {"base64": "?"})"), HasSubstr("base64"));
  EXPECT_THAT(view(R"("image": {"base64": "aGVsbG8="})"), HasSubstr("the image"));
  EXPECT_THAT(view(R"("depth": "d.png")"), HasSubstr("depth needs the field 'camera'"));
  EXPECT_THAT(view(R"("camera": {"width": 1, "height": 1, "k": [1]})"),
              HasSubstr("field 'k' has 1 numbers; expected 9"));
}

/// Gray, 16 bits: 1000, 0, 65535.
const std::string kDepthPng =
    "iVBORw0KGgoAAAANSUhEUgAAAAMAAAABEAAAAABuG5crAAAAD0lEQVR4nGNgfsHA8P8/AAeeAuqgSIs/"
    "AAAAAElFTkSuQmCC";
/// Colour: white, black.
const std::string kColourPng =
    "iVBORw0KGgoAAAANSUhEUgAAAAIAAAABCAIAAAB7QOjdAAAAD0lEQVR4nGP4//8/AwMDAA74Av7Ji4P1"
    "AAAAAElFTkSuQmCC";

TEST(PipeRobot, DepthIsInMillimetresAndZeroIsNoPoint) {
  const View view =
      answering(R"({"stamp": 6, "frame": "f", "depth": {"base64": ")" + kDepthPng +
                R"("}, "camera": {"width": 3, "height": 1, "k": [2, 0, 0, 0, 2, 0, 0, 0, 1]}})")
          .next_view(Stamp(5));
  ASSERT_EQ(view.points.width, 3);
  EXPECT_FLOAT_EQ(view.points(0, 0).z(), 1.0F);
  EXPECT_TRUE(std::isnan(view.points(1, 0).z()));
  EXPECT_FLOAT_EQ(view.points(2, 0).z(), 65.535F);
  EXPECT_FLOAT_EQ(view.points(2, 0).x(), 65.535F);  // (u - cx) z / fx with u = fx
}

TEST(PipeRobot, ColourBecomesBrightnessButNotDepth) {
  const std::string colour = R"({"stamp": 6, "frame": "f", "image": {"base64": ")" + kColourPng;
  const View view = answering(colour + "\"}}").next_view(Stamp(5));
  EXPECT_EQ(view.image(0, 0), 255);
  EXPECT_EQ(view.image(1, 0), 0);
  std::string depth =
      colour + R"("}, "camera": {"width": 2, "height": 1, "k": )" + "[2, 0, 0, 0, 2, 0, 0, 0, 1]}}";
  depth.replace(depth.find("image"), 5, "depth");
  EXPECT_THAT(error_of([&] { (void)answering(depth).next_view(Stamp(5)); }),
              HasSubstr("the answer cannot be read: the image"));
}

TEST(PipeRobot, AProgramThatEndsEndsTheSession) {
  PipeRobot robot({"read line; exit 5"});
  EXPECT_THAT(error_of([&] { (void)robot.light(1); }),
              HasSubstr("connection: 'read line; exit 5' ended with exit code 5"));
  EXPECT_THAT(error_of([&] { (void)robot.light(1); }), HasSubstr("connection: "));
}

TEST(PipeRobot, AnAnswerThatComesTooLateIsNotTheNextOne) {
  const test::TemporaryFolder folder;
  const std::string go = folder.path() / "go", late = folder.path() / "late";
  PipeRobot robot({"read a; until test -e " + go +
                       "; do sleep 0.01; done; echo '{\"stamp\": 1}'; touch " + late +
                       "; read b; echo '{\"stamp\": 2}'",
                   std::chrono::seconds(2)});
  EXPECT_THAT(error_of([&] { (void)robot.light(1); }), HasSubstr("no answer within 2.000 s"));
  EXPECT_THAT(error_of([&] { (void)robot.light(1); }), HasSubstr("it still has not answered"));
  std::ofstream(go) << "now";
  wait_for(late);
  EXPECT_EQ(robot.light(2), Stamp(2));
}

TEST(PipeRobot, AProgramThatHangsIsNamedBeforeItIsGivenUp) {
  std::vector<std::string> said;
  PipeOptions options{"sleep 60", std::chrono::milliseconds(200)};
  options.patience = std::chrono::milliseconds(50);
  options.slow = [&](const std::string& what) { said.push_back(what); };
  PipeRobot robot(options);
  EXPECT_THAT(error_of([&] { (void)robot.light(1); }), HasSubstr("no answer within 0.200 s"));
  ASSERT_EQ(said.size(), 1u);
  EXPECT_THAT(said[0],
              HasSubstr("'sleep 60': light: no answer for 0.050 s; waiting until 0.200 s"));
}

TEST(PipeRobot, AProgramThatAnswersNoMoreIsSilentSinceItsLastAnswer) {
  PipeRobot robot({"read a; echo '{\"stamp\": 7}'; sleep 60", std::chrono::seconds(2)});
  EXPECT_EQ(robot.light(1), Stamp(7));
  const auto silence = [&](int code) {
    try {
      (void)robot.light(code);
    } catch (const SilenceError& error) {
      EXPECT_THAT(error.stream, HasSubstr("light"));
      return error.newest;
    }
    return std::optional<Stamp>();
  };
  EXPECT_EQ(silence(2), Stamp(7));
  EXPECT_EQ(silence(3), Stamp(7)) << "it still has not answered";
}

}  // namespace
}  // namespace kinecal
