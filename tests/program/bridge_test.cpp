// kinecal capture and a Foxglove bridge: killed in mid-session, and with a simulated Fetch behind it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <future>
#include <random>
#include <string>
#include <vector>

#include "kinecal/config/assemble.hpp"
#include "kinecal/config/read_config.hpp"
#include "kinecal/files/recordings/read_recording.hpp"
#include "kinecal/files/samples/read_samples.hpp"
#include "support/data.hpp"
#include "support/paths.hpp"
#include "support/run_program.hpp"
#include "support/served_robot.hpp"
#include "support/simulated_fetch.hpp"

namespace kinecal::test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

/// The robot of server.mjs.
constexpr const char* kSmallUrdf = R"(<robot name="small">
  <link name="base"/><link name="upper"/><link name="lower"/><link name="camera_optical_frame"/>
  <joint name="shoulder" type="revolute"><parent link="base"/><child link="upper"/>
    <axis xyz="0 0 1"/><limit lower="-3" upper="3" effort="1" velocity="1"/></joint>
  <joint name="elbow" type="revolute"><parent link="upper"/><child link="lower"/>
    <axis xyz="0 1 0"/><limit lower="-3" upper="3" effort="1" velocity="1"/></joint>
  <joint name="head" type="revolute"><parent link="base"/><child link="camera_optical_frame"/>
    <axis xyz="0 1 0"/><limit lower="-3" upper="3" effort="1" velocity="1"/></joint>
</robot>)";
constexpr const char* kSmallConfig = R"(chains:
- {name: arm, topic: /arm_controller/follow_joint_trajectory, joints: [shoulder, elbow]}
- {name: head, topic: /head_controller/follow_joint_trajectory, joints: [head]}
duration: 0.1
features:
  wall: {type: robot_calibration/PlaneFinder, topic: /camera/points, max_z: 3.0}
)";

class KilledBridge : public ProgramTest {
 protected:
  static constexpr int kPoses = 18;

  void SetUp() override {
    KINECAL_NEEDS_BRIDGE_SERVER();
    write("robot.urdf", kSmallUrdf);
    write("capture.yaml", kSmallConfig);
    std::string poses;
    for (int i = 0; i < kPoses; ++i) {
      poses += "- {joints: [shoulder, elbow, head], positions: [" + std::to_string(0.05 * i) +
               ", " + std::to_string(0.4 - 0.05 * i) + ", 0.1], features: []}\n";
    }
    write("poses.yaml", poses);
  }

  /// A session in a folder of its own, with a robot whose clock runs three times as fast.
  [[nodiscard]] Outcome capture(const std::string& folder, const std::string& options,
                                const std::string& fault = "") const {
    std::filesystem::create_directories(folder_ / folder);
    const BridgeServer server(R"({"encoding": "cdr", "rate": 3)" + fault + "}");
    return run_in(folder_ / folder, kinecal_program() +
                                        " capture ../capture.yaml --urdf ../robot.urdf "
                                        "--poses ../poses.yaml -o samples.yaml --robot " +
                                        server.url() + options);
  }
  [[nodiscard]] std::vector<Sample> samples(const std::string& folder) const {
    const std::string file = (folder_ / folder / "samples.yaml").string();
    if (!std::filesystem::exists(file)) return {};
    Diagnostics diagnostics;
    std::vector<Sample> all = read_samples(file, diagnostics);
    EXPECT_TRUE(diagnostics.errors.empty());
    return all;
  }
};

/// Poses of which a session says that something was found.
std::size_t found_in(const std::string& out) {
  std::size_t count = 0;
  for (std::size_t at = 0; (at = out.find(": wall: 60 features", at)) != std::string::npos; ++at) {
    ++count;
  }
  return count;
}

TEST_F(KilledBridge, AtTenRandomMomentsLosesNoSampleAndResumesToTheSameResult) {
  auto whole = std::async(std::launch::async, [&] { return capture("whole", ""); });
  std::mt19937 random(4);
  std::uniform_int_distribution<int> goals(1, 4);           // two for each pose
  std::uniform_real_distribution<double> moment(0.0, 0.4);  // seconds; a pose takes as long
  std::size_t taken = 0;
  for (int i = 0; i < 10; ++i) {
    const std::string when = R"(, "goals": )" + std::to_string(goals(random)) +
                             R"(, "die_after": )" + std::to_string(moment(random));
    const Outcome killed = capture("killed", " --resume", when);
    EXPECT_EQ(killed.code, 1) << killed.out;
    EXPECT_THAT(killed.err, HasSubstr("bridge 'ws://127.0.0.1:"));
    taken += found_in(killed.out);
    EXPECT_EQ(samples("killed").size(), taken);
  }
  EXPECT_GT(taken, 0u);

  const Outcome rest = capture("killed", " --resume");
  EXPECT_EQ(rest.code, 0) << rest.err;
  const Outcome undisturbed = whole.get();
  EXPECT_EQ(undisturbed.code, 0) << undisturbed.out << undisturbed.err;
  const std::vector<Sample> all = samples("killed"), expected = samples("whole");
  ASSERT_EQ(expected.size(), kPoses) << undisturbed.out;
  ASSERT_EQ(all.size(), kPoses) << rest.out;
  for (std::size_t s = 0; s < all.size(); ++s) {
    EXPECT_EQ(all[s].joint_names, expected[s].joint_names);
    const auto near =
        ::testing::Pointwise(::testing::DoubleNear(1e-12), expected[s].joint_positions);
    EXPECT_THAT(all[s].joint_positions, near) << s;
    ASSERT_EQ(all[s].observations.size(), expected[s].observations.size());
    const auto &points = all[s].observations[0].features,
               &same = expected[s].observations[0].features;
    ASSERT_EQ(points.size(), same.size());
    for (std::size_t f = 0; f < same.size(); ++f) EXPECT_EQ(points[f].point, same[f].point) << s;
  }
}

