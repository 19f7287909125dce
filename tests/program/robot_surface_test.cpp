// The robot as its own target, from files to files: clouds and masks.  With the program as installed, sums cross the border
// to the library of an instruction set here.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <random>

#include "kinecal/config/assemble.hpp"
#include "kinecal/config/read_config.hpp"
#include "kinecal/files/cameras/camera_info.hpp"
#include "kinecal/files/poses/poses.hpp"
#include "kinecal/files/samples/write_samples.hpp"
#include "kinecal/geometry/median.hpp"
#include "kinecal/procedure/calibrate_robot.hpp"
#include "kinecal/procedure/surface_rounds.hpp"
#include "kinecal/trust/plain_equations.hpp"
#include "support/mask_robot.hpp"
#include "support/run_program.hpp"

namespace kinecal {
namespace {

using test::Outcome;
using testing::HasSubstr;

class RobotSurfaceProgram : public test::ProgramTest {
 protected:
  RobotSurfaceProgram() {
    test::write_meshes(folder_);
    std::ofstream(folder_ / "arm.urdf") << test::mesh_robot_urdf();
  }
  void write(const std::vector<Sample>& samples, const std::string& config) {
    std::ofstream file(folder_ / "samples.yaml");
    write_samples(file, samples);
    std::ofstream(folder_ / "calibrate.yaml") << config;
  }
  /// Calibrates samples.
  Outcome calibrate(const std::vector<Sample>& samples, const std::string& config) {
    write(samples, config);
    return kinecal(
        "calibrate --urdf arm.urdf --config calibrate.yaml --samples samples.yaml --output out");
  }

