// Scanners by a configuration: a line scanner on a flange and a ball, a laser and a board that a camera sees.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <random>
#include <string>
#include <vector>

#include "kinecal/config/read_config.hpp"
#include "kinecal/files/urdf/read_urdf.hpp"
#include "kinecal/geometry/rotation.hpp"
#include "kinecal/procedure/calibrate_robot.hpp"
#include "support/interval_coverage.hpp"
#include "support/repetitions.hpp"

namespace kinecal {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

const char* const kFlange = R"(<robot name="flange">
<link name="base"/><link name="flange"/><link name="scanner"/>
<joint name="flange_joint" type="floating"><parent link="base"/><child link="flange"/></joint>
<joint name="scanner_joint" type="fixed"><parent link="flange"/><child link="scanner"/></joint>
</robot>
)";

const Pose<double> kFlangeToScanner{
    exp(Vector3<double>(0.0, 0.0, 2.1)) * exp(Vector3<double>(0.15, -0.1, 0.0)),
    Vector3<double>(0.042, -0.031, 0.118)};
const Vector3<double> kCenter(0.55, 0.12, 0.21);
constexpr double kBallRadius = 0.025;  // metres

/// How profiles of the ball are made.
struct Profiles {
  int samples = 20;
  double noise = 0.0;  ///< of a point along the scanner's z axis, metres
  double pose_noise =
      0.0;  ///< of a coordinate of the flange, metres; of an angle, twice as many radians
  bool table = false;  ///< each profile also shows what is behind the ball
  unsigned seed = 1;
};

/// Profiles in the scanner's plane y = 0: the near arc of the ball.
std::vector<Sample> profiles_of(const Profiles& plan) {
  std::mt19937 engine(plan.seed);
  std::uniform_real_distribution<double> within(-1.0, 1.0);
  std::normal_distribution<double> noise(0.0, 1.0);
  std::vector<Sample> samples;
  for (int s = 0; s < plan.samples; ++s) {
    const Matrix3<double> turned = exp(Vector3<double>(3.14159 + 0.7 * within(engine), 0.0, 0.0)) *
                                   exp(Vector3<double>(0.0, 0.7 * within(engine), 0.0)) *
                                   exp(Vector3<double>(0.0, 0.0, 2.5 * within(engine)));
    const Vector3<double> ball(0.01 * within(engine), 0.012 * within(engine),
                               0.195 + 0.045 * within(engine));
    const Pose<double> scanner{turned, kCenter - turned * ball};
    Pose<double> flange = scanner * kFlangeToScanner.inverse();
    const auto error = [&](double scale) {
      return Vector3<double>(scale * Vector3<double>(noise(engine), noise(engine), noise(engine)));
    };
    flange.translation += error(plan.pose_noise);
    flange.rotation = flange.rotation * exp(error(2.0 * plan.pose_noise));
    Sample& sample = samples.emplace_back();
    sample.source = "profile " + std::to_string(s + 1);
    sample.poses["flange_joint"] = flange;
    Observation seen{"scanner", {}, {}};
    const double radius = std::sqrt(kBallRadius * kBallRadius - ball.y() * ball.y());
    for (int i = 0; i < 45; ++i) {
      const double angle = -1.1 + 0.05 * i;
      const double x = ball.x() + radius * std::sin(angle);
      const double z = ball.z() - radius * std::cos(angle) + plan.noise * noise(engine);
      seen.features.push_back({"scanner", Vector3<double>(x, 0.0, z)});
      if (!plan.table) continue;
      seen.features.push_back(
          {"scanner", Vector3<double>(2.5 * x, 0.0, z + 0.08 + 0.02 * within(engine))});
    }
    sample.observations.push_back(std::move(seen));
  }
  return samples;
}

/// Nothing is known but the radius.
CalibrationSetup ball_setup(std::vector<Sample> samples, const std::string& more = "") {
  Diagnostics found;
  CalibrationSetup setup{
      .robot = parse_urdf(kFlange, "flange.urdf"),
      .config = parse_config(
          "base_link: base\nmodels:\n- {name: scanner, type: chain3d, frame: "
          "scanner}\nfree_frames:\n- "
          "{name: scanner_joint, x: true, y: true, z: true, roll: true, pitch: true, yaw: "
          "true}\nfree_params: [ball_x, ball_y, ball_z]\nerror_blocks:\n- {name: ball, type: "
          "point_to_sphere, model: scanner, radius: 0.025" +
              more + "}\n",
          "calibrate.yaml", found),
      .samples = std::move(samples),
      .urdf_text = kFlange,
      .urdf = "flange.urdf"};
  EXPECT_THAT(found.errors, IsEmpty());
  return setup;
}

