#include "kinecal/config/doubts/measured_poses.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

namespace kinecal {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

/// The doubts about poses with these rotations.
std::vector<std::string> doubts(const std::vector<Vector3<double>>& rotations) {
  const Robot robot("r", {{"flange_joint", JointType::floating, "base", "flange", {}}});
  Config config;
  config.base_link = "base";
  ModelConfig model;
  model.name = "arm";
  model.frame = "flange";
  config.steps.emplace_back().models = {model};
  std::vector<Sample> samples;
  const Matrix3<double> first = exp(Vector3<double>(0.4, -1.0, 0.7));
  for (const Vector3<double>& rotation : rotations) {
    Sample& sample = samples.emplace_back();
    sample.source = "samples.yaml:1";
    sample.poses["flange_joint"].rotation = first * exp(rotation);
  }
  Diagnostics diagnostics;
  detail::check_measured_poses(config, robot, samples, diagnostics);
  EXPECT_THAT(diagnostics.errors, IsEmpty());
  return diagnostics.doubts;
}

TEST(MeasuredPoses, TurnsAboutTwoAxesAreEnough) {
  EXPECT_THAT(doubts({{0, 0, 0}, {0.3, 0, 0}, {0, 0.3, 0}}), IsEmpty());
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  std::vector<Vector3<double>> many;
  for (int i = 0; i < 20; ++i) many.push_back({normal(random), normal(random), normal(random)});
  EXPECT_THAT(doubts(many), IsEmpty());
}

TEST(MeasuredPoses, TurnsAboutOneAxisNameTheAxis) {
  const Vector3<double> axis = Vector3<double>(3, 0, -4) / 5.0;
  EXPECT_THAT(
      doubts({axis * 0.0, axis * 0.5, axis * -1.2, axis * 2.0}),
      ElementsAre(HasSubstr("samples.yaml:1: the poses of 'flange_joint' all turn about one "
                            "axis, (-0.60, 0.00, 0.80) in 'flange'")));
}

TEST(MeasuredPoses, PosesThatOnlySlideDoNotTurn) {
  EXPECT_THAT(doubts({{0, 0, 0}, {1e-3, 0, 0}, {0, 1e-3, 0}}),
              ElementsAre(HasSubstr("the poses of 'flange_joint' do not turn")));
}

}  // namespace
}  // namespace kinecal