  Robot robot_ = parse_urdf(test::mesh_robot_urdf(), "arm.urdf");
};

TEST_F(RobotSurfaceProgram, CalibratesByClouds) {
  const Outcome result = calibrate(test::mesh_robot_samples(robot_, {.samples = 5, .noise = 0.001}),
                                   test::mesh_config(""));
  ASSERT_EQ(result.code, 0) << result.err;
  EXPECT_THAT(result.err, HasSubstr("'camera_joint' was searched"));
  EXPECT_TRUE(std::filesystem::exists(folder_ / "out/calibrated.urdf"));
}

/// The camera was knocked: so far to its right.
void knock(std::vector<Sample>& samples, double metres) {
  for (Sample& sample : samples) {
    for (Feature& point : sample.observations.at(0).features) point.point.x() -= metres;
  }
}

TEST_F(RobotSurfaceProgram, VerifiesByNewClouds) {
  const Outcome result = calibrate(test::mesh_robot_samples(robot_, {.samples = 6, .noise = 0.001}),
                                   test::mesh_config(""));
  ASSERT_EQ(result.code, 0) << result.err;
  std::vector<Sample> later =
      test::mesh_robot_samples(robot_, {.samples = 6, .noise = 0.001, .seed = 7});
  const auto verify = [&] {
    std::ofstream file(folder_ / "later.yaml");
    write_samples(file, later);
    file.close();
    return kinecal("verify out later.yaml --report verify.json");
  };
  const Outcome same = verify();
  EXPECT_EQ(same.code, 0) << same.out << same.err;
  EXPECT_THAT(same.out, HasSubstr("verdict: holds"));
  knock(later, 0.008);
  const Outcome knocked = verify();
  EXPECT_EQ(knocked.code, 2) << knocked.out << knocked.err;
  EXPECT_THAT(knocked.out, HasSubstr("verdict: does not hold"));
  EXPECT_THAT(knocked.out, testing::ContainsRegex("'camera_joint' by [78]\\.[0-9]+ mm \\+- 0\\."));
  EXPECT_THAT(knocked.out, HasSubstr("see whether 'camera_joint' is loose"));
}

TEST_F(RobotSurfaceProgram, EvaluatesNewCloudsWithoutSolving) {
  const Outcome result = calibrate(
      test::mesh_robot_samples(robot_, {.samples = 6, .noise = 0.001, .background = true}),
      test::mesh_config("", ", loss: {type: cauchy, scale: 0.005}"));
  ASSERT_EQ(result.code, 0) << result.err;
  std::vector<Sample> later = test::mesh_robot_samples(
      robot_, {.samples = 2, .noise = 0.001, .background = true, .seed = 7});
  const auto evaluate = [&] {
    std::ofstream file(folder_ / "later.yaml");
    write_samples(file, later);
    file.close();
    return kinecal("evaluate out later.yaml --fail-above 2 --report evaluate.json");
  };
  const Outcome same = evaluate();
  EXPECT_EQ(same.code, 0) << same.out << same.err;
  EXPECT_THAT(same.out, HasSubstr("nothing is solved"));
  EXPECT_THAT(same.out, HasSubstr("as good: surface "));
  EXPECT_THAT(same.out, HasSubstr("later.yaml:")) << "the worst samples";
  knock(later, 0.008);
  const Outcome knocked = evaluate();
  EXPECT_EQ(knocked.code, 2) << knocked.out << knocked.err;
  EXPECT_THAT(knocked.out, HasSubstr("worse: surface "));
  knock(later, 0.1);
  const Outcome off = evaluate();
  EXPECT_EQ(off.code, 2) << off.out << off.err;
  EXPECT_THAT(off.out, HasSubstr("worse: "));
  EXPECT_THAT(off.out, HasSubstr("where the result puts it"));
  const YAML::Node report = YAML::LoadFile((folder_ / "evaluate.json").string());
  EXPECT_EQ(report["off_robot"].size(), 1U);
  knock(later, 0.5);
  const Outcome lost = evaluate();
  EXPECT_EQ(lost.code, 1) << lost.out << lost.err;
  EXPECT_THAT(lost.err, HasSubstr("where the result puts it"));
}

/// What calibrates says of its own samples, evaluate says of them as well.
TEST_F(RobotSurfaceProgram, EvaluatesItsOwnSamplesAsItFittedThem) {
  for (const bool masks : {false, true}) {
    const Outcome result =
        masks ? calibrate(test::mask_robot_samples(robot_, {.samples = 6, .pixels = 2}),
                          test::mask_config(test::kStart))
              : calibrate(test::mesh_robot_samples(robot_, {.samples = 6, .noise = 0.001}),
                          test::mesh_config(test::kStart));
    ASSERT_EQ(result.code, 0) << result.err;
    const Outcome own = kinecal("evaluate out samples.yaml --report evaluate.json");
    ASSERT_EQ(own.code, 0) << own.out << own.err;
    EXPECT_THAT(own.out, HasSubstr("as good: "));
    const YAML::Node block =
        YAML::LoadFile((folder_ / "evaluate.json").string())["error_blocks"][0];
    const double then = block["calibration"].as<double>(), now = block["distance"].as<double>();
    EXPECT_NEAR(now, then, 0.02 * then) << "nearest points are those of the last round";
    std::filesystem::remove_all(folder_ / "out");
  }
}

/// Chooses among samples.
class SelectedSurfaces : public RobotSurfaceProgram {
 protected:
  /// Uncertainty of the camera's place from some samples if their points err independently: one standard deviation, of the
  /// noise of a point.  By what lies on the true arm.
  double uncertainty(const std::vector<Sample>& samples, const std::string& config) {
    Diagnostics found;
    CalibrationSetup setup{.robot = robot_,
                           .config = parse_config(config, "calibrate.yaml", found),
                           .samples = samples,
                           .urdf_text = test::mesh_robot_urdf(),
                           .urdf = (folder_ / "arm.urdf").string()};
    const Pose<double> camera = test::true_camera();
    const Vector3<double> turn = log(camera.rotation);
    std::map<std::string, double> truth;
    for (std::size_t k = 0; k < 3; ++k) {
      const auto i = static_cast<Eigen::Index>(k);
      truth[parameter_name("camera_joint", kFrameAxes[k])] = camera.translation[i];
      truth[parameter_name("camera_joint", kFrameAxes[k + 3])] = turn[i];
    }
    const SurfaceInput input{setup.robot, setup.urdf_text, setup.urdf, {}};
    const auto blocks = read_surface_blocks(input, *setup.config, found);
    match_surface_at(input, blocks, truth, *setup.config, setup.samples, found);
    const Calibration calibration = assemble(*setup.config, robot_, setup.samples, found);
    EXPECT_THAT(found.errors, testing::IsEmpty());
    if (calibration.steps.empty()) return 0.0;
    std::vector<double> values;
    for (const Parameter& parameter : calibration.table) values.push_back(truth[parameter.name]);
    const CalibrationStep& step = calibration.steps.back();
    const Eigen::MatrixXd covariance =
        plain_equations(*step.problem, step.free, values).hessian.matrix().inverse();
    double variance = 0.0;
    const std::vector<int>& free = step.free.parameters();
    for (const char* axis : {"camera_joint_x", "camera_joint_y", "camera_joint_z"}) {
      const auto column = std::ranges::find(free, calibration.table.find(axis)) - free.begin();
      variance += covariance(column, column);
    }
    return std::sqrt(variance);
  }
  /// The samples of the poses in a file.
  std::vector<Sample> chosen(const std::vector<Sample>& samples, const std::string& file) {
    std::vector<Sample> some;
    for (const CapturePose& pose : read_poses_yaml((folder_ / file).string(), found_)) {
      for (const Sample& sample : samples) {
        const std::map<std::string, double> q = test::positions_of(sample);
        bool is_it = true;
        for (std::size_t j = 0; j < pose.joint_names.size(); ++j) {
          const auto at = q.find(pose.joint_names[j]);
          is_it = is_it && (at == q.end() || std::abs(at->second - pose.positions[j]) < 1e-6);
        }
        if (is_it) some.push_back(sample);
      }
    }
    return some;
  }
  /// Expects the chosen ones to be better than the first ones, and than random ones.
  void expect_better(const std::vector<Sample>& samples, const std::vector<Sample>& few,
                     const std::string& config) {
    const auto count = static_cast<std::ptrdiff_t>(few.size());
    const double of_chosen = uncertainty(few, config);
    EXPECT_LT(of_chosen, uncertainty({samples.begin(), samples.begin() + count}, config));
    std::vector<double> random;
    std::mt19937 engine(3);
    for (int set = 0; set < 9; ++set) {
      std::vector<Sample> some = samples;
      std::shuffle(some.begin(), some.end(), engine);
      some.resize(static_cast<std::size_t>(count));
      random.push_back(uncertainty(some, config));
    }
    EXPECT_LT(of_chosen, 0.95 * median_of(random));
  }

