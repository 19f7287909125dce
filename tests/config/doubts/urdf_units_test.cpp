// Lengths and angles in a URDF.
#include "kinecal/config/doubts/urdf_units.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/arm_scene.hpp"

namespace kinecal {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

class UrdfUnits : public test::ArmScene {};

TEST_F(UrdfUnits, MillimetresAreAnError) {
  replace(urdf, "0.1 0 0.2", "100 0 200");
  replace(urdf, "0.4 0 0", "400 0 0");
  EXPECT_THAT(found().errors, ElementsAre(AllOf(HasSubstr("arm.urdf:15: origin of joint 'elbow'"),
                                                HasSubstr("400 m long (and 1 more like it)"),
                                                HasSubstr("millimetres"))));
}

TEST_F(UrdfUnits, OneLongLinkIsADoubt) {
  replace(urdf, "0.4 0 0", "40 0 0");
  const Diagnostics diagnostics = found();
  EXPECT_THAT(diagnostics.errors, IsEmpty());
  EXPECT_THAT(diagnostics.doubts, testing::Contains(HasSubstr("40 m long; is it in millimetres?")));
}

TEST_F(UrdfUnits, FarLinksThatNoModelNeedsAreRight) {
  replace(urdf, "<link name=\"tool\"/>",
          "<link name=\"tool\"/><joint name=\"world\" type=\"fixed\"><origin xyz=\"5e5 0 0\" "
          "rpy=\"0 0 90\"/><parent link=\"map\"/><child link=\"base_link\"/></joint>");
  replace(urdf, "<link name=\"base_link\"/>", "<link name=\"base_link\"/><link name=\"map\"/>");
  EXPECT_THAT(found().errors, IsEmpty());
  EXPECT_THAT(found().doubts, IsEmpty());
}

TEST_F(UrdfUnits, AThousandthIsAnError) {
  for (const char* xyz :
       {"0 0 0.3", "0.1 0 0.2", "0.4 0 0", "0.35 0 0.02", "0 0 0.1", "0.08 0 0.1"}) {
    replace(urdf, xyz, "0.0004 0 0");
  }
  EXPECT_THAT(found().errors,
              ElementsAre(HasSubstr("add up to 0.0024 m: are they in kilometres?")));
}

TEST_F(UrdfUnits, DegreesAreAnErrorAndTwoPiIsRight) {
  replace(urdf, "0 1.5707963267948966 0", "0 6.2832 0");
  EXPECT_THAT(found().errors, IsEmpty());
  replace(urdf, "0 6.2832 0", "0 90 0");
  EXPECT_THAT(found().errors,
              ElementsAre("arm.urdf:20: rpy of joint 'roll' has the angle 90; is it in degrees?  "
                          "Angles must be in radians"));
  replace(urdf, "0 90 0", "0 7.1234 0");
  EXPECT_THAT(found().errors, IsEmpty());
  EXPECT_THAT(found().doubts, testing::Contains(HasSubstr("7.1234")));
}

TEST_F(UrdfUnits, LimitsInDegreesAreADoubt) {
  replace(urdf, "lower=\"-2.9\" upper=\"2.9\"", "lower=\"-165\" upper=\"165\"");
  EXPECT_THAT(found().doubts, IsEmpty()) << "one of five may stand for no limit";
  replace(urdf, "lower=\"-1.2\" upper=\"1.4\"", "lower=\"-70\" upper=\"80\"");
  replace(urdf, "lower=\"0.6\" upper=\"2.6\"", "lower=\"35\" upper=\"150\"");
  EXPECT_THAT(found().doubts, ElementsAre(HasSubstr("limit of joint 'pan' is 165 rad (and 2 more "
                                                    "like it); is it in degrees?")));
}

TEST_F(UrdfUnits, LimitsTheWrongWayRoundAreNamed) {
  replace(urdf, "lower=\"-1.2\" upper=\"1.4\"", "lower=\"1.4\" upper=\"-1.2\"");
  EXPECT_THAT(found().warnings,
              ElementsAre(AllOf(HasSubstr("arm.urdf:11: the limits of joint 'lift' are not used"),
                                HasSubstr("lower 1.4 is above upper -1.2; are they exchanged?"))));
}

}  // namespace
}  // namespace kinecal
