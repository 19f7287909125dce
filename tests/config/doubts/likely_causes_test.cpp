// Mistakes that are found by undoing them.
#include "kinecal/config/doubts/likely_causes.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>
#include <random>

#include "support/arm_scene.hpp"

namespace kinecal {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

class LikelyCauses : public test::ArmScene {
 protected:
  [[nodiscard]] std::vector<std::string> causes() const {
    return likely_causes(config(), parse_urdf(urdf, "arm.urdf"), samples);
  }
  /// The first sentence.
  [[nodiscard]] std::string first() const {
    const auto all = causes();
    return all.empty() ? "" : all[0];
  }
};

TEST_F(LikelyCauses, ThereAreNoneForSamplesThatAreRight) {
  EXPECT_THAT(causes(), IsEmpty());
}

TEST_F(LikelyCauses, TwoJointsExchangedAreNamedWithBothResiduals) {
  for (Sample& sample : samples) std::swap(position(sample, "elbow"), position(sample, "roll"));
  EXPECT_THAT(first(), testing::ContainsRegex(
                           "^with the positions of 'elbow' and 'roll' exchanged, the mean residual "
                           "of 'measured' falls from [0-9.]+ mm to 0\\.[0-9]+ mm$"));
}

TEST_F(LikelyCauses, OneJointsSignIsNamed) {
  for (Sample& sample : samples) position(sample, "roll") *= -1.0;
  EXPECT_THAT(first(), HasSubstr("with the positions of 'roll' negated"));
}

TEST_F(LikelyCauses, DegreesAreNamed) {
  for (Sample& sample : samples) {
    for (double& q : sample.joint_positions) q *= 180.0 / std::numbers::pi;
  }
  EXPECT_THAT(first(), HasSubstr("with joint positions taken as degrees"));
}

TEST_F(LikelyCauses, MillimetresAreNamed) {
  for (Sample& sample : samples) {
    for (Feature& feature : sample.observations[1].features) feature.point *= 1000.0;
  }
  EXPECT_THAT(first(), HasSubstr("with the points of 'tracker' taken as millimetres"));
}

TEST_F(LikelyCauses, TheScaleOfPointsIsFound) {
  const auto good = samples;
  for (const double factor : {1.2, 0.7}) {
    samples = good;
    for (Sample& sample : samples) {
      for (Feature& feature : sample.observations[1].features) feature.point *= factor;
    }
    EXPECT_THAT(first(), HasSubstr("with the points of 'tracker' multiplied by " +
                                   std::string(factor > 1.0 ? "0.833" : "1.429")));
  }
}

TEST_F(LikelyCauses, AWrongScaleIsFoundInAFitThatIsNotBad) {
  const Robot robot = parse_urdf(urdf, "arm.urdf");
  const auto scales = [&] {
    Diagnostics diagnostics;
    const Calibration calibration = assemble(config(), robot, samples, diagnostics);
    const CalibrationResult result = calibrate(calibration);
    return wrong_scales(config(), robot, samples, result.table,
                        assess(calibration, result, samples).back());
  };
  EXPECT_THAT(scales(), IsEmpty());
  for (Sample& sample : samples) {
    for (Feature& feature : sample.observations[1].features) feature.point *= 1.03;
  }
  EXPECT_THAT(scales(),
              testing::Contains(HasSubstr("with the points of 'tracker' multiplied by 0.97")));
}

TEST_F(LikelyCauses, LengthsThatAreFreeDoNotShrinkWithThePoints) {
  replace(
      config_text, "free_frames:\n",
      "free_frames:\n - {name: lift, x: true, y: true, z: true}\n"
      " - {name: elbow, x: true, y: true, z: true}\n - {name: roll, x: true, y: true, z: true}\n"
      " - {name: flex, x: true, y: true, z: true}\n - {name: flange, x: true, y: true, z: true}\n");
  for (Sample& sample : samples) {
    for (Observation& seen : sample.observations) seen.features.resize(1);
    sample.observations[0].features[0].point.setZero();
  }
  EXPECT_THAT(causes(), IsEmpty());
}

TEST_F(LikelyCauses, AScaleThatFreeLengthsAbsorbIsNamedByTheirChange) {
  replace(
      config_text, "free_frames:\n",
      "free_frames:\n - {name: lift, x: true, y: true, z: true}\n"
      " - {name: elbow, x: true, y: true, z: true}\n - {name: roll, x: true, y: true, z: true}\n"
      " - {name: flex, x: true, y: true, z: true}\n - {name: flange, x: true, y: true, z: true}\n");
  std::mt19937 random(3);
  std::normal_distribution<double> noise(0.0, 1e-4);
  for (Sample& sample : samples) {
    for (Observation& seen : sample.observations) seen.features.resize(1);
    sample.observations[0].features[0].point.setZero();
    for (int k = 0; k < 3; ++k) sample.observations[1].features[0].point(k) += noise(random);
  }
  const Robot robot = parse_urdf(urdf, "arm.urdf");
  const auto scales = [&](const std::vector<Sample>& measured) {
    Diagnostics diagnostics;
    const Calibration calibration = assemble(config(), robot, measured, diagnostics);
    const CalibrationResult result = calibrate(calibration);
    return wrong_scales(config(), robot, measured, result.table,
                        assess(calibration, result, measured).back());
  };
  EXPECT_THAT(scales(samples), IsEmpty());
  for (Sample& sample : samples) sample.observations[1].features[0].point *= 1.1;
  EXPECT_THAT(
      scales(samples),
      testing::ElementsAre(testing::ContainsRegex(
          "with the points of 'tracker' multiplied by 0\\.9[01][0-9]*, the lengths of the robot "
          "change by [0-9.]+ mm \\(RMS\\) in place of [0-9.]+ mm")));
}

TEST_F(LikelyCauses, AxesOfPointsAreNamed) {
  for (Sample& sample : samples) {
    for (Feature& feature : sample.observations[1].features) feature.point.y() *= -1.0;
  }
  EXPECT_THAT(first(), HasSubstr("with the points of 'tracker' mirrored"));
}

TEST_F(LikelyCauses, FeaturesInReverseOrderAreNamed) {
  for (Sample& sample : samples) {
    std::swap(sample.observations[1].features[0].point, sample.observations[1].features[1].point);
  }
  EXPECT_THAT(first(), HasSubstr("in reverse order"));
  for (Sample& sample : samples) {
    for (Observation& seen : sample.observations) {
      for (std::size_t i = 0; i < seen.features.size(); ++i) {
        seen.features[i].id = static_cast<int>(i);
      }
    }
  }
  EXPECT_THAT(first(), HasSubstr("in reverse order")) << "the ids are wrong";
}

TEST_F(LikelyCauses, NamesInTheOrderOfTheAlphabetAreNamed) {
  for (Sample& sample : samples) {
    std::sort(sample.joint_names.begin(), sample.joint_names.end());  // positions stay as they are
  }
  EXPECT_THAT(first(), HasSubstr("in the order of the chain, names being alphabetical"));
}

TEST_F(LikelyCauses, FramesOfModelsExchangedAreNamed) {
  replace(config_text, "frame: tool", "frame: other");
  replace(config_text, "frame: base_link", "frame: tool");
  replace(config_text, "frame: other", "frame: base_link");
  for (Sample& sample : samples) {
    for (Feature& feature : sample.observations[0].features) feature.frame.clear();
  }
  EXPECT_THAT(first(), HasSubstr("with the frames of the models 'arm' and 'tracker' exchanged"));
}

TEST_F(LikelyCauses, WhereNothingIsSolvedOnlyWhatFitsIsNamed) {
  const auto causes_if_unsolved = [&] {
    int calls = 0;  // the first is that of the samples as they are
    return likely_causes(config(), parse_urdf(urdf, "arm.urdf"), samples,
                         [&](const Calibration& calibration) {
                           return ++calls == 1 ? CalibrationResult{} : calibrate(calibration);
                         });
  };
  EXPECT_THAT(causes_if_unsolved(), testing::Each(HasSubstr("turned from the axes of a link")))
      << "all can be solved, but only this fits: the free frame of the tracker absorbs it";
  for (Sample& sample : samples) position(sample, "roll") *= -1.0;
  EXPECT_THAT(causes_if_unsolved(),
              testing::ElementsAre(testing::ContainsRegex(
                  "^with the positions of 'roll' negated, the samples can be solved, and the mean "
                  "residual of 'measured' is 0\\.[0-9]+ mm$")));
}

TEST_F(LikelyCauses, AreSolvedWithTheGivenFunction) {
  int calls = 0;
  (void)likely_causes(config(), parse_urdf(urdf, "arm.urdf"), samples,
                      [&](const Calibration& calibration) {
                        ++calls;
                        return calibrate(calibration);
                      });
  EXPECT_GT(calls, 15) << "5 signs and 10 pairs";
}

}  // namespace
}  // namespace kinecal
