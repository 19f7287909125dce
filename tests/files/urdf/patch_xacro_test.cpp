#include "kinecal/files/urdf/patch_xacro.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "kinecal/files/urdf/patch_urdf.hpp"
#include "kinecal/files/urdf/read_urdf.hpp"

namespace kinecal {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;

/// What xacro makes of kXacro with prefix:=left_.
constexpr const char* kUrdf = R"(<robot name="arm">
  <link name="l0"/><link name="l1"/><link name="l2"/><link name="l3"/><link name="l4"/>
  <joint name="left_pan" type="revolute">
    <origin xyz="0 0 0.1" rpy="0 0 0"/><parent link="l0"/><child link="l1"/><axis xyz="0 0 1"/>
    <limit lower="-2" upper="2" effort="1" velocity="1"/>
  </joint>
  <joint name="left_lift" type="continuous">
    <origin xyz="0 0 0.25" rpy="0 0 0"/><parent link="l1"/><child link="l2"/><axis xyz="0 1 0"/>
  </joint>
  <joint name="finger_1" type="fixed">
    <origin xyz="0 0.5 0" rpy="0 0 0"/><parent link="l2"/><child link="l3"/>
  </joint>
  <joint name="finger_2" type="fixed">
    <origin xyz="0 0.5 0" rpy="0 0 0"/><parent link="l2"/><child link="l4"/>
  </joint>
</robot>
)";

constexpr const char* kXacro = R"(<?xml version="1.0"?>
<!-- pan: xyz="0 0 0.1" -->
<robot name="arm" xmlns:xacro="http://www.ros.org/wiki/xacro">
  <xacro:arg name="prefix" default=""/>
  <xacro:property name="height" value="0.25"/>
  <xacro:if value="true">
    <joint name="$(arg prefix)pan" type="revolute">
      <origin xyz="0 0   0.10" rpy="0 0 0" />  <!-- literal -->
      <parent link="l0"/><child link="l1"/><axis xyz="0 0 1"/>
      <limit lower="${-2}" upper="2.0" effort="1" velocity="1"/>
    </joint>
  </xacro:if>
  <joint name="${prefix}lift" type="continuous">
    <origin xyz="0 0 ${height}" rpy="0 0 0"/>
    <parent link="l1"/><child link="l2"/><axis xyz="0 1 0"/>
  </joint>
  <xacro:macro name="finger" params="i">
    <joint name="finger_${i}" type="fixed"><origin xyz="0 0.5 0" rpy="0 0 0"/>
      <parent link="l2"/><child link="l${i + 2}"/></joint>
  </xacro:macro>
  <xacro:finger i="1"/><xacro:finger i="2"/>
  <ros2_control name="c" type="system"><joint name="$(arg prefix)pan"/></ros2_control>
</robot>
)";

std::string calibrated(const std::vector<JointPatch>& patches,
                       OffsetStyle style = OffsetStyle::origin) {
  return patch_urdf(kUrdf, "arm.urdf", parse_urdf(kUrdf, "arm.urdf"), patches, style);
}

XacroPatch patched(const std::vector<JointPatch>& patches,
                   OffsetStyle style = OffsetStyle::origin) {
  return patch_xacro({{"arm.xacro", kXacro}}, kUrdf, calibrated(patches, style));
}

JointPatch shifted(const std::string& joint, double z) {
  JointPatch patch{joint, 0.0, {}};
  patch.correction.translation.z() = z;
  return patch;
}

std::string with(std::string text, const std::string& old, const std::string& replaced) {
  return text.replace(text.find(old), old.size(), replaced);
}

TEST(PatchXacro, LiteralsAreReplacedAndAllElseStays) {
  const XacroPatch patch = patched({shifted("left_pan", 0.5)});
  EXPECT_EQ(patch.files[0].text, with(kXacro, "0 0   0.10", "0 0   0.6"));
  EXPECT_THAT(patch.files[0].patched, ElementsAre("left_pan"));
  EXPECT_THAT(patch.unpatched, IsEmpty());
}

TEST(PatchXacro, ExpressionsAreNamedWithTheirLineAndNewValue) {
  const XacroPatch patch = patched({shifted("left_lift", 0.5)});
  EXPECT_EQ(patch.files[0].text, kXacro);
  EXPECT_THAT(patch.files[0].patched, IsEmpty());
  EXPECT_THAT(
      patch.unpatched,
      ElementsAre("arm.xacro:14: joint 'left_lift': xyz=\"0 0 ${height}\" is an expression; "
                  "it should become xyz=\"0 0 0.75\" of <origin>"));
}

TEST(PatchXacro, AJointWithBothGetsTheLiteralsAndTheRestIsNamed) {
  const XacroPatch patch = patched({{"left_pan", 0.25, {}}});
  EXPECT_EQ(patch.files[0].text, with(with(kXacro, "rpy=\"0 0 0\"", "rpy=\"0 0 0.25\""),
                                      "upper=\"2.0\"", "upper=\"1.75\""));
  EXPECT_THAT(patch.unpatched,
              ElementsAre(AllOf(StartsWith("arm.xacro:10: joint 'left_pan': lower=\"${-2}\""),
                                HasSubstr("lower=\"-2.25\" of <limit>"))));
}

