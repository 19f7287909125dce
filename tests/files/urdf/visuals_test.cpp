// SPDX-License-Identifier: Apache-2.0
#include "kinecal/files/urdf/visuals.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace kinecal {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

std::vector<Visual> read(const std::string& content, Diagnostics& diagnostics) {
  return visuals("<robot name=\"r\">\n" + content + "</robot>", "r.urdf", diagnostics);
}

/// The only warning about a link with this geometry.
std::string warning_about(const std::string& geometry) {
  Diagnostics diagnostics;
  const auto all =
      read("<link name=\"arm\">\n<visual><geometry>" + geometry +
               "</geometry></visual><visual><geometry><sphere radius=\"1\"/></geometry>"
               "</visual></link>",
           diagnostics);
  EXPECT_THAT(all, SizeIs(1)) << "the other one is drawn";
  EXPECT_THAT(diagnostics.warnings, SizeIs(1));
  return diagnostics.warnings.empty() ? "" : diagnostics.warnings[0];
}

TEST(Visuals, HaveShapePlaceAndColor) {
  Diagnostics diagnostics;
  const auto all = read(R"(
  <material name="red"><color rgba="1 0 0 0.5"/></material>
  <link name="base">
    <visual>
      <origin xyz="0.1 0.2 0.3" rpy="0 0 1.5707963267948966"/>
      <geometry><box size="1 2 3"/></geometry>
      <material name="red"/>
    </visual>
    <visual><geometry><cylinder radius="0.1" length="0.5"/></geometry>
      <material name="own"><color rgba="0 2 0 1"/></material></visual>
    <collision><geometry><box size="9 9 9"/></geometry></collision>
  </link>
  <link name="tip"><visual><geometry>
    <mesh filename="package://p/a.dae" scale="0.001 0.001 -0.001"/></geometry></visual></link>
  <link name="bare"/>
)",
                        diagnostics);
  EXPECT_THAT(diagnostics.warnings, IsEmpty());
  ASSERT_THAT(all, SizeIs(3));
  EXPECT_EQ(all[0].link, "base");
  EXPECT_EQ(all[0].shape, VisualShape::box);
  EXPECT_THAT(all[0].size, ElementsAre(1.0, 2.0, 3.0));
  EXPECT_THAT(all[0].color, ElementsAre(1.0, 0.0, 0.0, 0.5));
  const Vector3<double> moved = all[0].link_T_visual * Vector3<double>(1.0, 0.0, 0.0);
  EXPECT_NEAR((moved - Vector3<double>(0.1, 1.2, 0.3)).norm(), 0.0, 1e-12);
  EXPECT_EQ(all[1].shape, VisualShape::cylinder);
  EXPECT_EQ(all[1].radius, 0.1);
  EXPECT_EQ(all[1].length, 0.5);
  EXPECT_THAT(all[1].color, ElementsAre(0.0, 1.0, 0.0, 1.0)) << "brighter than bright is bright";
  EXPECT_EQ(all[2].link, "tip");
  EXPECT_EQ(all[2].mesh, "package://p/a.dae");
  EXPECT_THAT(all[2].scale, ElementsAre(0.001, 0.001, -0.001));
}

TEST(Visuals, ThatCannotBeDrawnAreLeftOutWithAWarning) {
  EXPECT_THAT(warning_about("<box size=\"1 nan 1\"/>"), HasSubstr("r.urdf:3: link 'arm'"));
  EXPECT_THAT(warning_about("<box size=\"1 2\"/>"), HasSubstr("is not 3 numbers"));
  EXPECT_THAT(warning_about("<box/>"), HasSubstr("has no size"));
  EXPECT_THAT(warning_about("<sphere radius=\"-1\"/>"), HasSubstr("must be positive"));
  EXPECT_THAT(warning_about("<cylinder radius=\"1\" length=\"0\"/>"), HasSubstr("length"));
  EXPECT_THAT(warning_about("<mesh/>"), HasSubstr("no filename"));
  EXPECT_THAT(warning_about("<mesh filename=\"a\" scale=\"1 0 1\"/>"), HasSubstr("zero"));
  EXPECT_THAT(warning_about("<capsule radius=\"1\"/>"), HasSubstr("no box"));
  EXPECT_THAT(warning_about("<box size=\"1e999 1 1\"/>"), HasSubstr("is not 3 numbers"));
}

TEST(Visuals, KeepTheirShapeIfTheirColorIsWrong) {
  Diagnostics diagnostics;
  const auto all = read(R"(<link name="a"><visual><geometry><sphere radius="1"/></geometry>
    <material name="x"><color rgba="red"/></material></visual></link>)",
                        diagnostics);
  ASSERT_THAT(all, SizeIs(1));
  EXPECT_THAT(all[0].color, ElementsAre(0.7, 0.7, 0.7, 1.0));
  EXPECT_THAT(diagnostics.warnings, IsEmpty());
}

TEST(Visuals, OfATextThatIsNoUrdfAreAnError) {
  Diagnostics diagnostics;
  EXPECT_THROW((void)visuals("<robot>", "r.urdf", diagnostics), InputError);
}

}  // namespace
}  // namespace kinecal
