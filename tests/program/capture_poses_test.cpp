// kinecal capture_poses: a person moves a robot, which a script plays, and presses keys.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "kinecal/files/poses/poses.hpp"
#include "kinecal/files/recordings/pose_messages.hpp"
#include "support/paths.hpp"
#include "support/run_program.hpp"

namespace kinecal::test {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;
using Names = std::vector<std::string>;

/// The elbow stands at each of the given positions for four readings, as many as it takes to see that
/// it stands still; for "moves" it moves until nobody waits any longer.
constexpr const char* kRobot = R"(import json, sys
elbow = []
for where in sys.argv[1].split(","):
    elbow += [0.1 * i for i in range(32)] if where == "moves" else 4 * [float(where)]
for reading, line in enumerate(sys.stdin):
    stamp = max(json.loads(line)["joints"]["after"], 0) + 100_000_000
    position = elbow[min(reading, len(elbow) - 1)]
    print(json.dumps({"stamp": stamp, "names": ["wheel", "elbow_flex_joint", "head_pan_joint"],
                      "positions": [7.0, position, -0.25]}), flush=True)
)";

constexpr const char* kPosesConfig = R"(chains:
- {name: head, topic: /head, joints: [head_pan_joint]}
- {name: arm, topic: /arm, joints: [elbow_flex_joint]}
features:
  leds: {type: robot_calibration/PlaneFinder, topic: /points}
  ground: {type: robot_calibration/PlaneFinder, topic: /points}
)";

class CapturePoses : public ProgramTest {
 protected:
  /// A session with a robot that is put here, and a person who types this.
  [[nodiscard]] Outcome poses(const std::string& where, const std::string& keys,
                              const std::string& options = "-o poses.yaml") const {
    write("robot.py", kRobot);
    write("capture.yaml", kPosesConfig);
    write("keys.txt", keys);
    return run(kinecal_program() + " capture_poses capture.yaml --robot 'pipe:python3 robot.py " +
               where + "' --urdf " + source_folder() +
               "/examples/mobile_manipulator/mobile_manipulator.urdf " + options + " < keys.txt");
  }
  /// Poses of poses.yaml.
  [[nodiscard]] std::vector<CapturePose> written() const {
    Diagnostics diagnostics;
    std::vector<CapturePose> all = read_poses_yaml((folder_ / "poses.yaml").string(), diagnostics);
    EXPECT_TRUE(diagnostics.errors.empty());
    EXPECT_TRUE(diagnostics.warnings.empty());
    return all;
  }
};

TEST_F(CapturePoses, RecordsTheJointsOfTheChainsAtEachEnter) {
  const Outcome done = poses("0.5,1.5", "\n\nq\n\n");
  EXPECT_EQ(done.code, 0) << done.err;
  EXPECT_THAT(done.out, AllOf(HasSubstr("pose 2: all features"), HasSubstr("poses.yaml: 2 poses")));
  const Names joints = {"head_pan_joint", "elbow_flex_joint"};
  EXPECT_THAT(written(), ElementsAre(CapturePose{joints, {-0.25, 0.5}, {}},
                                     CapturePose{joints, {-0.25, 1.5}, {}}));
}

TEST_F(CapturePoses, NeedsNoConfigurationAndEndsAsUpstreams) {
  write("ends.sh",
        "for i in 1 2 3 4 5 6; do read line; echo \"{\\\"stamp\\\": ${i}00000000, "
        "\\\"names\\\": [\\\"head_pan_joint\\\"], \\\"positions\\\": [0.5]}\"; done");
  const std::string call =
      kinecal_program() + " capture_poses --robot 'pipe:sh ends.sh' -o poses.yaml";
  write("robot.urdf",
        "<robot name='r'><link name='a'/><link name='b'/><joint name='head_pan_joint' "
        "type='continuous'><parent link='a'/><child link='b'/><axis xyz='0 0 1'/></joint></robot>");
  const Outcome done = run("printf '\\nEXIT\\n\\n' | " + call + " --urdf robot.urdf");
  EXPECT_EQ(done.code, 0) << done.err;
  EXPECT_THAT(written(), ElementsAre(CapturePose{{"head_pan_joint"}, {0.5}, {}}));
  const Outcome no_urdf = run(call + " --force < /dev/null");
  EXPECT_EQ(no_urdf.code, 1);
  EXPECT_THAT(no_urdf.err, HasSubstr("--urdf is required: pipe:sh ends.sh does not have the URDF"));
}

TEST_F(CapturePoses, NamesOfFeaturesHoldForTheNextPoses) {
  const Outcome done = poses("0.1,0.2,0.3,0.4", "leds\n\nleds ground\r\n\nall\n\nlesd\n\n");
  EXPECT_EQ(done.code, 0) << done.err;
  EXPECT_THAT(done.out, AllOf(HasSubstr("pose 1: leds\n"), HasSubstr("pose 2: leds, ground\n"),
                              HasSubstr("nothing is recorded: 'lesd' is not a feature of the "
                                        "configuration; did you mean 'leds'?")));
  const std::vector<CapturePose> all = written();
  ASSERT_EQ(all.size(), 4u);
  EXPECT_EQ(all[0].features, Names{"leds"});
  EXPECT_EQ(all[1].features, (Names{"leds", "ground"}));
  EXPECT_EQ(all[2].features, Names());
  EXPECT_EQ(all[3].features, Names());
}

