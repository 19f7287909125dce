#include "kinecal/files/urdf/xacro_remnants.ipp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace kinecal {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

/// The remnants in a robot with this content; those that are not inert begin with "! ".
std::vector<std::string> remnants(const std::string& content, const std::string& attributes = "") {
  pugi::xml_document document;
  EXPECT_TRUE(document.load_string(("<robot " + attributes + ">" + content + "</robot>").c_str()));
  std::vector<std::string> texts;
  const detail::XacroRemnants found(document.document_element());
  for (const detail::XacroRemnant& remnant : found.all()) {
    texts.push_back((remnant.is_inert ? "" : "! ") + remnant.text);
  }
  return texts;
}

TEST(XacroRemnants, DefinitionsAreInert) {
  EXPECT_THAT(remnants("<xacro:property name='a' value='1'/><xacro:arg name='b' default='2'/>"
                       "<xacro:macro name='hand'><link name='h'/></xacro:macro>"),
              ElementsAre("<xacro:property>", "<xacro:arg>", "<xacro:macro>"));
}

TEST(XacroRemnants, WhatStandsInALinkOrAnotherElementIsInert) {
  EXPECT_THAT(remnants("<link name='a'><visual><xacro:grey/></visual><xacro:box_inertia m='1'/>"
                       "<collision><geometry><box size='${s}'/></geometry></collision></link>"
                       "<gazebo><xacro:skin/></gazebo><transmission><xacro:motor/></transmission>"
                       "<material name='m'><xacro:insert_block name='c'/></material>"),
              ElementsAre("<xacro:grey>", "<xacro:box_inertia>", "size=\"${s}\" of <box>",
                          "<xacro:skin>", "<xacro:motor>", "<xacro:insert_block>"));
}

TEST(XacroRemnants, WhatStandsBesideLinksCouldHoldSome) {
  EXPECT_THAT(remnants("<xacro:hand/><xacro:include filename='a.xacro'/><xacro:insert_block/>"),
              ElementsAre("! <xacro:hand>", "! <xacro:include>", "! <xacro:insert_block>"));
}

TEST(XacroRemnants, AConditionMattersIfItHoldsLinksOrJoints) {
  EXPECT_THAT(remnants("<xacro:if value='1'><gazebo/></xacro:if>"
                       "<xacro:unless value='1'><link name='a'/></xacro:unless>"
                       "<xacro:if value='1'><xacro:if value='2'><joint/></xacro:if></xacro:if>"
                       "<xacro:if value='1'><xacro:hand/></xacro:if>"),
              ElementsAre("<xacro:if>", "! <xacro:unless>", "! <xacro:if>", "! <xacro:if>"));
}

TEST(XacroRemnants, ACallMattersUnlessItsMacroIsHereAndHoldsNone) {
  EXPECT_THAT(remnants("<xacro:macro name='skin'><gazebo/></xacro:macro><xacro:skin/>"
                       "<xacro:macro name='hand'><link name='h'/></xacro:macro><xacro:hand/>"
                       "<xacro:macro name='a'><xacro:a/></xacro:macro><xacro:a/>"),
              ElementsAre("<xacro:macro>", "<xacro:skin>", "<xacro:macro>", "! <xacro:hand>",
                          "<xacro:macro>", "! <xacro:a>"));
}

TEST(XacroRemnants, InAJointAnElementMattersIfThereIsNoOriginOrAxis) {
  const std::string ends = "<parent link='a'/><child link='b'/>";
  const auto joint = [&](const std::string& type, const std::string& content) {
    return remnants("<joint name='j' type='" + type + "'>" + ends + content + "</joint>");
  };
  EXPECT_THAT(joint("fixed", "<xacro:origin/>"), ElementsAre("! <xacro:origin>"));
  EXPECT_THAT(joint("fixed", "<origin/><xacro:extra/>"), ElementsAre("<xacro:extra>"));
  EXPECT_THAT(joint("revolute", "<origin/><xacro:axis/>"), ElementsAre("! <xacro:axis>"));
  EXPECT_THAT(joint("revolute", "<origin/><axis/><xacro:damping/>"),
              ElementsAre("<xacro:damping>"));
  EXPECT_THAT(joint("fixed", "<xacro:property name='p' value='1'/>"),
              ElementsAre("<xacro:property>"));
}

TEST(XacroRemnants, ExpressionsMatterInJointsAndInNamesOfLinks) {
  EXPECT_THAT(
      remnants("<link name='${p}a'/><joint name='$(arg p)j'><origin xyz='${x} 0 0'/></joint>"
               "<gazebo reference='${p}a'/>",
               "name='${robot}'"),
      ElementsAre("name=\"${robot}\" of <robot>", "! name=\"${p}a\" of <link>",
                  "! name=\"$(arg p)j\" of <joint>", "! xyz=\"${x} 0 0\" of <origin>",
                  "reference=\"${p}a\" of <gazebo>"));
}

TEST(XacroRemnants, ThePrefixIsThatOfTheNamespace) {
  EXPECT_THAT(remnants("<x:hand/><gz:thing/>",
                       "xmlns:x='http://www.ros.org/wiki/xacro' xmlns:gz='http://gazebosim.org'"),
              ElementsAre("! <x:hand>"));
}

TEST(XacroRemnants, AnExpandedRobotHasNone) {
  EXPECT_THAT(remnants("<!-- ${a} <xacro:b/> --><link name='a'/>",
                       "xmlns:xacro='http://www.ros.org/wiki/xacro'"),
              IsEmpty());
}

}  // namespace
}  // namespace kinecal
