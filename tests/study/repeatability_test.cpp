#include "kinecal/study/repeatability.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "kinecal/study/study_summary.hpp"
#include "support/scene_study.hpp"

namespace kinecal::test {
namespace {

TEST(Repeatability, AStudyGivesTheSameTrialsInAnyOrder) {
  const SceneStudy study;
  const StudyRobot robot = study_robot(study.setup, 1);
  const StudyTrial first = run_study_job(study.setup, robot, {1, 20, 0});
  const StudyTrial second = run_study_job(study.setup, robot, {1, 20, 1});
  const StudyTrial again = run_study_job(study.setup, study_robot(study.setup, 1), {1, 20, 0});
  EXPECT_EQ(first.values, again.values);
  EXPECT_EQ(first.position, again.position);
  EXPECT_NE(first.values, second.values);
}

TEST(Repeatability, RobotsAndPosesFollowFromTheSeed) {
  SceneStudy study;
  const StudyRobot one = study_robot(study.setup, 0), other = study_robot(study.setup, 1);
  EXPECT_NE(one.truth, other.truth);
  const std::vector<int> poses = study_poses(study.setup, {0, 10, 0});
  EXPECT_EQ(poses.size(), 10U);
  EXPECT_EQ(poses, study_poses(study.setup, {3, 10, 7}));  // of every robot and repetition
  study.setup.seed = 2;
  EXPECT_NE(one.truth, study_robot(study.setup, 0).truth);
}

TEST(Repeatability, ErrorsOfRobotsHaveTheirSizes) {
  const SceneStudy study;
  const StudyRobot robot = study_robot(study.setup, 4);
  const ParameterTable table = scene_table();
  for (const int p : study.setup.free) {
    const double size = error_size(mobile_manipulator(), table[p].name, study.setup.errors);
    const double error = std::abs(robot.truth[static_cast<std::size_t>(p)]);
    EXPECT_GE(error, 0.5 * size) << table[p].name;
    EXPECT_LE(error, size) << table[p].name;
    EXPECT_GT(size, 0.0) << table[p].name;
  }
}

TEST(Repeatability, WithoutNoiseTheTruthIsFound) {
  SceneStudy study;
  study.setup.noise = {0.0, 0.0, 0.0, 0.0, 0.0};
  const StudyRobot robot = study_robot(study.setup, 0);
  const StudyTrial trial = run_study_job(study.setup, robot, {0, 30, 0});
  EXPECT_TRUE(trial.converged);
  EXPECT_LT(trial.position, 1e-9);
  EXPECT_LT(trial.reprojection, 1e-9);
}

TEST(Repeatability, FreeTargetsAreSixUnknownsOfWhichEachSensorHasResiduals) {
  const SceneStudy study;
  const std::vector<Sample> samples =
      exact_samples(study.setup.make, study.setup.drawn, std::span(study.setup.samples).first(3));
  const FreeSet free = study.scene.free();
  const StudyDesign design = study_design(study.setup.make, free, study.setup.drawn, samples,
                                          study.setup.noise, Targets::free);
  const TrueRobot robot(mobile_manipulator(), {}, {});
  for (std::size_t s = 0; s < samples.size(); ++s) {
    const auto problem = study.scene.problem({samples[s]});
    Positions positions;
    for (std::size_t i = 0; i < samples[s].joint_names.size(); ++i) {
      positions[samples[s].joint_names[i]] = samples[s].joint_positions[i];
    }
    const Pose<double> hand = robot.pose("base_link", "hand", positions);
    Eigen::MatrixXd of_camera, of_arm, motion;
    (void)evaluate(*problem, study.setup.drawn, &free, [&](int, int, const TermResiduals& rows) {
      of_camera = rows.jacobian / kPointNoise;
      of_arm = Eigen::MatrixXd::Zero(of_camera.rows(), of_camera.cols());
      for (int c = 0; c < 3; ++c) {  // shoulder_lift, elbow, wrist
        of_arm.col(c) = -of_camera.col(c);
        of_camera.col(c).setZero();
      }
      motion.resize(of_arm.rows(), 6);
    });
    const std::vector<Feature> leds = scene_leds();
    for (Eigen::Index i = 0; i < std::ssize(leds); ++i) {
      const Vector3<double> arm = hand.rotation * leds[static_cast<std::size_t>(i)].point;
      for (int k = 0; k < 3; ++k) {
        motion.block<3, 1>(3 * i, k) = Vector3<double>::Unit(k) / kPointNoise;
        motion.block<3, 1>(3 * i, 3 + k) = Vector3<double>::Unit(k).cross(arm) / kPointNoise;
      }
    }
    // Residuals of both sensors, and the motion that both follow, which is then eliminated.
    const Eigen::MatrixXd both = of_camera + of_arm;
    const Eigen::MatrixXd expected =
        of_camera.transpose() * of_camera + of_arm.transpose() * of_arm -
        both.transpose() * motion *
            (2.0 * motion.transpose() * motion).ldlt().solve(motion.transpose() * both);
    const Eigen::MatrixXd found = design.samples[s].information.matrix();
    EXPECT_LT((found - expected).norm(), 1e-6 * expected.norm());
  }
}

/// Its features are not numbers, or absent.
TEST(Repeatability, ASampleThatNoBlockUsesAddsNothing) {
  const SceneStudy study;
  const FreeSet free = study.scene.free();
  for (const std::size_t unused : {0U, 1U}) {
    std::vector<Sample> samples(study.setup.samples.begin(), study.setup.samples.begin() + 12);
    for (Observation& seen : samples[unused].observations) {
      for (Feature& feature : seen.features) feature.point.setConstant(std::nan(""));
    }
    samples[2 + unused].observations.clear();
    const StudyDesign design = study_design(
        study.setup.make, free, study.setup.drawn,
        exact_samples(study.setup.make, study.setup.drawn, samples), study.setup.noise);
    std::vector<int> all, used;
    for (int i = 0; i < 12; ++i) {
      all.push_back(i);
      if (design.samples[static_cast<std::size_t>(i)].information.matrix().norm() > 0.0)
        used.push_back(i);
    }
    EXPECT_EQ(used.size(), 10U);
    const ExpectedUncertainty with = expected_uncertainty(design, all),
                              without = expected_uncertainty(design, used);
    EXPECT_EQ(with.determined, without.determined);
    EXPECT_EQ(with.covariance.matrix(), without.covariance.matrix());
  }
}

TEST(Repeatability, VariancesAreThoseOfTheCovariance) {
  constexpr int kTrials = 200;
  const SceneStudy study;
  const StudyRobot robot = study_robot(study.setup, 0);
  std::vector<StudyTrial> trials;
  for (int repeat = 0; repeat < kTrials; ++repeat) {
    trials.push_back(run_study_job(study.setup, robot, {0, 25, repeat}));
  }
  std::vector<StudyGroup> groups = summarize(study.setup, {&robot, 1}, trials, 3e-3);
  ASSERT_EQ(groups.size(), 1U);
  predict(study.setup, robot, trials, groups[0]);
  // The relative standard deviation of a standard deviation of 200 trials is 5 %.
  for (std::size_t p = 0; p < study.setup.free.size(); ++p) {
    const ParameterSpread& of = groups[0].parameters[p];
    EXPECT_NEAR(std::sqrt(of.variance / of.predicted), 1.0, 0.2) << kNoisyFree[p];
  }
  EXPECT_NEAR(groups[0].varied_position / groups[0].predicted_position, 1.0, 0.1);
  EXPECT_NEAR(groups[0].position / groups[0].predicted_position, 1.0, 0.1);  // nothing biases it
  EXPECT_LT(groups[0].nonlinearity, 0.1);
  EXPECT_EQ(groups[0].failed, 0);
}

TEST(Repeatability, LargeNoiseIsNotLinear) {
  SceneStudy study;
  const StudyRobot robot = study_robot(study.setup, 0);
  const StudyTrial usual = run_study_job(study.setup, robot, {0, 25, 0});
  study.setup.noise.joint = 0.4;
  const StudyTrial rough = run_study_job(study.setup, robot, {0, 25, 0});
  EXPECT_LT(usual.nonlinearity, 0.1);
  EXPECT_GT(rough.nonlinearity, 0.1);
}

TEST(Repeatability, RuinedSamplesAreCountedAndMakeResultsWorse) {
  SceneStudy study;
  const StudyRobot robot = study_robot(study.setup, 0);
  const StudyTrial good = run_study_job(study.setup, robot, {0, 30, 0});
  study.setup.ruined = 0.2;
  const StudyTrial ruined = run_study_job(study.setup, robot, {0, 30, 0});
  EXPECT_EQ(good.ruined, 0);
  EXPECT_GT(ruined.ruined, 1);
  EXPECT_LT(ruined.ruined, 15);
  EXPECT_GT(ruined.position, 3.0 * good.position);
}

TEST(Repeatability, FewerPosesVaryMore) {
  const SceneStudy study;
  const StudyRobot robot = study_robot(study.setup, 0);
  StudyGroup many, few;
  many.poses = 30;
  few.poses = 10;
  many.parameters.resize(study.setup.free.size());
  few.parameters.resize(study.setup.free.size());
  predict(study.setup, robot, {}, many);
  predict(study.setup, robot, {}, few);
  EXPECT_GT(few.predicted_position, many.predicted_position * std::sqrt(2.0));
}

}  // namespace
}  // namespace kinecal::test