  Diagnostics found_;
};

TEST_F(SelectedSurfaces, OfCloudsGiveTheCameraBetterThanOthers) {
  const std::vector<Sample> samples =
      test::mesh_robot_samples(robot_, {.samples = 16, .noise = 0.001, .background = true});
  const std::string config = test::mesh_config(test::kStart, "", "lift, elbow");
  write(samples, config);
  const Outcome selected = kinecal(
      "select-poses --urdf arm.urdf --config calibrate.yaml --samples samples.yaml --count 4 "
      "-o few.yaml");
  ASSERT_EQ(selected.code, 0) << selected.out << selected.err;
  EXPECT_THAT(selected.out, HasSubstr("4 of 16 poses selected: 'base' in 'camera' will be known"));
  const std::vector<Sample> few = chosen(samples, "few.yaml");
  ASSERT_EQ(few.size(), 4U);
  expect_better(samples, few, config);
}

TEST_F(SelectedSurfaces, OfMasksGiveTheCameraBetterThanOthers) {
  const std::vector<Sample> samples =
      test::mask_robot_samples(robot_, {.samples = 12, .pixels = 2});
  const std::string config = test::mask_config(test::kStart, "lift, elbow");
  write(samples, config);
  const Outcome selected = kinecal(
      "select-poses --urdf arm.urdf --config calibrate.yaml --samples samples.yaml --count 4 "
      "-o few.yaml");
  ASSERT_EQ(selected.code, 0) << selected.out << selected.err;
  const std::vector<Sample> few = chosen(samples, "few.yaml");
  ASSERT_EQ(few.size(), 4U);
  expect_better(samples, few, config);
}

/// Poses are chosen before anybody captures them; then clouds of them are.
TEST_F(SelectedSurfaces, OfPlannedPosesGiveTheCameraBetterThanOthers) {
  const std::vector<Sample> samples = test::mesh_robot_samples(robot_, {.samples = 16});
  std::vector<CapturePose> poses;
  for (const Sample& sample : samples) {
    poses.push_back({sample.joint_names, sample.joint_positions, {}});
  }
  std::ofstream list(folder_ / "poses.yaml");
  write_poses_yaml(list, poses);
  list.close();
  const std::string config = test::mesh_config("", "", "lift, elbow");
  std::ofstream(folder_ / "calibrate.yaml") << config;
  std::ofstream(folder_ / "watched.urdf") << test::watched_arm();
  const std::string input =
      " --urdf watched.urdf --config calibrate.yaml --pose-file poses.yaml -o few.yaml";
  const Outcome selected = kinecal("select-poses --count 4" + input);
  ASSERT_EQ(selected.code, 0) << selected.out << selected.err;
  const std::vector<Sample> few = chosen(samples, "few.yaml");
  ASSERT_EQ(few.size(), 4U);
  expect_better(samples, few, test::mesh_config(test::kStart, "", "lift, elbow"));
  const Outcome planned = kinecal("plan --accuracy 'base 1 mm' --force" + input);
  ASSERT_EQ(planned.code, 0) << planned.out << planned.err;
  EXPECT_THAT(planned.out, HasSubstr("'base' in 'camera', one standard deviation"));
  EXPECT_THAT(planned.out, HasSubstr("err together"));
}

TEST_F(SelectedSurfaces, AreRefusedWhereNothingIsPredicted) {
  std::ofstream(folder_ / "calibrate.yaml") << test::mesh_config("", "", "lift, elbow");
  std::ofstream(folder_ / "watched.urdf") << test::watched_arm();
  const std::string input = " --urdf watched.urdf --config calibrate.yaml";
  const Outcome study = kinecal("study --poses 3" + input);
  EXPECT_EQ(study.code, 1);
  EXPECT_THAT(study.err, HasSubstr("kinecal simulate --target robot"));
  const Outcome between = kinecal("plan --tell-apart lift,elbow" + input);
  EXPECT_EQ(between.code, 1);
  EXPECT_THAT(between.err, HasSubstr("--tell-apart: "));
  const Outcome board = kinecal("plan --target checkerboard" + input);
  EXPECT_EQ(board.code, 1);
  EXPECT_THAT(board.err, HasSubstr("its target is robot"));
}

TEST_F(RobotSurfaceProgram, CalibratesByMasks) {
  const Outcome result = calibrate(test::mask_robot_samples(robot_, {.samples = 6, .pixels = 2}),
                                   test::mask_config(""));
  ASSERT_EQ(result.code, 0) << result.err;
  EXPECT_THAT(result.err, HasSubstr("'camera_joint' was searched"));
  EXPECT_TRUE(std::filesystem::exists(folder_ / "out/calibrated.urdf"));
}

/// Simulates robots, and calibrates with the commands that the simulation prints.
class SimulatedRobotSurface : public test::ProgramTest {
 protected:
  /// @param scene  lines of it
  void simulate(const std::string& urdf, const std::string& scene) {
    std::ofstream(folder_ / "camera_info.yaml")
        << to_camera_info_yaml(test::mask_camera(), "camera");
    std::ofstream(folder_ / "scene.yaml")
        << "target: {type: robot}\nerrors: {joint: 0.05, position: 0.02, rotation: 0.05}\n"
        << scene;
    const Outcome made = kinecal("simulate " + urdf + " --scene scene.yaml -o sim");
    ASSERT_EQ(made.code, 0) << made.err;
    const std::size_t next = made.out.find("next: ");
    ASSERT_NE(next, std::string::npos) << made.out;
    const std::string command = made.out.substr(next + 6);
    const std::string path = std::filesystem::path(test::kinecal_program()).parent_path().string();
    calibrated_ =
        run("(export PATH=" + path + ":$PATH; " + command.substr(0, command.find('\n')) + ")");
  }
  /// The result, within its uncertainty of the truth.
  void expect_truth() {
    ASSERT_EQ(calibrated_.code, 0) << calibrated_.out << calibrated_.err;
    const YAML::Node truth = YAML::LoadFile((folder_ / "sim/truth.yaml").string());
    const YAML::Node report = YAML::LoadFile((folder_ / "calibrated/report.json").string());
    EXPECT_EQ(report["verdict"].as<std::string>(), "good") << calibrated_.out << calibrated_.err;
    EXPECT_EQ(report["left_out"].size(), 0U);
    int compared = 0;
    double worst_error = 0.0;
    for (const YAML::Node& parameter : report["parameters"]) {
      const std::string name = parameter["name"].as<std::string>();
      const double sigma = parameter["sigma"].as<double>();
      const double error = std::abs(parameter["value"].as<double>() - truth[name].as<double>());
      constexpr double kSigmas = 4.0, kRounding = 2e-4;  // of a few poses; of backlash, rad and m
      EXPECT_LT(error, kSigmas * sigma + kRounding) << name;
      worst_error = std::max(worst_error, error);
      ++compared;
    }
    EXPECT_GE(compared, 8);
    constexpr double kAtLeastDrawn = 0.01;  // half of the smallest kind of error
    EXPECT_LT(worst_error, 0.5 * kAtLeastDrawn) << "errors are found, not only their uncertainty";
  }

