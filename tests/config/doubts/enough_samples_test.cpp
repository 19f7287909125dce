// Samples against parameters, and observations that are not used.
#include "kinecal/config/doubts/enough_samples.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "support/arm_scene.hpp"

namespace kinecal {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

/// The configuration has 10 free parameters, a sample six residuals.
class EnoughSamples : public test::ArmScene {};

TEST_F(EnoughSamples, FewerResidualsThanParametersAreAnErrorWithBothNumbers) {
  samples.resize(2);
  EXPECT_THAT(found().errors, ElementsAre(AllOf(HasSubstr("c.yaml"),
                                                HasSubstr("has 10 free parameters, 2 different "
                                                          "samples give only 12 residuals"))));
  samples.resize(1);
  EXPECT_THAT(found().errors, ElementsAre(HasSubstr("1 different sample gives only 6 residuals")));
}

TEST_F(EnoughSamples, LessThanTwoForEachParameterAreADoubt) {
  samples.resize(3);
  EXPECT_THAT(found().errors, IsEmpty());
  EXPECT_THAT(found().doubts, ElementsAre(HasSubstr("less than two for each parameter")));
  samples = test::arm_samples(parse_urdf(urdf, "arm.urdf"), 4);
  EXPECT_THAT(found().doubts, IsEmpty());
}

TEST_F(EnoughSamples, CopiesDoNotCount) {
  samples.resize(2);
  for (int i = 0; i < 10; ++i) samples.push_back(samples[1]);
  EXPECT_THAT(found().errors, ElementsAre(HasSubstr("2 different samples give only 12 residuals")));
}

TEST_F(EnoughSamples, ManyFeaturesOfFewPosesAreADoubt) {
  samples.resize(3);
  for (Sample& sample : samples) {
    for (Observation& seen : sample.observations) {
      const std::vector<Feature> once = seen.features;
      for (int i = 0; i < 9; ++i)
        seen.features.insert(seen.features.end(), once.begin(), once.end());
    }
  }
  EXPECT_THAT(found().errors, IsEmpty());
  EXPECT_THAT(found().doubts, ElementsAre(HasSubstr("a pose only has six numbers")));
  samples.resize(2);  // nearly as many parameters as numbers
  EXPECT_THAT(found().errors, ElementsAre(HasSubstr("a pose only has six numbers")));
}

TEST_F(EnoughSamples, AnObservationWithoutFeaturesIsAWarning) {
  for (Feature& feature : samples[3].observations[1].features) {
    feature.point.x() = std::numeric_limits<double>::quiet_NaN();
  }
  samples[5].observations[1].features.clear();
  const Diagnostics diagnostics = found();
  EXPECT_THAT(diagnostics.errors, IsEmpty());
  EXPECT_THAT(diagnostics.doubts, IsEmpty());
  EXPECT_THAT(
      diagnostics.warnings,
      ElementsAre("s.yaml:31: sensor 'tracker' has no usable feature, so its observation is "
                  "left out (and in 1 more sample)",
                  AllOf(HasSubstr("s.yaml:31: no error block uses the sample"),
                        HasSubstr("1 more sample"))));
}

}  // namespace
}  // namespace kinecal
