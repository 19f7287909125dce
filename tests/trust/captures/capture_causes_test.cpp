// Each cause is recognised in a sample that has it, and none is named for a feature that is off.
#include "kinecal/trust/captures/capture_causes.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>

#include "support/noisy_scene.hpp"
#include "support/unknown_poses.hpp"

namespace kinecal {
namespace {

using testing::HasSubstr;
using testing::StartsWith;
using Spoil = std::function<void(Sample&, test::Chance&)>;

/// Arm and camera, fitted to all samples but the last few.
class CaptureCauses : public testing::Test {
 protected:
  static constexpr int kKept = 40, kSpoilt = 30;

  void SetUp() override {
    others_.assign(scene_.samples.begin() + kKept, scene_.samples.end());
    scene_.samples.resize(kKept);
    noise_ = scene_.solve_and_assess().noise;
    values_ = scene_.values();
  }
  [[nodiscard]] std::string cause(const Sample& sample) const {
    return capture_cause(*scene_.problem({}), test::NoisyScene::span(values_), noise_, sample);
  }
  /// The causes of all other samples after each has been spoilt.
  [[nodiscard]] std::vector<std::string> causes(const Spoil& spoil) const {
    std::vector<std::string> all;
    for (std::size_t n = 0; n < others_.size(); ++n) {
      Sample sample = others_[n];
      test::Chance chance(n);
      spoil(sample, chance);
      all.push_back(cause(sample));
    }
    return all;
  }
  static std::vector<Feature>& features(Sample& sample, const std::string& sensor) {
    for (Observation& seen : sample.observations) {
      if (seen.sensor == sensor) return seen.features;
    }
    throw std::invalid_argument(sensor);
  }
  static double& position(Sample& sample, const std::string& joint) {
    const auto at = std::find(sample.joint_names.begin(), sample.joint_names.end(), joint);
    return sample.joint_positions[static_cast<std::size_t>(at - sample.joint_names.begin())];
  }