TEST(PatchXacro, RisingIsCreatedWhereTheUrdfHasIt) {
  const XacroPatch patch = patched({{"left_pan", 0.25, {}}}, OffsetStyle::rising);
  EXPECT_EQ(patch.files[0].text, with(kXacro, "<axis xyz=\"0 0 1\"/>",
                                      "<axis xyz=\"0 0 1\"/><calibration rising=\"0.25\"/>"));
}

TEST(PatchXacro, PatchingAgainChangesNothing) {
  const std::vector<JointPatch> patches = {shifted("left_pan", 0.5)};
  const std::string once = patched(patches).files[0].text;
  const XacroPatch again = patch_xacro({{"arm.xacro", once}}, kUrdf, calibrated(patches));
  EXPECT_EQ(again.files[0].text, once);
  EXPECT_THAT(again.files[0].patched, ElementsAre("left_pan"));
  const std::string rising = patched({{"left_pan", 0.25, {}}}, OffsetStyle::rising).files[0].text;
  EXPECT_EQ(patch_xacro({{"arm.xacro", rising}}, kUrdf,
                        calibrated({{"left_pan", 0.25, {}}}, OffsetStyle::rising))
                .files[0]
                .text,
            rising);
}

TEST(PatchXacro, AMacroOfSeveralJointsIsNamed) {
  EXPECT_THAT(patched({shifted("finger_2", 0.5)}).unpatched,
              ElementsAre(AllOf(StartsWith("arm.xacro:18: joint 'finger_2' is one of 2"),
                                HasSubstr("xyz=\"0 0.5 0.5\" of <origin>"))));
}

TEST(PatchXacro, AnotherNumberThanInTheUrdfIsNamed) {
  const XacroPatch patch = patch_xacro({{"arm.xacro", with(kXacro, "0 0   0.10", "0 0 0.2")}},
                                       kUrdf, calibrated({shifted("left_pan", 0.5)}));
  EXPECT_THAT(patch.unpatched,
              ElementsAre(HasSubstr("xyz=\"0 0 0.2\" is not the number in the URDF")));
}

TEST(PatchXacro, AMimicIsPatchedLikeOtherNumbers) {
  const std::string urdf =
      "<robot name='r'><link name='a'/><link name='b'/><link name='c'/>"
      "<joint name='j' type='continuous'><parent link='a'/><child link='b'/></joint>"
      "<joint name='k' type='continuous'><parent link='b'/><child link='c'/>"
      "<mimic joint='j' multiplier='2'/></joint></robot>";
  const std::string after = patch_urdf(urdf, "r.urdf", parse_urdf(urdf, "r.urdf"),
                                       {{"k", 0.0, {}, 0.5, 0.25}}, OffsetStyle::rising);
  const XacroPatch patch = patch_xacro({{"r.xacro", urdf}}, urdf, after);
  EXPECT_EQ(patch.files[0].text, after);
  EXPECT_THAT(patch.files[0].text, HasSubstr("<mimic joint='j' multiplier='2.5' offset='0.25'/>"));
}

constexpr const char* kTop = "<robot name='arm' xmlns:xacro='http://www.ros.org/wiki/xacro'/>";

TEST(PatchXacro, AJointOfNoFileIsNamed) {
  const std::string after = calibrated({shifted("left_pan", 0.5)});
  EXPECT_THAT(patch_xacro({{"top.xacro", kTop}}, kUrdf, after).unpatched,
              ElementsAre(StartsWith("top.xacro: no joint 'left_pan'; it should get xyz=")));
  EXPECT_THAT(
      patch_xacro({{"top.xacro", kTop}, {"b.xacro", kTop}}, kUrdf, after).unpatched,
      ElementsAre(StartsWith("top.xacro: no joint 'left_pan', nor in the files that it includes")));
}

TEST(PatchXacro, AJointOfAnIncludedFileIsPatchedThere) {
  const XacroPatch patch = patch_xacro({{"top.xacro", kTop}, {"arm.xacro", kXacro}}, kUrdf,
                                       calibrated({shifted("left_pan", 0.5)}));
  ASSERT_EQ(patch.files.size(), 2u);
  EXPECT_EQ(patch.files[0].text, kTop);
  EXPECT_EQ(patch.files[1].name, "arm.xacro");
  EXPECT_EQ(patch.files[1].text, with(kXacro, "0 0   0.10", "0 0   0.6"));
  EXPECT_THAT(patch.files[1].patched, ElementsAre("left_pan"));
  EXPECT_THAT(patch.unpatched, IsEmpty());
}

TEST(PatchXacro, AJointOfTwoFilesIsNamedWithBoth) {
  const XacroPatch patch = patch_xacro({{"a.xacro", kXacro}, {"b.xacro", kXacro}}, kUrdf,
                                       calibrated({shifted("left_pan", 0.5)}));
  EXPECT_EQ(patch.files[0].text, kXacro);
  EXPECT_THAT(patch.unpatched,
              ElementsAre(StartsWith(
                  "a.xacro:7, b.xacro:7: several joints that may be 'left_pan'; it should get")));
}

TEST(PatchXacro, WhatIsNotXacroIsAnError) {
  EXPECT_THROW((void)patch_xacro({{"a.xacro", "<a/>"}}, kUrdf, kUrdf), InputError);
  EXPECT_THROW((void)patch_xacro({{"a.xacro", ""}}, kUrdf, kUrdf), InputError);
}

}  // namespace
}  // namespace kinecal