  Outcome calibrated_;
};

TEST_F(SimulatedRobotSurface, CloudsGiveItsErrors) {
  test::write_meshes(folder_);
  std::ofstream(folder_ / "arm.urdf") << test::watched_arm();
  simulate("arm.urdf", "camera: {info: camera_info.yaml}\nposes: 8\n");
  expect_truth();
}

TEST_F(SimulatedRobotSurface, MasksGiveItsErrors) {
  std::filesystem::create_directories(folder_ / "robots/arm/meshes");
  test::write_meshes(folder_ / "robots/arm/meshes");
  std::string urdf = test::watched_arm();
  for (std::size_t at = 0; (at = urdf.find("filename=\"", at)) != std::string::npos; at += 10) {
    urdf.insert(at + 10, "package://arm/meshes/");
  }
  std::ofstream(folder_ / "arm.urdf") << urdf;
  const Outcome lost = kinecal("simulate arm.urdf --target robot -o sim");
  EXPECT_EQ(lost.code, 1);
  EXPECT_THAT(lost.err, HasSubstr("package 'arm', which was not found"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "sim"));
  simulate("arm.urdf --mesh-path robots",
           "camera: {info: camera_info.yaml, type: camera2d}\nposes: 12\n");
  expect_truth();
}

TEST_F(SimulatedRobotSurface, ACameraWithoutAPoseIsRefused) {
  test::write_meshes(folder_);
  std::ofstream(folder_ / "arm.urdf") << test::mesh_robot_urdf();
  const Outcome lost = kinecal("simulate arm.urdf --target robot -o sim");
  EXPECT_EQ(lost.code, 1);
  EXPECT_THAT(lost.err, HasSubstr("the URDF has the camera 'camera' in the origin of 'base'"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "sim"));
}

TEST_F(SimulatedRobotSurface, ARobotWithoutSurfaceIsRefused) {
  const Outcome bare = kinecal("simulate " + test::source_folder() +
                               "/examples/robots/ubr1/ubr1.urdf --target robot -o sim");
  EXPECT_EQ(bare.code, 1);
  EXPECT_THAT(bare.err, HasSubstr("error: --target: no link has a mesh or shape in a <visual>"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "sim"));
}

TEST_F(SimulatedRobotSurface, SessionsHaveOtherTargets) {
  const std::string fetch = test::source_folder() + "/examples/robots/fetch/fetch.urdf";
  ASSERT_EQ(kinecal("simulate " + fetch + " --target leds --poses 3 -o sim").code, 0);
  std::ofstream(folder_ / "robot.yaml") << "target: {type: robot}\n";
  const Outcome session = kinecal("capture sim/capture.yaml --urdf " + fetch +
                                  " --poses sim/poses.yaml --robot simulated:robot.yaml -o s.yaml");
  EXPECT_EQ(session.code, 1);
  EXPECT_THAT(session.err, HasSubstr("target 'robot' is simulated by 'kinecal simulate'"));
}

}  // namespace
}  // namespace kinecal
