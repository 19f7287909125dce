// Copies of samples, and samples that contradict each other.
#include "kinecal/config/doubts/repeated_samples.hpp"

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

TEST_F(RepeatedSamples, ACopyThatWasPrintedWithFewerDigitsIsOne) {
  samples.push_back(samples[4]);
  for (Feature& feature : samples.back().observations[1].features) feature.point.x() += 1e-9;
  EXPECT_THAT(found().doubts, ElementsAre(HasSubstr("is a copy")));
}

TEST_F(RepeatedSamples, TheFirstOfTheFileIsNamed) {
  for (const std::size_t i : {9, 2, 5}) {
    samples.push_back(samples[i]);
    samples.back().source = "copy_of_" + std::to_string(i);
  }
  EXPECT_THAT(found().doubts, ElementsAre(HasSubstr(
                                  "copy_of_9: the sample is a copy of that at s.yaml:91 (and in 2 "
                                  "more samples)")));
}

/// So many samples of one pose take little time: pairs are not compared.
TEST_F(RepeatedSamples, EachIsComparedWithTheFirstOfItsPoseAndNoOther) {
  for (const double off : {0.003, -0.003, 0.0028, -0.0028}) {  // of the first: within 5 mm
    samples.push_back(samples[4]);
    samples.back().observations[1].features[0].point.x() += off;
  }
  EXPECT_THAT(found().doubts, IsEmpty()) << "6 mm between two that follow";
  samples.push_back(samples[4]);
  samples.back().source = "more.yaml:1";
  samples.back().observations[1].features[0].point.x() += 0.006;  // 3 mm beside another one
  EXPECT_THAT(found().doubts,
              ElementsAre(HasSubstr("more.yaml:1: the joint positions are those of s.yaml:41")));
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

TEST_F(RepeatedSamples, FeaturesAreComparedByTheirIds) {
  for (Sample& sample : samples) {
    for (Observation& seen : sample.observations) {
      for (std::size_t i = 0; i < seen.features.size(); ++i) {
        seen.features[i].id = static_cast<int>(i);
      }
    }
  }
  samples.push_back(samples[4]);
  samples.back().source = "more.yaml:1";
  for (Observation& seen : samples.back().observations) {
    std::reverse(seen.features.begin(), seen.features.end());
  }
  EXPECT_THAT(found().doubts, IsEmpty());
  samples.back().observations[1].features[0].point.x() += 0.02;
  EXPECT_THAT(found().doubts, ElementsAre(HasSubstr("sensor 'tracker'")));
  samples.back().observations[1].features[0].id = 50;  // another one
  EXPECT_THAT(found().doubts, IsEmpty());
}

}  // namespace
}  // namespace kinecal
