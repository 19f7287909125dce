// Which photographs to take next.
#include "kinecal/config/cameras/next_photographs.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/photographs.hpp"

namespace kinecal {
namespace {

using test::Photographs;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

TEST(NextPhotographs, AreNoneWhenNothingIsLacking) {
  const Photographs many(test::distorted_camera(), "plumb_bob", {.views = 40, .aside = 0.6});
  EXPECT_THAT(next_photographs(many.samples), IsEmpty());
  EXPECT_THAT(next_photographs({}), IsEmpty());
}

TEST(NextPhotographs, NameRegionsWithoutFeatures) {
  Photographs left(test::distorted_camera(), "plumb_bob", {.views = 40, .aside = 0.6});
  std::erase_if(left.samples, [](const Sample& sample) {
    const auto& features = sample.observations[1].features;
    return std::any_of(features.begin(), features.end(),
                       [](const Feature& feature) { return feature.point.x() > 850.0; });
  });
  ASSERT_THAT(left.samples, Not(IsEmpty()));
  EXPECT_THAT(
      next_photographs(left.samples),
      ElementsAre("for the lens of 'camera': hold the target at the upper right, the right and "
                  "the lower right of its image: no feature was there"));
}

TEST(NextPhotographs, NameTiltAndDistance) {
  Photographs flat(test::distorted_camera(), "plumb_bob", {.views = 1});
  const auto eye = any_built_in(lens_camera("plumb_bob"));
  Sample& sample = flat.samples.front();
  for (std::size_t i = 0; i < sample.observations[1].features.size(); ++i) {
    const Vector3<double> p = sample.observations[0].features[i].point + Vector3<double>(0, 0, 0.5);
    sample.observations[1].features[i].point.head<2>() =
        eye->predict(p, eye->settings(sample.observations[1]));
  }
  EXPECT_THAT(next_photographs(flat.samples),
              ElementsAre(AllOf(HasSubstr("tilt the target"), HasSubstr("nearer and farther"))));
}

}  // namespace
}  // namespace kinecal
