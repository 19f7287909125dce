// SPDX-License-Identifier: Apache-2.0
#include "kinecal/report/robot_scene.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "kinecal/evaluation/any_evaluator.hpp"
#include "kinecal/kinematics/forward_kinematics.hpp"
#include "support/mesh_robot_test.hpp"
#include "support/noisy_scene.hpp"

namespace kinecal {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

constexpr double kExact = 1e-9;  ///< metres: rounding of a chain of ten joints

/// A calibration that has found the truth: samples fit its result exactly.
struct Found {
  Calibration calibration;
  std::vector<Sample> samples;
  Findings findings;
  std::vector<double> truth;

  /// @param add  adds error blocks to the problem
  template <class Add>
  explicit Found(const Add& add, int count = 3, const std::string& arm_frame = "hand") {
    const auto scene = test::scene_problem();
    truth = test::random_values(scene.table(), 0.05, 3);
    samples = test::exact_samples(scene, truth, count, arm_frame);
    auto problem = make_problem(test::mobile_manipulator(), "base_link", test::scene_table(),
                                test::kSceneFrames);
    problem->add_built_in(ChainPoint{}, {"arm", "hand"});
    problem->add_built_in(DepthCamera{}, {"camera", "camera_optical_frame"});
    problem->add_built_in(PinholeCamera{}, {"eye", "camera_optical_frame"});
    add(*problem);
    for (const Sample& sample : samples) problem->add_sample(sample);
    calibration.table = problem->table();
    calibration.steps.push_back(
        {"calibrate", 100, std::move(problem), FreeSet({}, calibration.table.size()), {}});
    findings.robot = "mobile";
    findings.result.table = calibration.table;
    for (int i = 0; i < calibration.table.size(); ++i) {
      findings.result.table[i].value = truth[static_cast<std::size_t>(i)];
    }
    findings.result.steps.resize(1);
    for (int i = 0; i < count; ++i) findings.numbers.push_back(i + 1);
  }
  [[nodiscard]] RobotScene scene(const SceneLimits& limits = {}) const {
    return robot_scene(calibration, findings, samples, limits);
  }
};

void add_points(AnyProblem& problem) {
  problem.add_built_in("points", PointToPoint{}, {"camera", "arm"}, {});
}

double distance(const ScenePair& pair) {
  return std::hypot(pair[0][0] - pair[1][0], pair[0][1] - pair[1][1], pair[0][2] - pair[1][2]);
}

int link_of(const RobotScene& scene, const std::string& name) {
  for (std::size_t i = 0; i < scene.links.size(); ++i) {
    if (scene.links[i].name == name) return static_cast<int>(i);
  }
  return -1;
}

/// root_T_link by the scene's joints.
Pose<double> pose_of(const RobotScene& scene, int link, const std::vector<double>& q, bool after) {
  for (const SceneJoint& joint : scene.joints) {
    if (joint.child != link) continue;
    return pose_of(scene, joint.parent, q, after) * child_in_parent(joint, q, after);
  }
  return {};
}

TEST(RobotScene, MeasuredAndPredictedPointsCoincideAtTheTruth) {
  const Found found([](AnyProblem& problem) {
    add_points(problem);
    problem.add_built_in("pixels", PointToPixel{}, {"arm", "eye"}, {.unit = "px"});
    problem.add_built_in("planes", PlaneToPlane{}, {"camera", "arm"}, {.unit = "1"});
  });
  const RobotScene scene = found.scene();
  EXPECT_THAT(scene.blocks, testing::ElementsAre("points", "pixels", "planes"));
  ASSERT_THAT(scene.samples, SizeIs(3));
  std::vector<int> of_block(3);
  for (const SceneSample& sample : scene.samples) {
    for (const SceneFeature& feature : sample.features) {
      ++of_block[static_cast<std::size_t>(feature.block)];
      ASSERT_TRUE(feature.after);
      if (feature.block == 2) continue;  // four points that are not on one plane
      EXPECT_LT(distance(*feature.after), kExact);
      if (feature.before) {
        EXPECT_GT(distance(*feature.before), 1e-4);
      }
    }
  }
  EXPECT_THAT(of_block, testing::ElementsAre(12, 12, 24));
}

TEST(RobotScene, PointsBeforeAreThoseOfTheUrdf) {
  const Found found(add_points);
  const RobotScene scene = found.scene();
  const Robot robot = test::mobile_manipulator();
  for (std::size_t n = 0; n < found.samples.size(); ++n) {
    const Sample& sample = found.samples[n];
    const auto position = [&](const std::string& joint) { return *sample.position(joint); };
    for (std::size_t i = 0; i < 4; ++i) {
      const auto point = [&](std::size_t sensor, const std::string& frame) {
        return forward_kinematics(make_chain(robot, "base_link", frame), position) *
               sample.observations[sensor].features[i].point;
      };
      const Vector3<double> arm = point(0, "hand"), camera = point(1, "camera_optical_frame");
      const ScenePair& pair = *scene.samples[n].features[i].before;
      for (std::size_t k = 0; k < 3; ++k) {
        EXPECT_NEAR(pair[0][k], camera(static_cast<int>(k)), kExact);
        EXPECT_NEAR(pair[1][k], arm(static_cast<int>(k)), kExact);
      }
    }
  }
}

TEST(RobotScene, JointsComposeToForwardKinematicsBeforeAndAfter) {
  const Found found(add_points);
  const RobotScene scene = found.scene();
  const auto problem = test::scene_problem();
  const std::vector<double> none(found.truth.size(), 0.0);
  const Pose<double> root_T_base = {};  // base_link is the root
  ASSERT_EQ(scene.links[static_cast<std::size_t>(scene.base)].name, "base_link");
  for (std::size_t n = 0; n < found.samples.size(); ++n) {
    for (const bool after : {false, true}) {
      const Pose<double> expected =
          test::tip_pose(problem, 0, "hand", found.samples[n], after ? found.truth : none);
      const Pose<double> pose =
          root_T_base * pose_of(scene, link_of(scene, "hand"), scene.samples[n].q, after);
      EXPECT_LT((pose.translation - expected.translation).norm(), kExact);
      EXPECT_LT((pose.rotation - expected.rotation).norm(), kExact);
    }
  }
}

TEST(RobotScene, AVirtualFrameIsBeyondTheLinkOfItsSensor) {
  const Found found(add_points, 2, "board");
  const RobotScene scene = found.scene();
  const auto& joint = scene.joints.back();
  EXPECT_EQ(joint.name, "board");
  EXPECT_TRUE(joint.is_virtual);
  EXPECT_EQ(joint.parent, link_of(scene, "hand"));
  EXPECT_EQ(joint.child, link_of(scene, "board"));
  const auto& table = found.findings.result.table;
  EXPECT_EQ(joint.after->t[1], table["board_y"].value);
  EXPECT_EQ(joint.after->r[2], table["board_c"].value);
  EXPECT_EQ(joint.before->t[1], 0.0);
  EXPECT_EQ(std::count_if(scene.joints.begin(), scene.joints.end(),
                          [](const SceneJoint& of) { return of.is_virtual; }),
            1);
  for (const SceneFeature& feature : scene.samples[0].features) {
    EXPECT_LT(distance(*feature.after), kExact);
  }
}

TEST(RobotScene, FeetOfPointsAreOnTheirPlane) {
  constexpr double kA = 0.2, kB = -0.1, kC = 1.0, kD = -0.4;
  const Found found([](AnyProblem& problem) {
    problem.add_built_in("floor", PointToPlane(kA, kB, kC, kD), {"camera"},
                         {.type = PointToPlane::kType});
  });
  const RobotScene scene = found.scene();
  const double length = std::hypot(kA, kB, kC);
  int feet = 0;
  for (const SceneSample& sample : scene.samples) {
    for (const SceneFeature& feature : sample.features) {
      for (const auto& pair : {feature.before, feature.after}) {
        ASSERT_TRUE(pair);
        const auto& [p, foot] = *pair;
        EXPECT_NEAR(kA * foot[0] + kB * foot[1] + kC * foot[2] + kD, 0.0, 1e-8);
        EXPECT_NEAR(distance(*pair), std::abs(kA * p[0] + kB * p[1] + kC * p[2] + kD) / length,
                    1e-8);
        ++feet;
      }
    }
  }
  EXPECT_EQ(feet, 24);
}

TEST(RobotScene, FeaturesHaveTheErrorOfTheResult) {
  test::NoisyScene noisy(8);
  noisy.solve();
  const Findings findings =
      findings_of(test::mobile_manipulator(), noisy.calibration,
                  judge_result(noisy.calibration, noisy.result, noisy.samples), noisy.samples);
  const RobotScene scene = robot_scene(noisy.calibration, findings, noisy.samples);
  double squares = 0.0;
  int features = 0;
  for (const SceneSample& sample : scene.samples) {
    for (const SceneFeature& feature : sample.features) {
      EXPECT_NEAR(distance(*feature.after), *feature.distance, kExact);
      EXPECT_THAT(feature.error, HasSubstr(" mm"));
      squares += *feature.distance * *feature.distance;
      ++features;
    }
  }
  EXPECT_EQ(features, 8 * 4);
  EXPECT_NEAR(0.5 * squares / (test::kPointNoise * test::kPointNoise),
              noisy.result.steps[0].final_cost, 1e-6);
}

TEST(RobotScene, SamplesThatWereLeftOutAreShownAndMarked) {
  test::NoisyScene noisy(20);
  noisy.samples[7].observations[0].features[1].point.x() += 0.2;
  noisy.solve();
  const std::vector<Sample> all = noisy.samples;
  const JudgedResult judged = calibrate_and_judge(noisy.calibration, all);
  ASSERT_THAT(judged.left_out, SizeIs(1));
  const std::vector<Sample> used = used_samples(judged, all), left = {all[7]};
  const Findings findings =
      findings_of(test::mobile_manipulator(), noisy.calibration, judged, used);
  const RobotScene scene = robot_scene(noisy.calibration, findings, used, {}, left);
  ASSERT_THAT(scene.samples, SizeIs(20));
  EXPECT_THAT(scene.thinned, IsEmpty());
  for (int i = 0; i < 20; ++i) {
    const SceneSample& sample = scene.samples[static_cast<std::size_t>(i)];
    EXPECT_EQ(sample.number, i + 1);
    EXPECT_EQ(sample.left_out, i == 7);
    EXPECT_THAT(sample.features, SizeIs(4));
  }
  const SceneSample& out = scene.samples[7];
  EXPECT_TRUE(out.bad);
  EXPECT_EQ(out.note, findings.left_out[0].why);
  EXPECT_EQ(out.source, all[7].source);
  EXPECT_NEAR(*out.features[1].distance, 0.2, 0.02);
  EXPECT_NEAR(distance(*out.features[1].after), *out.features[1].distance, kExact);
  EXPECT_THAT(robot_scene(noisy.calibration, findings, used).samples, SizeIs(19));
  EXPECT_EQ(robot_scene(noisy.calibration, findings, used, {.samples = 4}, left).thinned,
            "4 of 20 samples");
}

TEST(RobotScene, OfManySamplesBadOnesAreKeptAndOthersEvenly) {
  test::NoisyScene noisy(60);
  noisy.samples[33].observations[0].features[1].point.x() += 0.05;
  noisy.solve();
  const Findings findings =
      findings_of(test::mobile_manipulator(), noisy.calibration,
                  judge_result(noisy.calibration, noisy.result, noisy.samples), noisy.samples);
  const RobotScene scene =
      robot_scene(noisy.calibration, findings, noisy.samples, {.samples = 10, .features = 30});
  ASSERT_THAT(scene.samples, SizeIs(10));
  EXPECT_EQ(scene.thinned, "10 of 60 samples");
  int bad = 0;
  for (std::size_t i = 0; i < scene.samples.size(); ++i) {
    const SceneSample& sample = scene.samples[i];
    if (i > 0) {
      EXPECT_LT(scene.samples[i - 1].number, sample.number);
    }
    EXPECT_EQ(sample.bad, sample.number == 34);
    EXPECT_EQ(sample.note.empty(), !sample.bad);
    bad += sample.bad ? 1 : 0;
  }
  EXPECT_EQ(bad, 1);
  EXPECT_LT(scene.samples.front().number, 13);  // evenly: the first and the last sixth are there
  EXPECT_GT(scene.samples.back().number, 45);
}

TEST(RobotScene, OfManyFeaturesTheWorstAreKept) {
  test::NoisyScene noisy(6);
  for (Sample& sample : noisy.samples) {
    for (Observation& seen : sample.observations) {
      const std::vector<Feature> once = seen.features;
      seen.features.insert(seen.features.end(), once.begin(), once.end());
    }
    sample.observations[0].features[5].point.z() += 0.002;
  }
  noisy.solve();
  const Findings findings =
      findings_of(test::mobile_manipulator(), noisy.calibration,
                  judge_result(noisy.calibration, noisy.result, noisy.samples), noisy.samples);
  const RobotScene all = robot_scene(noisy.calibration, findings, noisy.samples);
  EXPECT_THAT(all.thinned, IsEmpty());
  const RobotScene few =
      robot_scene(noisy.calibration, findings, noisy.samples, {.samples = 10, .features = 24});
  EXPECT_EQ(few.thinned, "24 of 48 features in them");
  const auto worst = [](const SceneSample& sample) {
    double most = 0.0;
    for (const SceneFeature& of : sample.features) most = std::max(most, *of.distance);
    return most;
  };
  for (std::size_t i = 0; i < few.samples.size(); ++i) {
    EXPECT_THAT(few.samples[i].features, SizeIs(4));
    EXPECT_EQ(worst(few.samples[i]), worst(all.samples[i]));
  }
}

TEST(RobotScene, ASampleThatLacksTheRestOfTheRobotHasZeroThere) {
  Found found(add_points, 1);
  found.samples[0].joint_names.push_back("not_of_the_robot");
  found.samples[0].joint_positions.push_back(1.0);
  const RobotScene scene = found.scene();
  EXPECT_EQ(scene.names.size(), scene.samples[0].q.size());
  EXPECT_EQ(std::count(scene.names.begin(), scene.names.end(), "not_of_the_robot"), 0);
}

TEST(RobotScene, CamerasHaveTheirCalibratedFocalLengths) {
  const Found found(add_points);
  const RobotScene scene = found.scene();
  ASSERT_THAT(scene.cameras, SizeIs(2));
  EXPECT_EQ(scene.cameras[0].name, "camera");
  EXPECT_EQ(scene.cameras[0].width, 640.0);
  EXPECT_EQ(scene.cameras[0].link, link_of(scene, "camera_optical_frame"));
  EXPECT_DOUBLE_EQ(scene.cameras[0].fx,
                   550.0 * (1.0 + found.findings.result.table["camera_fx"].value));
}

/// The arm with meshes, calibrated by clouds.
class SceneOfClouds : public test::MeshRobotTest {
 protected:
  [[nodiscard]] CalibratedRobot calibrated(const std::string& initial) const {
    CalibrationSetup setup = setup_of(test::mesh_config(initial));
    setup.samples = test::mesh_robot_samples(setup.robot, {.samples = 4, .noise = 0.001});
    return calibrate_robot(std::move(setup));
  }
  [[nodiscard]] static RobotScene scene_of(const CalibratedRobot& of,
                                           const SceneLimits& limits = {}) {
    return robot_scene(of.setup.calibration, of, of.samples, limits);
  }
};

Vector3<double> vector_of(const ScenePoint& p) {
  return {p[0], p[1], p[2]};
}

TEST_F(SceneOfClouds, PointsAreBesideTheRobotBeforeAndOnItAfter) {
  const CalibratedRobot of = calibrated(test::kStart);
  const RobotScene scene = scene_of(of);
  ASSERT_THAT(scene.samples, SizeIs(4));
  const RobotSurface surface = test::mesh_robot_surface();
  ParameterTable start = of.setup.calibration.table;
  const Pose<double> was = test::camera_in(start), is = test::camera_in(of.result.table);
  for (std::size_t n = 0; n < scene.samples.size(); ++n) {
    const SceneCloud &before = scene.samples[n].matched_before,
                     &after = scene.samples[n].matched_after;
    EXPECT_THAT(scene.samples[n].features, IsEmpty()) << "thousands of lines";
    ASSERT_THAT(after.points, SizeIs(of.samples[n].observations.front().features.size()));
    ASSERT_THAT(before.points, SizeIs(after.points.size()));
    ASSERT_THAT(after.distances, SizeIs(after.points.size()));
    const auto links = test::mesh_robot_poses(of.setup.robot, test::positions_of(of.samples[n]));
    double far_before = 0.0, far_after = 0.0;
    for (std::size_t i = 0; i < after.points.size(); ++i) {
      const Vector3<double> p = vector_of(after.points[i]);
      EXPECT_NEAR(surface.closest(links, p).distance, after.distances[i], 1e-4)
          << "the solve goes on where rounds end";
      const Vector3<double> same = was * Vector3<double>(is.inverse() * p);
      EXPECT_LT((vector_of(before.points[i]) - same).norm(), kExact) << "the camera has moved";
      far_before += before.distances[i] / static_cast<double>(after.points.size());
      far_after += after.distances[i] / static_cast<double>(after.points.size());
    }
    EXPECT_GT(far_before, 10.0 * far_after);
    EXPECT_LT(far_after, 2e-3);
  }
}

TEST_F(SceneOfClouds, AreThinnedEvenlyAndAlike) {
  const CalibratedRobot of = calibrated(test::kStart);
  const RobotScene all = scene_of(of), few = scene_of(of, {.points = 200});
  for (std::size_t n = 0; n < few.samples.size(); ++n) {
    const auto &whole = all.samples[n].matched_after.points,
               &thin = few.samples[n].matched_after.points;
    ASSERT_THAT(thin, SizeIs(50));
    for (std::size_t i = 0; i < thin.size(); ++i) EXPECT_EQ(thin[i], whole[i * whole.size() / 50]);
    EXPECT_THAT(few.samples[n].matched_before.points, SizeIs(50));
  }
}

TEST_F(SceneOfClouds, APoseThatNobodyGaveHasNoBefore) {
  const CalibratedRobot of = calibrated("");
  EXPECT_THAT(of.result.steps.front().starts.frames, testing::ElementsAre("camera_joint"));
  EXPECT_FALSE(of.result.steps.front().starts.searched()) << "the rounds did";
  for (const SceneSample& sample : scene_of(of).samples) {
    EXPECT_THAT(sample.matched_before.points, IsEmpty());
    EXPECT_THAT(sample.matched_after.points, testing::Not(IsEmpty()));
  }
}

TEST(RobotScene, WithoutASurfaceHasNoCloudOnIt) {
  const Found found(add_points);
  for (const SceneSample& sample : found.scene().samples) {
    EXPECT_THAT(sample.matched_before.points, IsEmpty());
    EXPECT_THAT(sample.matched_after.points, IsEmpty());
  }
}

}  // namespace
}  // namespace kinecal
