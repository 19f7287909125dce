#include "kinecal/files/launch/launch_text.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <pugixml.hpp>
#include <string>
#include <vector>

#include "support/hostile_names.hpp"
#include "support/thrown.hpp"

namespace kinecal {
namespace {

using namespace detail;
using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;

LaunchSetting param(const std::string& name, const std::string& value,
                    const std::string& attribute = "value") {
  return {"key", LaunchElement::param, name, attribute, value};
}

LaunchSetting arg(const std::string& name, const std::string& value) {
  return {"key", LaunchElement::arg, name, "default", value};
}

std::string with(const std::string& text, const std::vector<LaunchSetting>& settings) {
  return LaunchText(text, "robot.launch").with(settings);
}

std::string refusal(const std::string& text, const std::vector<LaunchSetting>& settings) {
  return test::thrown<InputError>([&] { (void)with(text, settings); }, "(not refused)");
}

TEST(LaunchText, ChangesValuesAndNoOtherByte) {
  const std::string text =
      "\xEF\xBB\xBF<?xml version='1.0'?>\r\n<launch>\r\n"
      "  <!-- <param name=\"a\" value=\"comment\"/> -->\r\n"
      "\t<param value = 'old'   name='a' />\r\n"
      "  <arg name=\"u\" default=\"file:///old\"/><![CDATA[<param name=\"a\" value=\"1\"/>]]>\r\n"
      "</launch>";
  std::string expected = text;
  expected.replace(expected.find("old"), 3, "new");
  expected.replace(expected.find("file:///old"), 11, "file:///x");
  EXPECT_EQ(with(text, {param("a", "new"), arg("u", "file:///x")}), expected);
}

TEST(LaunchText, WhatIsSetAlreadyIsNotTouched) {
  const std::string text = "<launch><param name='a' value='x &#38; y'/></launch>";
  EXPECT_EQ(with(text, {param("a", "x & y")}), text);
}

TEST(LaunchText, ValuesAreEscapedForTheirQuotes) {
  const std::string text =
      "<launch><param name='a' value='1'/><param name=\"b\" value=\"1\"/></launch>";
  const std::string value = "it's <\"this\"> & that";
  const LaunchText changed(with(text, {param("a", value), param("b", value)}), "f");
  for (const char* name : {"a", "b"}) {
    Diagnostics none;
    EXPECT_EQ(changed.value_of(param(name, ""), none), value);
  }
}

TEST(LaunchText, AParameterThatWasComputedBecomesAFile) {
  EXPECT_EQ(with("<launch><param name=\"robot_description\" command='xacro \"f\"'/></launch>",
                 {param("robot_description", "/a.urdf", "textfile")}),
            "<launch><param name=\"robot_description\" textfile='/a.urdf'/></launch>");
}

TEST(LaunchText, AParameterIsKnownByTheNamespacesItStandsIn) {
  const std::string text =
      "<launch><group ns=\"left\"><param name=\"a\" value=\"1\"/></group>"
      "<node name=\"n\" ns=\"s\"><param name=\"a\" value=\"1\"/><param name=\"/g\" value=\"1\"/>"
      "</node><param name=\"a\" value=\"1\"/></launch>";
  EXPECT_EQ(
      with(text, {param("left/a", "2"), param("s/n/a", "3"), param("/a", "4"), param("g", "5")}),
      "<launch><group ns=\"left\"><param name=\"a\" value=\"2\"/></group>"
      "<node name=\"n\" ns=\"s\"><param name=\"a\" value=\"3\"/><param name=\"/g\" value=\"5\"/>"
      "</node><param name=\"a\" value=\"4\"/></launch>");
}

TEST(LaunchText, AnArgumentIsSetWhereItIsDeclaredNotWhereItIsPassedOn) {
  EXPECT_EQ(with("<launch><arg name=\"u\" default=\"1\"/><include file=\"f\">"
                 "<arg name=\"u\" value=\"$(arg u)\"/></include></launch>",
                 {arg("u", "2")}),
            "<launch><arg name=\"u\" default=\"2\"/><include file=\"f\">"
            "<arg name=\"u\" value=\"$(arg u)\"/></include></launch>");
  EXPECT_EQ(with("<launch><include file=\"f\"><arg name=\"u\" value=\"1\"/></include></launch>",
                 {arg("u", "2")}),
            "<launch><include file=\"f\"><arg name=\"u\" value=\"2\"/></include></launch>");
}

TEST(LaunchText, ReportsEveryMissingNameWithTheNearest) {
  const std::string message = refusal(
      "<launch>\n<param name=\"calibration_dat\" value=\"\"/><arg name=\"q\" "
      "default=\"\"/></launch>",
      {param("calibration_date", "1"), arg("rgb_url", "1")});
  EXPECT_THAT(message, StartsWith("robot.launch: no param 'calibration_date'; did you mean "
                                  "'calibration_dat'? --name key=NAME"));
  EXPECT_THAT(message, AllOf(HasSubstr("\nrobot.launch: no arg 'rgb_url'; --name key=NAME"),
                             HasSubstr("--name key= leaves it out")));
}

TEST(LaunchText, RefusesAParameterThatOccursTwice) {
  EXPECT_THAT(refusal("<launch>\n<param name='a' value=''/>\n<group if='$(arg x)'>\n"
                      "<param name='/a' value=''/></group></launch>",
                      {param("a", "1")}),
              StartsWith("robot.launch:4: param 'a' occurs twice, first in line 2; "));
}

TEST(LaunchText, RefusesTwoValuesForOneElement) {
  LaunchSetting other = param("a", "2");
  other.key = "another";
  EXPECT_THAT(refusal("<launch><param name='a' value=''/></launch>", {param("a", "1"), other}),
              HasSubstr("robot.launch:1: another and key both set param 'a'"));
}

TEST(LaunchText, RefusesAnElementWithoutAValue) {
  EXPECT_THAT(refusal("<launch><arg name='u'/></launch>", {arg("u", "1")}),
              StartsWith("robot.launch:1: arg 'u' has no default="));
}

TEST(LaunchText, RefusesAnElementWithTwoValues) {
  EXPECT_EQ(refusal("<launch><param name='a' textfile='f' value='1'/></launch>", {param("a", "2")}),
            "robot.launch:1: param 'a' has both textfile and value; keep one of them");
}

TEST(LaunchText, RefusesWhatIsNotALaunchFile) {
  EXPECT_THAT(refusal("<robot/>", {}),
              StartsWith("robot.launch:1: the root element is <robot>; a launch file begins with"));
  EXPECT_THAT(refusal("def generate_launch_description():", {}), HasSubstr("malformed XML"));
  EXPECT_THAT(refusal("", {}), HasSubstr("is empty"));
}

/// roslaunch evaluates $(...), and nothing escapes it.
TEST(LaunchText, HoldsEveryValueButSubstitutionsAndLineEnds) {
  const std::string text = "<launch>\n<arg name='a' default=''/></launch>";
  for (const std::string& name : test::kHostileNames) {
    if (name.find('$') != std::string::npos) {
      EXPECT_THAT(refusal(text, {arg("a", "file:///" + name)}),
                  AllOf(HasSubstr("robot.launch:2: arg 'a': 'file:///" + name + "' cannot stand"),
                        HasSubstr("rename")));
      continue;
    }
    pugi::xml_document launch;
    ASSERT_TRUE(launch.load_string(with(text, {arg("a", "file:///" + name)}).c_str())) << name;
    EXPECT_EQ(launch.select_node("//arg/@default").attribute().value(), "file:///" + name);
  }
  for (const std::string& name : test::kRefusedNames) {
    EXPECT_THAT(refusal(text, {arg("a", name)}), HasSubstr("cannot stand")) << name;
  }
}

TEST(LaunchText, NamesAnOptionAsItIsTyped) {
  LaunchSetting setting = arg("b", "1");
  setting.key = "left camera;_rgb";
  EXPECT_THAT(refusal("<launch><arg name='a' default=''/></launch>", {setting}),
              HasSubstr("--name 'left camera;_rgb=NAME' names another one"));
}

}  // namespace
}  // namespace kinecal
