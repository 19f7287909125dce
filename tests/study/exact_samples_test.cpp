#include "kinecal/study/exact_samples.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "kinecal/study/measurement_noise.hpp"
#include "support/scene_study.hpp"

namespace kinecal::test {
namespace {

/// Largest residual of samples.
double worst(const MakeProblem& make, std::span<const double> values,
             const std::vector<Sample>& samples) {
  const std::unique_ptr<AnyProblem> problem = make();
  for (const Sample& sample : samples) problem->add_sample(sample);
  double most = 0.0;
  EXPECT_FALSE(evaluate(*problem, values, nullptr, [&](int, int, const TermResiduals& rows) {
    most = std::max(most, rows.residual.cwiseAbs().maxCoeff());
  }));
  return most;
}

/// A problem of the scene with one error block.
template <class Block>
MakeProblem with_block(const Block& block, const std::vector<std::string>& sensors,
                       const std::string& unit = "m") {
  return [block, sensors, unit] {
    std::unique_ptr<AnyProblem> all =
        make_problem(mobile_manipulator(), "base_link", table_with_units(), kSceneFrames);
    all->add_built_in(ChainPoint{}, {"arm", "hand"});
    all->add_built_in(DepthCamera{}, {"camera", "camera_optical_frame"});
    all->add_built_in(PinholeCamera{}, {"eye", "camera_optical_frame"});
    all->add_built_in("block", block, sensors, {.unit = unit});
    return all;
  };
}

/// Samples of the scene as a robot measures them that is not the true one.
std::vector<Sample> wrong_samples() {
  return NoisyScene(6).samples;
}

std::vector<double> true_values() {
  std::vector<double> values = random_values(scene_table(), 0.03, 3);
  return values;
}

TEST(ExactSamples, OfPointsFitTheTrueRobot) {
  const MakeProblem make = with_block(PointToPoint{}, {"camera", "arm"});
  const std::vector<double> values = true_values();
  ASSERT_GT(worst(make, values, wrong_samples()), 1e-3);
  EXPECT_LT(worst(make, values, exact_samples(make, values, wrong_samples())), 1e-9);
}

TEST(ExactSamples, OfPixelsFitTheTrueRobot) {
  const MakeProblem make = with_block(PointToPixel{}, {"arm", "eye"}, "px");
  const std::vector<double> values = true_values();
  ASSERT_GT(worst(make, values, wrong_samples()), 0.1);
  EXPECT_LT(worst(make, values, exact_samples(make, values, wrong_samples())), 1e-6);
}

TEST(ExactSamples, OfAFloorLieOnIt) {
  const MakeProblem make = with_block(PointToPlane{}, {"arm"});
  const std::vector<double> values = true_values();
  ASSERT_GT(worst(make, values, wrong_samples()), 1e-3);
  const std::vector<Sample> exact = exact_samples(make, values, wrong_samples());
  EXPECT_LT(worst(make, values, exact), 1e-9);
}

TEST(ExactSamples, OfPlanesArePlanes) {
  const MakeProblem make = with_block(PlaneToPlane{}, {"camera", "arm"});
  const std::vector<double> values = true_values();
  std::vector<Sample> samples = samples_with_leds(12);
  // A board in the hand, which the camera saw where it is not.
  const TrueRobot robot(mobile_manipulator(), {}, {});
  for (Sample& sample : samples) {
    Positions positions;
    for (std::size_t i = 0; i < sample.joint_names.size(); ++i) {
      positions[sample.joint_names[i]] = sample.joint_positions[i];
    }
    const Pose<double> camera_T_hand = robot.pose("camera_optical_frame", "hand", positions);
    constexpr double kSlanted = 0.6;  // cosine: else the plane of the board passes near the camera
    if (std::abs(camera_T_hand.rotation(2, 2)) < kSlanted) sample.observations.clear();
    for (Observation& seen : sample.observations) {
      const bool is_arm = seen.sensor == "arm";
      seen.features.clear();
      for (const double x : {-0.04, 0.0, 0.04}) {
        for (const double y : {-0.04, 0.04}) {
          const Vector3<double> corner(x, y, 0.05), off(0.02, 0.01, 0.03 + 0.1 * x);
          seen.features.push_back(
              {is_arm ? "hand" : "camera_optical_frame",
               is_arm ? corner : Vector3<double>(camera_T_hand * corner + off)});
        }
      }
    }
  }
  std::erase_if(samples, [](const Sample& sample) { return sample.observations.empty(); });
  ASSERT_GE(samples.size(), 2U);
  ASSERT_GT(worst(make, values, samples), 1e-3);
  EXPECT_LT(worst(make, values, exact_samples(make, values, samples)), 1e-8);
  for (Sample& sample : samples) {
    for (Observation& seen : sample.observations) {
      if (seen.sensor == "camera") seen.features.front().point.setConstant(std::nan(""));
    }
  }
  EXPECT_LT(worst(make, values, exact_samples(make, values, samples)), 1e-8)
      << "a plane turns about a point that was measured";
}

TEST(ExactSamples, KeepJointsAndTargets) {
  const MakeProblem make = with_block(PointToPoint{}, {"camera", "arm"});
  const std::vector<Sample> samples = samples_with_leds(5);
  const std::vector<Sample> exact = exact_samples(make, true_values(), samples);
  ASSERT_EQ(exact.size(), samples.size());
  for (std::size_t i = 0; i < samples.size(); ++i) {
    EXPECT_EQ(exact[i].joint_positions, samples[i].joint_positions);
    for (std::size_t f = 0; f < 4; ++f) {
      EXPECT_EQ(exact[i].observation("arm")->features[f].point,
                samples[i].observation("arm")->features[f].point);
      EXPECT_NE(exact[i].observation("camera")->features[f].point,
                samples[i].observation("camera")->features[f].point);
    }
  }
}

TEST(ExactSamples, ABlockThatNoMeasurementSatisfiesIsNamed) {
  const MakeProblem make = [] {
    auto all = with_block(PointToPlane{}, {"camera"})();
    all->add_built_in("ceiling", PointToPlane{0.0, 0.0, 1.0, -3.0}, {"camera"}, {});
    return all;
  };
  std::vector<Sample> samples = wrong_samples();
  samples.resize(1);
  samples[0].source = "poses.yaml:7";
  try {
    (void)exact_samples(make, true_values(), samples);
    ADD_FAILURE() << "was simulated";
  } catch (const StudyError& error) {
    const std::string what = error.what();
    EXPECT_NE(what.find("poses.yaml:7: error block '"), std::string::npos) << what;
  }
}

TEST(MeasuringSensors, AreCamerasAndWhatChanges) {
  const MakeProblem make = with_block(PointToPoint{}, {"camera", "arm"});
  std::vector<Sample> samples = wrong_samples();
  EXPECT_EQ(measuring_sensors(*make(), samples), (std::set<std::string>{"arm", "camera"}));
  for (Sample& sample : samples) {
    for (Observation& seen : sample.observations) {
      if (seen.sensor == "arm") seen.features = {{"hand", {0.1, 0.0, 0.0}}};
    }
  }
  EXPECT_EQ(measuring_sensors(*make(), samples), (std::set<std::string>{"camera"}));
}

}  // namespace
}  // namespace kinecal::test