double truth_of(const std::string& name) {
  if (name.starts_with("scanner_joint_")) return test::of_frame(name.back(), kFlangeToScanner);
  return kCenter[std::string("xyz").find(name.back()) == 0 ? 0 : name.back() == 'y' ? 1 : 2];
}

TEST(CalibrateLineScanner, FindsItsPlaceOnTheFlangeByABallFromNothing) {
  constexpr double kExact = 1e-6;  // metres and radians: where the solver stops without noise
  const PreparedCalibration prepared = prepare(ball_setup(profiles_of({})));
  ASSERT_THAT(prepared.diagnostics.errors, IsEmpty());
  const CalibrationResult result = calibrate(prepared.calibration);
  for (const int p : result.calibrated) {
    const Parameter& found = result.table[p];
    EXPECT_NEAR(found.value, truth_of(found.name), kExact) << found.name;
  }
}

/// Points of a profile share the error of its pose.  KINECAL_REPETITIONS=60 prints the figures of MANUAL.md.
TEST(CalibrateLineScanner, CoversTheTruthWherePosesOfTheFlangeErr) {
  test::IntervalCoverage coverage("line scanner and a ball");
  const int repetitions = std::max(2, test::repetitions_of_study(200, 3));
  for (int seed = 1; seed <= repetitions; ++seed) {
    const CalibratedRobot calibrated = calibrate_robot(ball_setup(
        profiles_of({.noise = 5e-5, .pose_noise = 1e-4, .seed = static_cast<unsigned>(seed)})));
    ASSERT_TRUE(calibrated.is_usable()) << calibrated.judgement.reasons.front();
    coverage.add(calibrated.result, calibrated.assessments.back(), truth_of);
  }
  coverage.check();
}

TEST(CalibrateLineScanner, LeavesOutWhatIsBehindTheBall) {
  constexpr double kLeft = 5e-4;  // metres and radians: ten times the noise of a point
  const CalibratedRobot calibrated = calibrate_robot(ball_setup(
      profiles_of({.noise = 5e-5, .table = true}), ", loss: {type: tukey, scale: 0.0003}"));
  ASSERT_TRUE(calibrated.is_usable()) << calibrated.judgement.reasons.front();
  EXPECT_THAT(calibrated.setup.diagnostics.notes, testing::Contains(HasSubstr("of 1800 points, ")));
  for (const int p : calibrated.result.calibrated) {
    const Parameter& found = calibrated.result.table[p];
    EXPECT_NEAR(found.value, truth_of(found.name), kLeft) << found.name;
  }
}

/// Steps inherit error blocks: the same block in two of them is one.
TEST(CalibrateLineScanner, LeavesOutTheBackgroundOnceInSeveralSteps) {
  const CalibratedRobot calibrated = calibrate_robot(
      ball_setup(profiles_of({.noise = 5e-5, .table = true}),
                 ", loss: {type: tukey, scale: 0.0003}}\ncal_steps: {first: {}, second: {}"));
  ASSERT_TRUE(calibrated.is_usable()) << calibrated.judgement.reasons.front();
  EXPECT_EQ(std::count_if(calibrated.setup.diagnostics.notes.begin(),
                          calibrated.setup.diagnostics.notes.end(),
                          [](const std::string& note) {
                            return note.find("of 1800 points, ") != std::string::npos;
                          }),
            1);
  for (const int p : calibrated.result.calibrated) {
    const Parameter& found = calibrated.result.table[p];
    EXPECT_NEAR(found.value, truth_of(found.name), 5e-4) << found.name;
  }
}

TEST(CalibrateLineScanner, RefusesProfilesOfSomethingElse) {
  std::vector<Sample> samples = profiles_of({.noise = 5e-5});
  std::mt19937 engine(3);
  std::uniform_real_distribution<double> within(-1.0, 1.0);
  for (Sample& sample : samples) {
    for (Feature& feature : sample.observations[0].features) {
      feature.point.z() = 0.2 + 0.1 * within(engine);
    }
  }
  const Diagnostics found =
      prepare(ball_setup(std::move(samples), ", loss: {type: tukey, scale: 0.0003}")).diagnostics;
  ASSERT_FALSE(found.errors.empty());
  EXPECT_THAT(found.errors.front(), HasSubstr("hardly more than by chance"));
}

const char* const kRig = R"(<robot name="rig">
<link name="camera"/><link name="lidar"/><link name="board"/>
<joint name="lidar_joint" type="fixed"><parent link="camera"/><child link="lidar"/>
<origin rpy="1.5707963267948966 -1.5707963267948966 0"/></joint>
<joint name="board_joint" type="fixed"><parent link="camera"/><child link="board"/></joint>
</robot>
)";