/// A Fetch with errors of the paper's size, a small camera, few messages, and LEDs of the codes of
/// capture.yaml.
SimulatedSetup small_fetch() {
  SimulatedSetup setup = simulated_fetch(3);
  constexpr int kSmaller = 5;
  CameraInfo& info = setup.camera.info;
  info.width /= kSmaller;
  info.height /= kSmaller;
  for (double& k : info.k) k = k == 1.0 ? 1.0 : k / kSmaller;
  for (double& p : info.p) p = p == 1.0 ? 1.0 : p / kSmaller;
  setup.timing.joint_rate = 20.0;
  setup.timing.image_rate = 5.0;
  for (Patch& patch : setup.scene.patches) {
    if (patch.led == 0) continue;
    patch.led = 1 << (patch.led - 1);
    patch.width *= kSmaller;  // so that it has as many pixels as in the image of a real camera
    patch.height *= kSmaller;
  }
  return setup;
}

class FetchBehindBridge : public ProgramTest, public ::testing::WithParamInterface<std::string> {
 protected:
  /// The shipped configuration, for LEDs in the frame in which capture.yaml has them.
  [[nodiscard]] Config led_config() const {
    std::ifstream shipped(source_folder() + "/examples/robots/fetch/calibrate.yaml");
    std::string text{std::istreambuf_iterator<char>(shipped), {}};
    const std::string frame = kFetchLedLink;
    text.replace(text.find(frame), frame.size(), "wrist_roll_link");
    write("calibrate.yaml", text);
    Diagnostics diagnostics;
    Config config = read_config((folder_ / "calibrate.yaml").string(), diagnostics);
    diagnostics.throw_if_errors();
    return config;
  }
};

INSTANTIATE_TEST_SUITE_P(Encodings, FetchBehindBridge, ::testing::Values("ros1", "cdr"),
                         [](const auto& one) { return one.param; });

TEST_P(FetchBehindBridge, IsCapturedWithItsOwnFilesAndCalibratesToTheTruth) {
  KINECAL_NEEDS_DATA("fetch");
  KINECAL_NEEDS_BRIDGE_SERVER();
  const std::string data = (data_folder() / "fetch").string();
  const SimulatedSetup setup = small_fetch();
  std::vector<CapturePose> all = poses_for(setup.robot, data + "/calibration_poses.bag"), poses;
  for (std::size_t i = 0; i < all.size(); i += 11) poses.push_back(all[i]);
  std::ofstream file(folder_ / "poses.yaml");
  write_poses_yaml(file, poses);
  file.close();
  SimulatedRobot robot(setup);
  Outcome session;
  {
    const ServedRobot served(robot, R"({"encoding": ")" + GetParam() +
                                        R"(", "camera": "/head_camera/depth_registered"})");
    session = run(kinecal_program() + " capture " + data +
                  "/capture.yaml --poses poses.yaml -o samples.bag --urdf " + source_folder() +
                  "/examples/robots/fetch/fetch.urdf --robot " + served.url());
  }
  ASSERT_EQ(session.code, 0) << session.out << session.err;

  Diagnostics diagnostics;
  const std::vector<Sample> samples =
      read_recording((folder_ / "samples.bag").string(), diagnostics).samples;
  EXPECT_GE(samples.size(), poses.size() - 2) << session.out;
  Calibration calibration = assemble(led_config(), setup.robot, samples, diagnostics);
  ASSERT_TRUE(diagnostics.errors.empty()) << diagnostics.errors.front();
  const CalibrationResult result = calibrate(calibration);
  EXPECT_TRUE(result.converged);
  const TrueRobot truth(setup.robot, setup.truth, setup.frames),
      urdf(setup.robot, {}, setup.frames), calibrated(setup.robot, result.table, setup.frames);
  EXPECT_GT(led_difference(urdf, truth, samples), 0.03);
  EXPECT_LT(led_difference(calibrated, truth, samples), 0.005);
}

class BaseBehindBridge : public ProgramTest {};

/// Without --seconds and --drive, Ctrl-C is how a person ends a recording.
TEST_F(BaseBehindBridge, CtrlCIsTheNormalEndOfARecording) {
  KINECAL_NEEDS_BRIDGE_SERVER();
  write("robot.urdf", kSmallUrdf);
  write("base.yaml",
        "base_link: base\nmodels: []\nfree_params: [base_track_width_scale]\n"
        "error_blocks: [{name: base, type: odometry_to_wall}]\n");
  BridgeServer server(R"({"encoding": "ros1", "base": {}})");
  const auto interrupted = [&](const std::string& options) {
    return run("bash -c 'set -m; " + kinecal_program() +
               " capture base.yaml --urdf robot.urdf -o drive.bag --force --robot " + server.url() +
               options + " < /dev/null > said & sleep 5; kill -INT $!; wait $!'");
  };
  const Outcome ended = interrupted("");
  EXPECT_EQ(ended.code, 1) << "this base does not move";
  EXPECT_THAT(ended.err, Not(HasSubstr("interrupted")));
  EXPECT_THAT(read("said"), AllOf(HasSubstr("Ctrl-C ends it"), HasSubstr("of /odom")));
  const Outcome early = interrupted(" --seconds 600");
  EXPECT_EQ(early.code, 130);
  EXPECT_THAT(early.err, HasSubstr("error: interrupted"));
}

}  // namespace
}  // namespace kinecal::test