TEST_F(CapturePoses, RemovesTheLastPose) {
  const Outcome done = poses("0.1,0.2,0.3", "\n\nu\n\nq\n");
  EXPECT_EQ(done.code, 0) << done.err;
  EXPECT_THAT(done.out, HasSubstr("pose 2 is removed"));
  ASSERT_EQ(written().size(), 2u);
  EXPECT_EQ(written()[1].positions[1], 0.3);
  const Outcome none = poses("0.1", "\nu\nu\nq\n", "-o none.bag");
  EXPECT_EQ(none.code, 1);
  EXPECT_THAT(none.out, HasSubstr("there is no pose to remove"));
  EXPECT_EQ(none.err, "error: no pose was recorded\n");
  EXPECT_FALSE(std::filesystem::exists(folder_ / "none.bag"));
}

TEST_F(CapturePoses, RefusesWhatMovesIsTheSameOrNotANumber) {
  const Outcome done = poses("0.1,0.102,moves,0.3", "\n\n\n\nq\n");
  EXPECT_EQ(done.code, 0) << done.err;
  EXPECT_THAT(done.out, AllOf(HasSubstr("the robot has not moved since the last pose"),
                              HasSubstr("joints do not stop; waited 3"), HasSubstr("pose 2: all")));
  EXPECT_EQ(written().size(), 2u);
  EXPECT_THAT(poses("nan", "\n", "-o nan.yaml").out, Not(HasSubstr("pose 1")));
}

TEST_F(CapturePoses, ResumesAndWritesBags) {
  ASSERT_EQ(poses("0.1,0.2", "\nground\n\nq\n", "-o poses.bag").code, 0);
  EXPECT_EQ(poses("0.3", "\nq\n", "-o poses.bag").code, 1) << "the file is there";
  const Outcome more = poses("0.3", "\nq\n", "-o poses.bag --resume");
  EXPECT_EQ(more.code, 0) << more.err;
  EXPECT_THAT(more.out, AllOf(HasSubstr("2 poses from before"), HasSubstr("poses.bag: 3 poses")));
  Diagnostics diagnostics;
  const auto all = read_bag_poses((folder_ / "poses.bag").string(), diagnostics);
  ASSERT_EQ(all.size(), 3u);
  EXPECT_EQ(all[1].features, Names{"ground"});
  EXPECT_EQ(all[2].positions, (std::vector<double>{-0.25, 0.3}));
}

TEST_F(CapturePoses, KeepsWhatIsRecordedIfTheRobotIsLost) {
  write("ends.sh",
        "for i in 1 2 3 4; do read line; echo \"{\\\"stamp\\\": ${i}00000000, "
        "\\\"names\\\": [\\\"elbow_flex_joint\\\", \\\"head_pan_joint\\\"], "
        "\\\"positions\\\": [0.5, 0.5]}\"; done");
  write("capture.yaml", kPosesConfig);
  const Outcome lost =
      run("printf '\\n\\n' | " + kinecal_program() +
          " capture_poses capture.yaml --robot 'pipe:sh ends.sh' -o poses.yaml --urdf " +
          source_folder() + "/examples/mobile_manipulator/mobile_manipulator.urdf");
  EXPECT_EQ(lost.code, 1);
  EXPECT_THAT(lost.err, AllOf(HasSubstr("ended with exit code 0"), HasSubstr("--resume goes on")));
  EXPECT_EQ(written().size(), 1u);
}

TEST_F(CapturePoses, PosesOfAnotherRobotAreNamed) {
  write("poses.yaml",
        "- {joints: [head_pan_joint, elbow_flex_jont], positions: [0.1, 0.2]}\n"
        "- {joints: [head_pan_joint, elbow_flex_jont], positions: [0.1, 0.3]}\n");
  const std::string before = read("poses.yaml");
  const Outcome other = poses("0.5", "\nq\n", "-o poses.yaml --resume");
  EXPECT_EQ(other.code, 1);
  EXPECT_THAT(other.err, HasSubstr("poses.yaml:1: the robot has no joint 'elbow_flex_jont'; did "
                                   "you mean 'elbow_flex_joint'? (and 1 other pose)"));
  EXPECT_EQ(read("poses.yaml"), before);
  write("poses.yaml", "- {joints: [head_pan_joint], positions: [0.1]}\n");
  EXPECT_THAT(poses("0.5", "\nq\n", "-o poses.yaml --resume").err,
              HasSubstr("poses.yaml:1: has no joint 'elbow_flex_joint' of chain 'arm'"));
}

TEST_F(CapturePoses, JointsThatTheUrdfLacksAreNamed) {
  const std::string urdf =
      " --urdf " + source_folder() + "/examples/mobile_manipulator/mobile_manipulator.urdf ";
  write("robot.py", kRobot);
  write("free.yaml", "features:\n  ground: {type: robot_calibration/PlaneFinder, topic: /p}\n");
  write("wrong.yaml",
        "chains:\n- {name: arm, topic: /a, joints: [elbow_flx_joint, wheel]}\n"
        "features:\n  ground: {type: robot_calibration/PlaneFinder, topic: /p}\n");
  const auto session = [&](const std::string& config) {
    return run("printf '\\nq\\n' | " + kinecal_program() + " capture_poses " + config + urdf +
               "-o p.yaml --robot 'pipe:python3 robot.py 0.5'");
  };
  const Outcome measured = session("free.yaml");
  EXPECT_EQ(measured.code, 1);
  EXPECT_THAT(measured.out, HasSubstr("nothing is recorded: the URDF has no joint 'wheel', which "
                                      "the robot measures"));
  const Outcome named = session("wrong.yaml");
  EXPECT_EQ(named.code, 1);
  EXPECT_THAT(named.err, AllOf(HasSubstr("wrong.yaml: chain 'arm': the robot has no joint "
                                         "'elbow_flx_joint'; did you mean 'elbow_flex_joint'?"),
                               HasSubstr("the robot has no joint 'wheel'")));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "p.yaml"));
}

}  // namespace
}  // namespace kinecal::test