  test::NoisyScene scene_{kKept + kSpoilt};
  std::vector<Sample> others_;
  std::vector<BlockNoise> noise_;
  Eigen::VectorXd values_;
};

TEST_F(CaptureCauses, AGoodSampleHasNone) {
  EXPECT_THAT(causes([](Sample&, test::Chance&) {}), testing::Each(""));
}

TEST_F(CaptureCauses, ExchangedFeaturesAreNamed) {
  for (const char* sensor : {"arm", "camera"}) {
    EXPECT_THAT(causes([&](Sample& sample, test::Chance&) {
                  std::swap(features(sample, sensor)[0].point, features(sample, sensor)[2].point);
                }),
                testing::Each("features 1 and 3 are exchanged"));
  }
}

TEST_F(CaptureCauses, AFeatureThatShowsAnotherIsNamed) {
  EXPECT_THAT(causes([](Sample& sample, test::Chance&) {
                features(sample, "camera")[1].point = features(sample, "camera")[3].point;
              }),
              testing::Each("feature 2 shows feature 4"));
}

TEST_F(CaptureCauses, ABoardThatIsTurnedIsNamed) {
  EXPECT_THAT(causes([](Sample& sample, test::Chance&) {
                std::reverse(features(sample, "arm").begin(), features(sample, "arm").end());
              }),
              testing::Each(HasSubstr("a board turned by 180 degrees?")));
  EXPECT_THAT(causes([](Sample& sample, test::Chance&) {
                std::vector<Feature>& all = features(sample, "arm");
                all = {all[1], all[3], all[0], all[2]};
              }),
              testing::Each(HasSubstr("a board turned by 90 degrees?")));
}

/// The camera saw three of four features and lists them in another order.
TEST_F(CaptureCauses, FeaturesAreNamedByTheirIds) {
  const auto number = [](Sample& sample) {
    for (const char* sensor : {"arm", "camera"}) {
      std::vector<Feature>& all = features(sample, sensor);
      for (std::size_t i = 0; i < all.size(); ++i) all[i].id = 10 + static_cast<int>(i);
    }
  };
  const auto take_part = [](Sample& sample) {
    std::vector<Feature>& camera = features(sample, "camera");
    camera = {camera[3], camera[2], camera[1]};
  };
  EXPECT_THAT(causes([&](Sample& sample, test::Chance&) {
                number(sample);
                std::swap(features(sample, "camera")[1].point, features(sample, "camera")[3].point);
                take_part(sample);
              }),
              testing::Each("the features with ids 11 and 13 are exchanged"));
  EXPECT_THAT(causes([&](Sample& sample, test::Chance&) {
                number(sample);
                features(sample, "camera")[2].point = features(sample, "camera")[3].point;
                take_part(sample);
              }),
              testing::Each("the feature with id 12 shows the feature with id 13"));
  EXPECT_THAT(causes([&](Sample& sample, test::Chance&) {
                number(sample);
                take_part(sample);
              }),
              testing::Each(""));
}

TEST_F(CaptureCauses, TheReadingOfOneJointIsNamedWithItsSign) {
  const double degree = std::numbers::pi / 180.0;
  for (const char* joint : {"shoulder_pan", "shoulder_lift", "elbow", "wrist", "head_tilt"}) {
    for (const double error : {4.9, -4.9, 40.0}) {
      const std::vector<std::string> found =
          causes([&](Sample& sample, test::Chance&) { position(sample, joint) -= error * degree; });
      const std::string expected = std::string("'") + joint + "' reads ";
      const auto named = std::count_if(found.begin(), found.end(), [&](const std::string& text) {
        return text.starts_with(expected) && text.find(error > 0.0 ? "less" : "more") < 60;
      });
      EXPECT_EQ(named, kSpoilt) << joint << " " << error << ", such as " << found[0];
    }
  }
  EXPECT_THAT(causes([&](Sample& sample, test::Chance&) { position(sample, "elbow") -= 0.0855; }),
              testing::Each(testing::ContainsRegex("'elbow' reads [45]\\.?[0-9]* deg less than the "
                                                   "others say")));
}

TEST_F(CaptureCauses, ARobotThatMovedIsNamed) {
  EXPECT_THAT(causes([](Sample& sample, test::Chance& chance) {
                for (double& q : sample.joint_positions) q += chance(0.01, 0.04);
              }),
              testing::Each(StartsWith("all its features are off alike: the robot was still")));
}

TEST_F(CaptureCauses, NoneIsNamedForFeaturesThatAreOffByChance) {
  const auto off = [](Feature& feature, test::Chance& chance) {
    feature.point +=
        0.05 * Vector3<double>(chance.normal(), chance.normal(), chance.normal()).normalized();
  };
  EXPECT_THAT(causes([&](Sample& sample, test::Chance& chance) {
                off(features(sample, "arm")[2], chance);
              }),
              testing::Each(""));
  EXPECT_THAT(causes([&](Sample& sample, test::Chance& chance) {
                for (const std::size_t i : {0u, 3u}) off(features(sample, "arm")[i], chance);
              }),
              testing::Each(""));
  EXPECT_THAT(causes([&](Sample& sample, test::Chance& chance) {
                for (Feature& feature : features(sample, "arm")) off(feature, chance);
              }),
              testing::Each(""));
}

/// Of one or two features too little can be tested.
TEST_F(CaptureCauses, NoneIsNamedForTooFewFeatures) {
  for (const std::size_t count : {1u, 2u}) {
    EXPECT_THAT(causes([&](Sample& sample, test::Chance&) {
                  for (Observation& seen : sample.observations) seen.features.resize(count);
                  position(sample, "elbow") += 0.1;
                }),
                testing::Each(""));
  }
}

TEST_F(CaptureCauses, ASampleThatCannotBeEvaluatedHasNone) {
  Sample sample = others_[0];
  sample.joint_names.pop_back();
  EXPECT_EQ(cause(sample), "");
}

/// Pixels: a board of 7 x 5 corners that a camera sees.
class CaptureCausesOfABoard : public testing::Test {
 protected:
  void SetUp() override {
    bad_ = scenario_.samples.back();
    scenario_.samples.pop_back();
    calibration_ = scenario_.calibration();
    const CalibrationResult result = calibrate(calibration_);
    ASSERT_TRUE(result.converged);
    values_ = result.table.values();
    noise_ = assess(calibration_, result, scenario_.samples)[0].noise;
  }
  [[nodiscard]] std::string cause() const {
    return capture_cause(*calibration_.steps[0].problem, test::NoisyScene::span(values_), noise_,
                         bad_);
  }
  std::vector<Feature>& pixels() { return bad_.observations[1].features; }

  test::Scenario scenario_ = test::board_scenario(true, 3, 13);
  Sample bad_;
  Calibration calibration_;
  Eigen::VectorXd values_;
  std::vector<BlockNoise> noise_;
};

TEST_F(CaptureCausesOfABoard, AreRecognised) {
  EXPECT_EQ(cause(), "");
  const Sample good = bad_;
  std::reverse(pixels().begin(), pixels().end());
  EXPECT_THAT(cause(), HasSubstr("a board turned by 180 degrees?"));
  bad_ = good;
  std::swap(pixels()[3], pixels()[20]);
  EXPECT_EQ(cause(), "features 4 and 21 are exchanged");
  bad_ = good;
  bad_.joint_positions[4] += 0.05;
  EXPECT_THAT(cause(), StartsWith("'turn_y' reads 2.8"));
  bad_ = good;
  for (double& q : bad_.joint_positions) q += 0.02;
  EXPECT_THAT(cause(), StartsWith("all its features are off alike"));
  bad_ = good;
  pixels()[7].point.x() += 15.0;
  EXPECT_EQ(cause(), "");
  bad_ = good;
  for (std::size_t i = 0; i < 12; ++i) pixels()[i].point.y() += 4.0 * static_cast<double>(i % 5);
  EXPECT_EQ(cause(), "");
}

}  // namespace
}  // namespace kinecal
