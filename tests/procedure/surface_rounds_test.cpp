#include "kinecal/procedure/surface_rounds.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <filesystem>
#include <map>
#include <random>

#include "kinecal/config/read_config.hpp"
#include "kinecal/files/samples/read_samples.hpp"
#include "kinecal/files/urdf/read_urdf.hpp"
#include "kinecal/geometry/median.hpp"
#include "kinecal/procedure/calibrate_robot.hpp"
#include "support/data.hpp"
#include "support/laser_room.hpp"
#include "support/mesh_robot_test.hpp"

namespace kinecal {
namespace {

using test::angle_of, test::camera_in, test::distance_of, test::kStart;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

/// The arm, and clouds of it.
class SurfaceRoundsOfAnArm : public test::MeshRobotTest {
 protected:
  CalibrationSetup setup(const std::string& config, const test::CloudPlan& plan = {}) {
    CalibrationSetup setup = setup_of(config);
    setup.samples = test::mesh_robot_samples(setup.robot, plan);
    return setup;
  }

  std::vector<std::string> errors_of(const CalibrationSetup& of) {
    return prepare(of).diagnostics.errors;
  }
};

TEST_F(SurfaceRoundsOfAnArm, FindTheCameraToTheNoise) {
  const CalibratedRobot calibrated =
      calibrate_robot(setup(test::mesh_config(kStart), {.noise = 0.001}));
  ASSERT_TRUE(calibrated.is_usable()) << calibrated.judgement.reasons.front();
  const Pose<double> found = camera_in(calibrated.result.table);
  EXPECT_LT(distance_of(found, test::true_camera()), 0.5e-3) << "10 000 points with 1 mm of noise";
  EXPECT_LT(angle_of(found, test::true_camera()), 0.5e-3);
}

TEST_F(SurfaceRoundsOfAnArm, AreZeroAtTheTruth) {
  const CalibratedRobot calibrated = calibrate_robot(setup(test::mesh_config(kStart)));
  ASSERT_TRUE(calibrated.result.converged);
  const Pose<double> found = camera_in(calibrated.result.table);
  EXPECT_LT(distance_of(found, test::true_camera()), 1e-6) << "vertices of files are floats";
  EXPECT_LT(angle_of(found, test::true_camera()), 1e-6);
  EXPECT_LT(calibrated.result.steps.back().final_cost, 1e-9);
}

TEST_F(SurfaceRoundsOfAnArm, FindOffsetsOfJoints) {
  const CalibratedRobot calibrated =
      calibrate_robot(setup(test::mesh_config(kStart, "", "lift, elbow"),
                            {.noise = 0.001, .offsets = {{"lift", 0.02}, {"elbow", -0.03}}}));
  ASSERT_TRUE(calibrated.is_usable()) << calibrated.judgement.reasons.front();
  EXPECT_NEAR(calibrated.result.table["lift"].value, 0.02, 1e-3);
  EXPECT_NEAR(calibrated.result.table["elbow"].value, -0.03, 1e-3);
  EXPECT_LT(distance_of(camera_in(calibrated.result.table), test::true_camera()), 2e-3);
}

/// Each link is 2 mm beside its mesh, in all samples alike: samples do not show it, links do.
TEST_F(SurfaceRoundsOfAnArm, AdmitLinksThatAreNotTheirMeshes) {
  std::vector<double> errors;  // in standard deviations
  int by_links = 0;
  for (unsigned seed = 1; seed <= 12; ++seed) {
    std::mt19937 engine(seed);
    std::normal_distribution<double> shift(0.0, 0.002);
    test::CloudPlan plan{.samples = 3, .pixels = 40, .noise = 0.001, .seed = seed};
    for (int l = 0; l < 4; ++l) {
      plan.shifts.emplace_back(shift(engine), shift(engine), shift(engine));
    }
    const CalibratedRobot calibrated = calibrate_robot(setup(test::mesh_config(kStart), plan));
    const Assessment& found = calibrated.assessments.back();
    by_links += found.uncertainty.by_links ? 1 : 0;
    double variance = 0.0;
    for (const char* axis : {"camera_joint_x", "camera_joint_y", "camera_joint_z"}) {
      const auto deviation = found.deviation(calibrated.result.table.find(axis));
      ASSERT_TRUE(deviation);
      variance += *deviation * *deviation;
    }
    errors.push_back(distance_of(camera_in(calibrated.result.table), test::true_camera()) /
                     std::sqrt(variance));
  }
  EXPECT_GE(by_links, 9);
  EXPECT_LT(median_of(errors), 1.6);
  EXPECT_GT(median_of(errors), 0.3);
  EXPECT_LE(std::ranges::count_if(errors, [](double error) { return error > 3.0; }), 1);
}

TEST_F(SurfaceRoundsOfAnArm, NeedNoStart) {
  for (const unsigned seed : {1U, 2U, 3U}) {
    PreparedCalibration prepared = prepare(setup(
        test::mesh_config(""), {.samples = 4, .noise = 0.001, .background = true, .seed = seed}));
    ASSERT_THAT(prepared.diagnostics.errors, IsEmpty());
    EXPECT_THAT(prepared.diagnostics.notes,
                testing::Contains(HasSubstr("'camera_joint' was searched")));
    ParameterTable table = prepared.calibration.table;
    for (int p = 0; p < table.size(); ++p) {
      table[p].value = prepared.calibration.begin[static_cast<std::size_t>(p)];
    }
    EXPECT_LT(distance_of(camera_in(table), test::true_camera()), 3e-3) << "seed " << seed;
  }
}

/// All links are a box now, turned with the first joint only: from behind it looks as from the front.
TEST_F(SurfaceRoundsOfAnArm, NameAViewThatLooksAlikeFromElsewhere) {
  const test::Shape box = test::box({-0.2, -0.12, 0.0}, {0.2, 0.12, 0.5});
  std::ofstream(folder_ / "base.stl", std::ios::binary) << test::binary_stl(box.for_file());
  CalibrationSetup clouds = setup_of(test::mesh_config("", ", link_name: base"));
  const RobotSurface surface({{"base", TriangleTree(box.vertices, box.triangles)}});
  clouds.samples = test::mesh_robot_samples(clouds.robot, {.samples = 4, .noise = 0.001}, surface);
  EXPECT_THAT(
      prepare(std::move(clouds)).diagnostics.doubts,
      testing::Contains(HasSubstr("'camera_joint' may stand elsewhere: turned by 180 deg")));
}

TEST_F(SurfaceRoundsOfAnArm, LeaveTheBackgroundOut) {
  const PreparedCalibration prepared =
      prepare(setup(test::mesh_config(kStart), {.noise = 0.001, .background = true}));
  ASSERT_THAT(prepared.diagnostics.errors, IsEmpty());
  for (const Sample& sample : prepared.samples) {
    const Observation& camera = *sample.observation("camera");
    ASSERT_EQ(camera.features.size(), sample.observation("camera_surface")->features.size());
    EXPECT_GT(camera.features.size(), 100U);
    for (const Feature& feature : camera.features) EXPECT_LT(feature.point.z(), 2.2);
  }
}

/// A wall is seen behind the arm, and in some clouds the floor beside its base.
TEST_F(SurfaceRoundsOfAnArm, TakeABackgroundForNoFault) {
  const std::string loss = ", loss: {type: cauchy, scale: 0.005}";
  CalibrationSetup clouds = setup(test::mesh_config(kStart, loss, "lift, elbow"),
                                  {.samples = 12,
                                   .noise = 0.0002,
                                   .background = true,
                                   .offsets = {{"lift", 0.02}, {"elbow", -0.03}}});
  for (const std::size_t s : {1U, 5U, 9U}) {
    for (int i = 0; i < 100; ++i) {
      const Vector3<double> p(-0.14 - 0.001 * (i % 60), 0.002 * (i % 50) - 0.05, 0.0);
      clouds.samples[s].observations[0].features.push_back(
          {.frame = "camera", .point = test::true_camera().inverse() * p});
    }
  }
  const CalibratedRobot calibrated = calibrate_robot(std::move(clouds));
  EXPECT_THAT(calibrated.judgement.reasons, IsEmpty());
  EXPECT_THAT(calibrated.left_out_samples, IsEmpty());
  EXPECT_NEAR(calibrated.result.table["lift"].value, 0.02, 1e-3);
  EXPECT_NEAR(calibrated.result.table["elbow"].value, -0.03, 1e-3);
}

TEST_F(SurfaceRoundsOfAnArm, DoNotDependOnTheNumberOfThreads) {
  const auto begin_with = [&](int threads) {
    CalibrationOptions options;
    options.solving.threads = threads;
    const PreparedCalibration prepared =
        prepare(setup(test::mesh_config(""), {.samples = 3, .background = true}), options);
    EXPECT_THAT(prepared.diagnostics.errors, IsEmpty());
    return prepared.calibration.begin;
  };
  EXPECT_EQ(begin_with(1), begin_with(3));
}

TEST_F(SurfaceRoundsOfAnArm, UseTheLinksThatAreListed) {
  const PreparedCalibration prepared = prepare(
      setup(test::mesh_config(kStart, ", link_names: [base, upper, fore]"), {.noise = 0.001}));
  ASSERT_THAT(prepared.diagnostics.errors, IsEmpty());
  for (const Feature& feature : prepared.samples[0].observation("camera_surface")->features) {
    EXPECT_NE(feature.frame, "hand");
  }
  EXPECT_THAT(errors_of(setup(test::mesh_config(kStart, ", links: [uper]"))),
              ElementsAre(HasSubstr("no link 'uper' in robot 'arm'; did you mean 'upper'?")));
}

TEST_F(SurfaceRoundsOfAnArm, RefuseCloudsInMillimetres) {
  CalibrationSetup of = setup(test::mesh_config(kStart));
  for (Sample& sample : of.samples) {
    for (Feature& feature : sample.observations[0].features) feature.point *= 1000.0;
  }
  EXPECT_THAT(errors_of(of), ElementsAre(HasSubstr("not in metres (millimetres?)")));
}

TEST_F(SurfaceRoundsOfAnArm, RefuseCloudsOfSomethingElse) {
  CalibrationSetup of = setup(test::mesh_config(kStart));
  std::mt19937 engine(1);
  std::uniform_real_distribution<double> along(-0.7, 0.7);
  for (Sample& sample : of.samples) {
    for (Feature& feature : sample.observations[0].features) {
      feature.point = {along(engine), along(engine), 1.5 + along(engine)};
    }
  }
  const std::vector<std::string> errors = errors_of(of);
  ASSERT_EQ(errors.size(), 1U);
  EXPECT_THAT(errors[0], HasSubstr("the points do not lie on the robot"));
}

// The base, which never moves, may give the camera alone: then it is right.
TEST_F(SurfaceRoundsOfAnArm, GiveNoWrongCameraFromCloudsOfOtherJoints) {
  for (const char* start : {kStart, ""}) {
    for (const unsigned seed : {77U, 78U, 79U}) {
      CalibrationSetup of = setup(test::mesh_config(start), {.noise = 0.001});
      const CalibrationSetup others = setup(test::mesh_config(start), {.seed = seed});
      for (std::size_t s = 0; s < of.samples.size(); ++s) {
        of.samples[s].observations = others.samples[s].observations;
      }
      const PreparedCalibration prepared = prepare(of);
      if (!prepared.diagnostics.errors.empty()) {
        EXPECT_THAT(prepared.diagnostics.errors[0], HasSubstr("the robot"));
        continue;
      }
      ParameterTable table = prepared.calibration.table;
      for (int p = 0; p < table.size(); ++p) {
        table[p].value = prepared.calibration.begin[static_cast<std::size_t>(p)];
      }
      EXPECT_LT(distance_of(camera_in(table), test::true_camera()), 5e-3) << "seed " << seed;
    }
  }
}

TEST_F(SurfaceRoundsOfAnArm, NameMeshesThatAreMissing) {
  std::filesystem::remove(folder_ / "fore.stl");
  EXPECT_THAT(errors_of(setup(test::mesh_config(kStart))),
              ElementsAre(HasSubstr("link 'fore': mesh 'fore.stl' is not there")));
}

/// The reference figures of a KUKA Med 7 that a RealSense sees: README of the data set.
class SurfaceOfMed7 : public testing::TestWithParam<const char*> {
 protected:
  static PreparedCalibration prepared(const std::string& config, const std::string& samples,
                                      const std::vector<int>& some = {}) {
    const std::filesystem::path folder = test::data_folder() / "med7_mesh";
    Diagnostics found;
    CalibrationSetup setup;
    setup.urdf = (folder / "med7.urdf").string();
    setup.urdf_text = read_urdf_text(setup.urdf);
    setup.robot = parse_urdf(setup.urdf_text, setup.urdf);
    setup.config = config.find('\n') == std::string::npos
                       ? read_config((folder / config).string(), found)
                       : parse_config(config, "calibrate.yaml", found);
    std::vector<Sample> all = read_samples((folder / samples).string(), found);
    for (const int number : some) setup.samples.push_back(all[static_cast<std::size_t>(number)]);
    if (some.empty()) setup.samples = std::move(all);
    return prepare(std::move(setup), {}, std::move(found));
  }

