// Copies of samples, and samples that contradict each other.
#include "kinecal/io/doubts/repeated_samples.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/arm_scene.hpp"

namespace kinecal {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

class RepeatedSamples : public test::ArmScene {};

TEST_F(RepeatedSamples, OneSampleManyTimesIsAnError) {
  for (std::size_t i = 1; i < samples.size(); ++i) {
    samples[i] = samples[0];
    samples[i].source = "s.yaml:" + std::to_string(i);
  }
  EXPECT_THAT(found().errors, ElementsAre(HasSubstr("all 30 samples are the same one")));
}

TEST_F(RepeatedSamples, SomeCopiesAreADoubtAndAFewAWarning) {
  samples.push_back(samples[4]);
  samples.back().source = "more.yaml:1";
  const Diagnostics some = found();
  EXPECT_THAT(some.errors, IsEmpty());
  EXPECT_THAT(some.doubts,
              ElementsAre(AllOf(HasSubstr("more.yaml:1: the sample is a copy of that at s.yaml:41"),
                                HasSubstr("remove them"))));
  const auto more = test::arm_samples(parse_urdf(urdf, "arm.urdf"), 100);
  samples = more;
  samples.push_back(more[4]);
  const Diagnostics few = found();
  EXPECT_THAT(few.doubts, IsEmpty());
  EXPECT_THAT(few.warnings, ElementsAre(HasSubstr("is a copy")));
}

TEST_F(RepeatedSamples, NoiseAtOnePoseIsRight) {
  samples.push_back(samples[4]);
  samples.back().observations[1].features[0].point.x() += 2e-4;
  EXPECT_THAT(found().doubts, IsEmpty());
}

TEST_F(RepeatedSamples, AnotherPointAtOnePoseIsADoubt) {
  samples.push_back(samples[4]);
  samples.back().source = "more.yaml:1";
  samples.back().observations[1].features[0].point.x() += 0.02;
  EXPECT_THAT(
      found().doubts,
      ElementsAre(AllOf(HasSubstr("more.yaml:1: the joint positions are those of s.yaml:41"),
                        HasSubstr("sensor 'tracker'"))));
  samples.back().observations[0].features[0].point.x() += 0.02;  // another target
  samples.back().observations[0].features[1].point.x() += 0.02;
  EXPECT_THAT(found().doubts, IsEmpty());
}

}  // namespace
}  // namespace kinecal
