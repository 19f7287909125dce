#include "kinecal/trust/noise/gradient_variance.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <random>
#include <string>
#include <vector>

#include "support/noisy_scene.hpp"
#include "support/repetitions.hpp"
#include "support/tracked_arm.hpp"

namespace kinecal {
namespace {

double effect_in(test::NoisyScene& scene) {
  const auto evaluator = scene.solved().evaluator(scene.free());
  const LinearFit fit = scene.linear(*evaluator);
  return gradient_variance(scene.solved(), fit, each_its_own(scene.samples.size()), {},
                           information(fit, fit.loss), fit.prior_hessian)
      .effect;
}

TEST(GradientVariance, IsOneIfFeaturesErrIndependently) {
  int more = 0;
  for (unsigned seed = 0; seed < 40; ++seed) {
    test::NoisyScene scene(25, seed);
    scene.solve();
    more += effect_in(scene) > 1.0;
  }
  EXPECT_LE(more, 1);
}

TEST(GradientVariance, IsTheNumberOfCopiesOfEachFeature) {
  double sum = 0.0;
  for (unsigned seed = 0; seed < 20; ++seed) {
    test::NoisyScene scene(40, seed);
    for (Sample& sample : scene.samples) {
      for (Observation& seen : sample.observations) {
        const std::vector<Feature> once = seen.features;
        for (int copy = 1; copy < 6; ++copy) {
          seen.features.insert(seen.features.end(), once.begin(), once.end());
        }
      }
    }
    scene.solve();
    sum += effect_in(scene);
  }
  EXPECT_NEAR(sum / 20.0, 6.0, 0.4);
}

/// Joints that stop elsewhere than they report, each time.
void disturb(test::NoisyScene& scene, unsigned seed) {
  std::mt19937 random(seed + 5000);
  std::normal_distribution<double> joint(0.0, 4e-3);
  for (Sample& sample : scene.samples) {
    for (double& position : sample.joint_positions) position += joint(random);
  }
}

TEST(GradientVariance, MakesUncertaintyCoverTheTruthOfJointsThatDoNotRepeat) {
  int inside = 0, without = 0, all = 0;
  for (unsigned run = 0; run < 60; ++run) {
    test::NoisyScene scene(40, run);
    disturb(scene, run);
    const Assessment found = scene.solve_and_assess({.folds = 0});
    const double effect = found.uncertainty.design_effect;
    EXPECT_GT(effect, 1.0);
    for (std::size_t c = 0; c < found.parameters.size(); ++c, ++all) {
      const int p = found.parameters[c];
      const double error = std::abs(scene.result.table[p].value - scene.truth(p));
      const double deviation = found.uncertainty.deviation(static_cast<int>(c));
      inside += error < 1.96 * deviation;
      without += error < 1.96 * deviation / std::sqrt(effect);
    }
  }
  const auto share = [&](int count) { return static_cast<double>(count) / all; };
  EXPECT_GT(share(inside), 0.90);
  EXPECT_LT(share(inside), 0.98);
  EXPECT_LT(share(without), 0.85);
}

/// Reads each pose several times, with little noise of the sensors between the readings.
void read_again(test::NoisyScene& scene, int readings, unsigned seed) {
  std::mt19937 random(seed + 9000);
  std::normal_distribution<double> noise(0.0, 0.02 * test::kPointNoise), joint(0.0, 1e-5);
  const std::vector<Sample> once = scene.samples;
  for (int reading = 1; reading < readings; ++reading) {
    for (Sample sample : once) {
      for (double& position : sample.joint_positions) position += joint(random);
      for (Feature& feature : sample.observations[0].features) {
        for (int k = 0; k < 3; ++k) feature.point(k) += noise(random);
      }
      scene.samples.push_back(std::move(sample));
    }
  }
}

/// Each joint scatters along its own course, the first one as the tracker's frame turns: the tracker's +- are those of
/// the poses, not a mean of all directions.
TEST(GradientVariance, CoversTheFrameOfATrackerWhereJointsScatter) {
  constexpr test::ArmKind kArm{"joints to 0.2 mrad", 7, 3, 2e-5, 2e-4, 0.0, 0.0, 60};
  const int runs = test::repetitions(300, 60);
  int inside = 0, all = 0;
  double squares = 0.0;  // of the turn about z, which the first joint's scatter looks like
  for (int run = 0; run < runs; ++run) {
    const test::TrackedArm arm(kArm, static_cast<unsigned>(run));
    const Assessment& found = arm.assessment();
    const Eigen::VectorXd values = arm.values();  // of frames, the truth is zero
    for (std::size_t c = 0; c < found.parameters.size(); ++c) {
      const int p = found.parameters[c];
      const std::string& name = arm.fitted().table()[p].name;
      if (!name.starts_with("tracker")) continue;
      const double z = values(p) / found.uncertainty.deviation(static_cast<Eigen::Index>(c));
      inside += std::abs(z) < 1.96 ? 1 : 0;
      squares += name == "tracker_c" ? z * z / runs : 0.0;
      ++all;
    }
  }
  const double share = static_cast<double>(inside) / all;
  std::printf("%.3f of %d intervals cover; of the turn about z, errors are %.2f times the +-\n",
              share, all, std::sqrt(squares));
  EXPECT_GE(share, 0.92);
  EXPECT_LE(std::sqrt(squares), 1.2);
}

TEST(PoseGroups, AreReadingsOfOnePose) {
  test::NoisyScene scene(20);
  scene.solve();
  EXPECT_EQ(pose_groups(scene.solved(), scene.samples).count, 20);
  read_again(scene, 3, 1);
  const PoseGroups groups = pose_groups(scene.solved(), scene.samples);
  EXPECT_EQ(groups.count, 20);
  EXPECT_DOUBLE_EQ(groups.readings(), 3.0);
  for (std::size_t i = 0; i < scene.samples.size(); ++i) {
    EXPECT_EQ(groups.of_sample[i], static_cast<int>(i % 20));
  }
  const std::vector<int> fold = folds_of(scene.samples, groups, 5);
  for (std::size_t i = 20; i < fold.size(); ++i) EXPECT_EQ(fold[i], fold[i % 20]);
}

TEST(PoseGroups, OfJointsThatMoveNothingAreNotOne) {
  test::NoisyScene scene(20);
  scene.solve();
  for (Sample& sample : scene.samples) {
    for (double& position : sample.joint_positions) position = 0.1;
  }
  EXPECT_EQ(pose_groups(scene.solved(), scene.samples).count, 20) << "one pose determines nothing";
}

/// Share of the true values within 1.96 standard deviations, and the mean deviation relative to once.
struct GroupCoverage {
  int inside = 0, all = 0;
  double deviations = 0.0;
  void add(const test::NoisyScene& scene, const Assessment& found) {
    for (std::size_t c = 0; c < found.parameters.size(); ++c, ++all) {
      const int p = found.parameters[c];
      const double deviation = found.uncertainty.deviation(static_cast<int>(c));
      deviations += std::log(deviation);
      inside += std::abs(scene.result.table[p].value - scene.truth(p)) < 1.96 * deviation;
    }
  }
  [[nodiscard]] double share() const { return static_cast<double>(inside) / all; }
};

TEST(PoseGroups, ReadingEachPoseFiveTimesSaysNothingMoreOfTheRobot) {
  GroupCoverage once, five;
  for (unsigned run = 0; run < 60; ++run) {
    test::NoisyScene scene(30, run);
    scene.options.sigma = {};
    once.add(scene, scene.solve_and_assess({.folds = 0}));
    read_again(scene, 5, run);
    five.add(scene, scene.solve_and_assess({.folds = 0}));
  }
  EXPECT_GT(once.share(), 0.92);
  EXPECT_LT(once.share(), 0.98);
  EXPECT_GT(five.share(), 0.90);
  EXPECT_LT(five.share(), 0.98);
  EXPECT_NEAR(std::exp((five.deviations - once.deviations) / once.all), 1.0, 0.1);
}

/// The features of a sample are shifted along the target together, so some parameters suffer more.  Shrinking lets
/// the others have a part of it: their +- are larger than they need be, but not by much.
/// One long drive has stretches, whether its run has a number or not.
TEST(PoseGroups, OfFewLongRunsAreStretches) {
  const auto groups = [](std::size_t count, int runs, bool are_numbered) {
    std::vector<Sample> samples(count);
    for (std::size_t s = 0; s < count; ++s) {
      const double run =
          std::floor(static_cast<double>(s * static_cast<std::size_t>(runs) / count));
      samples[s].conditions["odom_x"] = 0.1 * static_cast<double>(s);
      if (are_numbered) samples[s].conditions[kRun] = run;
      const bool begins = s == 0 || (are_numbered && samples[s - 1].conditions.at(kRun) != run);
      if (!begins) samples[s].before = samples[s - 1].conditions;
    }
    return by_run(each_its_own(count), samples);
  };
  EXPECT_EQ(groups(200, 1, false).count, 20);
  EXPECT_EQ(groups(200, 1, true).count, 20);
  EXPECT_EQ(groups(200, 4, true).count, 20);
  EXPECT_EQ(groups(200, 4, true).of_sample.size(), 200u);
  EXPECT_EQ(groups(200, 5, true).count, 5);
  EXPECT_EQ(groups(50, 1, true).count, 50);
}

/// The range of Student's distribution with few degrees of freedom, in parts of that of the normal one.
TEST(StudentWidening, IsThatOfTables) {
  EXPECT_NEAR(student_widening(1.0), 12.706 / 1.960, 2e-3);
  EXPECT_NEAR(student_widening(2.0), 4.3027 / 1.960, 1e-3);
  EXPECT_NEAR(student_widening(3.0), 3.1824 / 1.960, 3e-3);  // of the series: 0.2 %
  EXPECT_NEAR(student_widening(10.0), 2.2281 / 1.960, 1e-3);
  EXPECT_NEAR(student_widening(1e9), 1.0, 1e-6);
  EXPECT_EQ(student_widening(0.5), student_widening(1.0));
  EXPECT_NEAR(student_widening(2.999999), student_widening(3.0), 1e-4);
}

TEST(GradientVariance, EachParameterHasItsOwnShareOfWhatErrsTogether) {
  const std::size_t count = test::kNoisyFree.size();
  std::vector<double> errors(count, 0.0), variances(count, 0.0);
  for (unsigned run = 0; run < 100; ++run) {
    test::NoisyScene scene(60, run);
    std::mt19937 random(run + 5000);
    std::normal_distribution<double> shift(0.0, 3.0 * test::kPointNoise);
    for (Sample& sample : scene.samples) {
      const double depth = shift(random);
      for (Feature& feature : sample.observations[0].features) feature.point.z() += depth;
    }
    const Assessment found = scene.solve_and_assess({.folds = 0});
    for (std::size_t c = 0; c < count; ++c) {
      const int p = found.parameters[c];
      errors[c] += std::pow(scene.result.table[p].value - scene.truth(p), 2);
      variances[c] += std::pow(found.uncertainty.deviation(static_cast<int>(c)), 2);
    }
  }
  for (std::size_t c = 0; c < count; ++c) {
    const double times = std::sqrt(variances[c] / errors[c]);
    EXPECT_GT(times, 0.85) << test::kNoisyFree[c];
    EXPECT_LT(times, 2.0) << test::kNoisyFree[c];
  }
}

}  // namespace
}  // namespace kinecal