  static Pose<double> found_by(const PreparedCalibration& of) {
    ParameterTable table = of.calibration.table;
    for (int p = 0; p < table.size(); ++p) {
      table[p].value = of.calibration.begin[static_cast<std::size_t>(p)];
    }
    return camera_in(table);
  }

  static Pose<double> reference() {
    return {rotation_from_rpy(Vector3<double>(-1.10618, -0.25715, -1.03641)),
            Vector3<double>(-0.94297, -0.38382, -0.13714)};
  }
};

TEST_P(SurfaceOfMed7, ReachesTheReference) {
  KINECAL_NEEDS_DATA("med7_mesh");
  const PreparedCalibration of = prepared(GetParam(), "samples_masked.yaml");
  ASSERT_THAT(of.diagnostics.errors, IsEmpty());
  EXPECT_THAT(of.diagnostics.notes, testing::Contains(HasSubstr("their cost 0.2951")));
  EXPECT_LT(distance_of(found_by(of), reference()), 0.5e-3) << "what kinks of the cost move";
  EXPECT_LT(angle_of(found_by(of), reference()), 1e-3);
}

INSTANTIATE_TEST_SUITE_P(Starts, SurfaceOfMed7,
                         testing::Values("calibrate.yaml", "calibrate_far.yaml"));

/// A tilting laser in a room whose walls are a link of the URDF.
CalibrationSetup laser_in_a_room(std::vector<Sample> samples, const std::string& loss = "") {
  Diagnostics found;
  CalibrationSetup setup{
      .robot = parse_urdf(test::kLaserRoomUrdf, "room.urdf"),
      .config = parse_config(
          "base_link: base\nmodels:\n- {name: laser, type: chain3d, frame: laser}\n"
          "free_params: [tilt]\nfree_frames:\n- {name: laser_joint, x: true, y: true, z: "
          "true, roll: true, pitch: false, yaw: true}\nerror_blocks:\n- {name: room, "
          "type: chain3d_to_mesh, model: laser, links: [room]" +
              loss + "}\n",
          "calibrate.yaml", found),
      .samples = std::move(samples),
      .urdf_text = test::kLaserRoomUrdf,
      .urdf = "room.urdf"};
  EXPECT_THAT(found.errors, IsEmpty());
  return setup;
}

const test::LaserErrors kLaserErrors{0.02, {0.010, -0.008, 0.005}, {0.02, 0.0, -0.015}};

/// @param deviations  what is found is within so many of its own standard deviations
void expect_laser(const CalibratedRobot& calibrated, double deviations, double exact) {
  const std::map<std::string, double> truth{
      {"tilt", 0.02},           {"laser_joint_x", 0.010}, {"laser_joint_y", -0.008},
      {"laser_joint_z", 0.005}, {"laser_joint_a", 0.02},  {"laser_joint_c", -0.015}};
  for (const auto& [name, value] : truth) {
    const int index = calibrated.result.table.find(name);
    ASSERT_GE(index, 0) << name;
    const auto deviation = calibrated.assessments.back().deviation(index);
    ASSERT_TRUE(deviation) << name;
    EXPECT_NEAR(calibrated.result.table[index].value, value, deviations * *deviation + exact)
        << name;
  }
}

TEST(SurfaceRoundsOfALaser, FindItsMountAndTheZeroOfItsJointInARoom) {
  const CalibratedRobot noisy =
      calibrate_robot(laser_in_a_room(test::laser_samples(kLaserErrors, 0.005)));
  ASSERT_TRUE(noisy.is_usable()) << noisy.judgement.reasons.front();
  expect_laser(noisy, 3.5, 0.0);
}

TEST(SurfaceRoundsOfALaser, LeaveOutWhatStandsInTheRoom) {
  const CalibratedRobot calibrated = calibrate_robot(laser_in_a_room(
      test::laser_samples(kLaserErrors, 0.005, 0.2), ", loss: {type: cauchy, scale: 0.02}"));
  expect_laser(calibrated, 4.0, 1e-3);
}

TEST(SurfaceRoundsOfALaser, RefuseWallsThatAreElsewhere) {
  std::vector<Sample> samples = test::laser_samples(kLaserErrors, 0.005);
  for (Sample& sample : samples) {
    double factor = 0.2;
    for (Feature& feature : sample.observations[0].features) {
      factor = factor > 0.9 ? 0.2 : factor + 0.13;
      feature.point *= factor;
    }
  }
  Diagnostics found = prepare(laser_in_a_room(std::move(samples))).diagnostics;
  ASSERT_FALSE(found.errors.empty());
  EXPECT_THAT(found.errors.front(), HasSubstr("the points do not lie on the robot"));
}

}  // namespace
}  // namespace kinecal
