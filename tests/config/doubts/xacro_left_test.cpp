// Remnants of xacro in a URDF: errors, warnings and the advice.
#include "kinecal/config/doubts/xacro_left.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "support/arm_scene.hpp"

namespace kinecal {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

class XacroLeft : public test::ArmScene {
 protected:
  /// Puts a text after link l2, in line 13.
  void add(const std::string& text) {
    replace(urdf, "<link name=\"l2\"/>", "<link name=\"l2\"/>" + text);
  }
};

TEST_F(XacroLeft, ACallBesideLinksIsAnErrorWithItsLineAndAdvice) {
  add("<xacro:hand parent=\"l2\"/>");
  EXPECT_THAT(found().errors,
              ElementsAre(AllOf(HasSubstr("arm.urdf:13: <xacro:hand> is xacro that was not"),
                                HasSubstr("run: xacro arm.urdf > arm_expanded.urdf"),
                                HasSubstr("remove it if the robot is complete without it"))));
  EXPECT_THAT(found().warnings, Not(testing::Contains(HasSubstr("xacro"))));
}

TEST_F(XacroLeft, RemnantsThatHoldNoJointAreAWarningThatNamesThem) {
  add("<xacro:property name=\"m\" value=\"2\"/>");
  replace(urdf, "<link name=\"l3\"/>",
          "<link name=\"l3\"><visual><geometry><box size=\"1 1 1\"/></geometry>\n<xacro:grey/>"
          "</visual></link><gazebo reference=\"l3\"><xacro:skin/></gazebo>");
  EXPECT_THAT(found().errors, IsEmpty());
  EXPECT_THAT(found().warnings,
              ElementsAre(AllOf(HasSubstr("arm.urdf:13: xacro left <xacro:property>"),
                                HasSubstr(", <xacro:grey> in line 19, <xacro:skin> in line 19;"))));
}

TEST_F(XacroLeft, MoreThanAFewRemnantsAreCounted) {
  add("<gazebo>" + std::string("<xacro:a/><xacro:b/><xacro:c/><xacro:d/><xacro:e/><xacro:f/>") +
      "</gazebo>");
  EXPECT_THAT(found().warnings, ElementsAre(AllOf(HasSubstr("<xacro:e>"), HasSubstr("and 1 more"),
                                                  Not(HasSubstr("<xacro:f>")))));
}

TEST_F(XacroLeft, AnExpressionIsAnErrorInAJointOnly) {
  add("<material name=\"${color}\"><color rgba=\"1 1 1 1\"/></material>");
  EXPECT_THAT(found().errors, IsEmpty());
  EXPECT_THAT(found().warnings, ElementsAre(HasSubstr("name=\"${color}\" of <material>")));
  replace(urdf, "<joint name=\"flange\"", "<joint name=\"$(arg side)flange\"");
  EXPECT_THAT(found().errors,
              ElementsAre(AllOf(HasSubstr("arm.urdf:31: name=\"$(arg side)flange\" of <joint>"),
                                Not(HasSubstr("remove it")))));
}

TEST(XacroCommand, NeverWritesOntoItsInput) {
  for (const char* file : {"robot.urdf", "robot.urdf.xacro", "a/robot.xacro", "robot_expanded.urdf",
                           "./robot.v2.urdf", "robot_expanded_expanded.urdf", "my robot.urdf"}) {
    const std::string command = detail::xacro_command(file);
    const std::string output = command.substr(command.find(" > ") + 3);
    EXPECT_THAT(command, testing::StartsWith("xacro ")) << file;
    EXPECT_THAT(command, HasSubstr(file));
    EXPECT_NE(std::filesystem::path(file).filename().string(), output);
    EXPECT_THAT(file, Not(HasSubstr(output)));
  }
  EXPECT_EQ(detail::xacro_command("a/robot.urdf"), "xacro a/robot.urdf > robot_expanded.urdf");
  EXPECT_EQ(detail::xacro_command("my robot.urdf"),
            "xacro 'my robot.urdf' > 'my robot_expanded.urdf'");
  EXPECT_EQ(detail::xacro_command("/robot_description"), "") << "a topic is no file";
}

}  // namespace
}  // namespace kinecal
