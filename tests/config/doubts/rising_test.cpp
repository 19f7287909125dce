// An earlier calibration in the URDF, and samples from before or after it.
#include "kinecal/config/doubts/rising.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/arm_scene.hpp"

namespace kinecal {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

/// The URDF holds what arm_samples() have as true offsets.
class Rising : public test::ArmScene {
 protected:
  Rising() {
    replace(urdf, "<parent link=\"l1\"/>", "<calibration rising=\"0.02\"/><parent link=\"l1\"/>");
    replace(urdf, "<parent link=\"l2\"/>", "<calibration rising=\"-0.03\"/><parent link=\"l2\"/>");
  }
};

TEST_F(Rising, IsReadByJointAndAddedToPositions) {
  const auto rising = rising_of(urdf, "arm.urdf");
  EXPECT_THAT(rising, ElementsAre(testing::Pair("elbow", -0.03), testing::Pair("lift", 0.02)));
  const double lift = position(samples[2], "lift"), pan = position(samples[2], "pan");
  add_rising(rising, samples);
  EXPECT_DOUBLE_EQ(position(samples[2], "lift"), lift + 0.02);
  EXPECT_DOUBLE_EQ(position(samples[2], "pan"), pan);
  add_rising(rising, samples, -1.0);
  EXPECT_DOUBLE_EQ(position(samples[2], "lift"), lift);
  EXPECT_THROW(
      (void)rising_of("<robot><joint name=\"a\"><calibration rising=\"x\"/></joint></robot>",
                      "arm.urdf"),
      InputError);
}

TEST_F(Rising, SamplesFromBeforeItAreADoubtWithBothResiduals) {
  const Diagnostics diagnostics = found();
  EXPECT_THAT(diagnostics.errors, IsEmpty());
  EXPECT_THAT(diagnostics.warnings,
              ElementsAre(AllOf(HasSubstr("arm.urdf:15: joint 'elbow' has <calibration "
                                          "rising=\"-0.03\"> (and 1 more"),
                                HasSubstr("--samples-recorded before"))));
  ASSERT_EQ(diagnostics.doubts.size(), 1u);
  EXPECT_THAT(diagnostics.doubts[0],
              AllOf(HasSubstr("look recorded before <calibration rising> was written"),
                    testing::ContainsRegex("mean residual is 0\\.[0-9]+ mm, against [0-9.]+ mm")));
}

TEST_F(Rising, SamplesFromBeforeItAreRightWithTheOption) {
  recorded = Recorded::before;
  add_rising(rising_of(urdf, "arm.urdf"), samples);
  const Diagnostics diagnostics = found();
  EXPECT_THAT(diagnostics.errors, IsEmpty());
  EXPECT_THAT(diagnostics.doubts, IsEmpty());
  EXPECT_THAT(diagnostics.warnings, testing::Each(testing::Not(HasSubstr("rising"))));
}

TEST_F(Rising, SamplesFromAfterItAreRightWithoutTheOption) {
  add_rising(rising_of(urdf, "arm.urdf"), samples);
  EXPECT_THAT(found().doubts, IsEmpty());
}

TEST_F(Rising, SamplesFromAfterItAreADoubtWithTheOption) {
  add_rising(rising_of(urdf, "arm.urdf"), samples, 2.0);
  recorded = Recorded::before;
  EXPECT_THAT(found().doubts, ElementsAre(HasSubstr("look recorded after <calibration rising>")));
}

TEST_F(Rising, OfJointsThatNoModelNeedsDoesNotMatter) {
  urdf = test::kArmUrdf;
  replace(
      urdf, "<link name=\"tool\"/>",
      "<link name=\"tool\"/><link name=\"f\"/><joint name=\"finger\" type=\"prismatic\"><parent "
      "link=\"tool\"/><child link=\"f\"/><calibration rising=\"0.01\"/><limit lower=\"0\" "
      "upper=\"0.1\" effort=\"1\" velocity=\"1\"/></joint>");
  EXPECT_THAT(found().warnings, IsEmpty());
}

}  // namespace
}  // namespace kinecal