/// A board that a person holds before a camera and a lidar beside it.
/// @param noise  of a pixel; of a range, 0.02 m for a pixel
std::vector<Sample> board_samples(const Pose<double>& camera_T_lidar, double noise) {
  std::mt19937 engine(1);
  std::uniform_real_distribution<double> within(-1.0, 1.0);
  std::normal_distribution<double> error(0.0, 1.0);
  std::vector<Sample> samples;
  for (int s = 0; s < 15; ++s) {
    const Pose<double> board{
        exp(Vector3<double>(0.5 * within(engine), 0.5 * within(engine), 0.4 * within(engine))),
        Vector3<double>(0.3 * within(engine), 0.2 * within(engine), 1.7 + 0.5 * within(engine))};
    Observation camera{"camera", {}, CameraInfo{}}, corners{"board", {}, {}},
        lidar{"lidar", {}, {}};
    camera.camera->width = 640;
    camera.camera->height = 480;
    camera.camera->k = {600, 0, 320, 0, 600, 240, 0, 0, 1};
    camera.camera->p = {600, 0, 320, 0, 0, 600, 240, 0, 0, 0, 1, 0};
    for (int i = 0; i < 24; ++i) {
      const Vector3<double> corner(0.1 * (i % 6) - 0.25, 0.1 * (i / 6) - 0.15, 0.0);
      const Vector3<double> p = board * corner;
      corners.features.push_back({.frame = "board", .point = corner, .id = i});
      camera.features.push_back(
          {.frame = "camera",
           .point = Vector3<double>(600.0 * p.x() / p.z() + 320.0 + noise * error(engine),
                                    600.0 * p.y() / p.z() + 240.0 + noise * error(engine), 0.0),
           .id = i});
    }
    const Pose<double> lidar_T_board = camera_T_lidar.inverse() * board;
    for (int i = 0; i < 40; ++i) {
      const Vector3<double> on_board(0.3 * within(engine), 0.2 * within(engine), 0.0);
      const Vector3<double> p = lidar_T_board * on_board;
      const double range = 0.02 * noise * error(engine);
      lidar.features.push_back({"lidar", p * (1.0 + range / p.norm())});
    }
    samples.push_back({});
    samples.back().source = "view " + std::to_string(s + 1);
    samples.back().observations = {camera, corners, lidar};
  }
  return samples;
}

TEST(CalibrateLidar, StandsWhereItsPointsLieOnTheBoardsThatTheCameraSees) {
  constexpr double kExact = 1e-5;  // metres and radians: where the solver stops without noise
  const Pose<double> nominal{(Matrix3<double>() << 0, -1, 0, 0, 0, -1, 1, 0, 0).finished(),
                             Vector3<double>::Zero()};
  const Pose<double> correction{exp(Vector3<double>(0.03, -0.02, 0.05)),
                                Vector3<double>(-0.05, -0.08, 0.12)};
  const char* const config =
      "base_link: camera\nper_sample: [board_joint]\nmodels:\n- {name: camera, type: camera2d, "
      "frame: "
      "camera}\n- {name: board, type: chain3d, frame: board}\n- {name: lidar, type: chain3d, "
      "frame: "
      "lidar}\n- {name: plane, type: chain6d, frame: board}\nfree_frames:\n- {name: lidar_joint, "
      "x: true, "
      "y: true, z: true, roll: true, pitch: true, yaw: true}\nerror_blocks:\n- {name: corners, "
      "type: "
      "chain3d_to_camera2d, model_3d: board, model_2d: camera}\n- {name: lidar_on_board, type: "
      "point_on_plane, model_a: lidar, model_b: plane}\n";
  const auto setup = [&](double noise) {
    Diagnostics found;
    CalibrationSetup made{.robot = parse_urdf(kRig, "rig.urdf"),
                          .config = parse_config(config, "calibrate.yaml", found),
                          .samples = board_samples(nominal * correction, noise),
                          .urdf_text = kRig,
                          .urdf = "rig.urdf"};
    EXPECT_THAT(found.errors, IsEmpty());
    return made;
  };
  const PreparedCalibration prepared = prepare(setup(0.0));
  ASSERT_THAT(prepared.diagnostics.errors, IsEmpty());
  const CalibrationResult exact = calibrate(prepared.calibration);
  const CalibratedRobot noisy = calibrate_robot(setup(0.3));
  for (const char axis : {'x', 'y', 'z', 'a', 'b', 'c'}) {
    const std::string name = std::string("lidar_joint_") + axis;
    const double truth = test::of_frame(axis, correction);
    EXPECT_NEAR(exact.table[exact.table.index(name)].value, truth, kExact) << name;
    const int p = noisy.result.table.index(name);
    const auto deviation = noisy.deviation(p);
    ASSERT_TRUE(deviation) << name;
    EXPECT_NEAR(noisy.result.table[p].value, truth, 3.5 * *deviation) << name;
  }
}

}  // namespace
}  // namespace kinecal
