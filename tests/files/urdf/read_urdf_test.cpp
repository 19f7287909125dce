#include "kinecal/files/urdf/read_urdf.hpp"

#include <console_bridge/console.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <locale>
#include <string>
#include <vector>

#include "kinecal/geometry/rpy.hpp"
#include "kinecal/kinematics/chain.hpp"
#include "support/data.hpp"
#include "support/temporary_folder.hpp"
#include "support/thrown.hpp"

namespace kinecal {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

constexpr double kExact = 0.0;

/// A robot of three links; `joint` is the text of joint "elbow", from line 6 on.
std::string robot_with(const std::string& joint) {
  return "<?xml version=\"1.0\"?>\n"
         "<robot name=\"arm\">\n"
         "  <link name=\"base\"/> <link name=\"upper\"/> <link name=\"lower\"/>\n"
         "  <joint name=\"shoulder\" type=\"continuous\"> <parent link=\"base\"/>\n"
         "    <child link=\"upper\"/> <axis xyz=\"0 0 1\"/> </joint>\n" +
         joint + "\n</robot>\n";
}

constexpr const char* kLinks = "<parent link=\"upper\"/><child link=\"lower\"/>";

std::string elbow(const std::string& content, const std::string& type = "continuous") {
  return robot_with("  <joint name=\"elbow\" type=\"" + type + "\">" + content + "</joint>");
}

/// The message with which a text is refused.
std::string refusal(const std::string& text) {
  testing::internal::CaptureStdout();
  testing::internal::CaptureStderr();
  std::string message = "the text was accepted";
  try {
    (void)parse_urdf(text, "arm.urdf");
  } catch (const InputError& e) {
    message = e.what();
  }
  EXPECT_EQ(testing::internal::GetCapturedStdout(), "") << "printed to stdout";
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "") << "printed to stderr";
  return message;
}

/// A robot of so many joints, each below the one before or all at the base.
std::string robot_of(int joints, bool in_a_row) {
  std::string text = "<robot name=\"r\">\n<link name=\"l0\"/>\n";
  for (int i = 1; i <= joints; ++i) {
    const std::string number = std::to_string(i);
    text += "<link name=\"l" + number + "\"/><joint name=\"j" + number +
            "\" type=\"revolute\"><parent link=\"l" + (in_a_row ? std::to_string(i - 1) : "0") +
            "\"/><child link=\"l" + number +
            "\"/><axis xyz=\"0 0 1\"/><limit lower=\"-1\" upper=\"1\" effort=\"1\" "
            "velocity=\"1\"/></joint>\n";
  }
  return text + "</robot>\n";
}

TEST(ReadUrdf, MoreThanARobotHasIsRefusedAtOnce) {
  EXPECT_EQ(parse_urdf(robot_of(500, true), "arm.urdf").joints().size(), 500U);
  EXPECT_EQ(parse_urdf(robot_of(5000, false), "arm.urdf").joints().size(), 5000U);
  EXPECT_EQ(refusal(robot_of(501, true)),
            "arm.urdf:503: joint 'j501' is below more than 500 others, which is the most that is "
            "read");
  EXPECT_EQ(refusal(robot_of(100'000, true)),
            "arm.urdf:5003: the robot has more than 5000 joints, which is the most that is read");
  std::string attributes;
  for (int i = 0; i <= 1000; ++i) attributes += " a" + std::to_string(i) + "=\"1\"";
  EXPECT_EQ(refusal(robot_with("<gazebo" + attributes + "/>")),
            "arm.urdf:6: <gazebo> has more than 1000 attributes");
  std::string mimics = robot_of(22, false);
  for (int i = 2; i <= 22; ++i) {
    const std::string name = "\"j" + std::to_string(i) + "\" type=\"revolute\">";
    mimics.insert(mimics.find(name) + name.size(),
                  "<mimic joint=\"j" + std::to_string(i - 1) + "\"/>");
  }
  EXPECT_EQ(refusal(mimics), "arm.urdf:24: joint 'j22' mimics through more than 20 others");
  std::string deep, ends;
  for (int i = 0; i < 60'000; ++i) deep += "<a>", ends += "</a>";
  EXPECT_EQ(refusal(robot_with("<gazebo>\n" + deep + ends + "</gazebo>")),
            "arm.urdf:7: elements are nested too deeply");
  const std::string name(201, 'x');
  EXPECT_THAT(refusal(robot_with("<joint name=\"" + name + "\" type=\"continuous\">" + kLinks +
                                 "</joint>")),
              AllOf(StartsWith("arm.urdf:6: the name 'xxx"),
                    HasSubstr("...' has 201 characters; at most 200 are possible")));
}

TEST(ReadUrdf, TransfersWhatTheJointSays) {
  const Robot robot =
      parse_urdf(elbow("<origin xyz=\"0.1 -2e-3 +3\" rpy=\"0.3 -0.2 0.1\"/><parent link=\"upper\"/>"
                       "<child link=\"lower\"/><axis xyz=\"0 3 4\"/>"
                       "<limit lower=\"-0.5\" upper=\"1.5\" effort=\"1\" velocity=\"1\"/>"
                       "<mimic joint=\"shoulder\" multiplier=\"-2\" offset=\"0.25\"/>",
                       "prismatic"),
                 "arm.urdf");
  EXPECT_EQ(robot.name(), "arm");
  const Joint& joint = robot.joint("elbow");
  EXPECT_EQ(joint.type, JointType::prismatic);
  EXPECT_EQ(joint.parent, "upper");
  EXPECT_EQ(joint.child, "lower");
  EXPECT_EQ(joint.origin.translation, Vector3<double>(0.1, -2e-3, 3.0));
  EXPECT_EQ(joint.origin.rotation, rotation_from_rpy({0.3, -0.2, 0.1}));
  EXPECT_TRUE(joint.axis.isApprox(Vector3<double>(0.0, 0.6, 0.8)));
  ASSERT_TRUE(joint.limits);
  EXPECT_EQ(joint.limits->lower, -0.5);
  EXPECT_EQ(joint.limits->upper, 1.5);
  ASSERT_TRUE(joint.mimic);
  EXPECT_EQ(joint.mimic->joint, "shoulder");
  EXPECT_EQ(joint.mimic->multiplier, -2.0);
  EXPECT_EQ(joint.mimic->offset, 0.25);
}

TEST(ReadUrdf, WhatIsMissingHasTheDefaultsOfTheSpecification) {
  const Robot robot = parse_urdf(elbow(kLinks), "arm.urdf");
  const Joint& joint = robot.joint("elbow");
  EXPECT_TRUE(joint.origin.rotation.isIdentity(kExact));
  EXPECT_TRUE(joint.origin.translation.isZero(kExact));
  EXPECT_EQ(joint.axis, Vector3<double>(1.0, 0.0, 0.0));
  EXPECT_FALSE(joint.mimic);
  EXPECT_FALSE(joint.limits);
}

TEST(ReadUrdf, AContinuousJointHasNoPositionLimits) {
  const Robot robot =
      parse_urdf(elbow(kLinks + std::string("<limit effort='1' velocity='2'/>")), "arm.urdf");
  EXPECT_FALSE(robot.joint("elbow").limits);
}

TEST(ReadUrdf, KnowsAllTypesOfJoints) {
  for (const std::string type :
       {"fixed", "revolute", "continuous", "prismatic", "floating", "planar"}) {
    const std::string limit = "<limit lower='0' upper='1' effort='1' velocity='1'/>";
    const Robot robot = parse_urdf(elbow(kLinks + limit, type), "arm.urdf");
    EXPECT_EQ(to_string(robot.joint("elbow").type), type);
  }
}

TEST(ReadUrdf, KeepsTheJointsInTheOrderOfTheText) {
  const Robot robot = parse_urdf(elbow(kLinks), "arm.urdf");  // not that of the alphabet
  EXPECT_EQ(robot.joint_names(), (std::vector<std::string>{"shoulder", "elbow"}));
}

TEST(ReadUrdf, NumbersMayBeSeparatedByAnyWhiteSpace) {
  const Robot robot = parse_urdf(elbow(std::string("<origin xyz='\n 1\t 2\r\n3 ' rpy='0\t0  1'/>") +
                                       "<axis xyz='0\n1  0'/>" + kLinks),
                                 "arm.urdf");
  EXPECT_EQ(robot.joint("elbow").origin.translation, Vector3<double>(1.0, 2.0, 3.0));
  EXPECT_EQ(robot.joint("elbow").origin.rotation, rotation_from_rpy({0.0, 0.0, 1.0}));
  EXPECT_EQ(robot.joint("elbow").axis, Vector3<double>(0.0, 1.0, 0.0));
}

TEST(ReadUrdf, ReadsByteOrderMarkAndCrLf) {
  std::string text = "\xEF\xBB\xBF";
  for (char c : elbow(kLinks)) text += c == '\n' ? std::string("\r\n") : std::string(1, c);
  EXPECT_TRUE(parse_urdf(text, "arm.urdf").has_joint("elbow"));
}

TEST(ReadUrdf, OnlyTheRobotsOwnJointsCount) {
  const Robot robot = parse_urdf(elbow(kLinks) + "<!-- <joint name='ghost'/> -->", "arm.urdf");
  EXPECT_EQ(robot.joints().size(), 2u);
  const std::string joint = "<joint name='elbow' type='fixed'>" + std::string(kLinks) + "</joint>";
  const std::string more = "<transmission name='t'><joint name='other'/></transmission>";
  EXPECT_EQ(parse_urdf(robot_with(more + joint), "arm.urdf").joints().size(), 2u);
}

TEST(ReadUrdf, DoesNotDependOnTheLocale) {
  struct DecimalComma : std::numpunct<char> {
    char do_decimal_point() const override { return ','; }
  };
  const std::locale before =
      std::locale::global(std::locale(std::locale::classic(), new DecimalComma));
  const std::string numbers =
      "<origin xyz='0.5 0 0'/><axis xyz='0.6 0.8 0'/><mimic joint='shoulder' offset='0.25'/>";
  const Robot robot = parse_urdf(elbow(kLinks + numbers), "arm.urdf");
  std::locale::global(before);
  EXPECT_EQ(robot.joint("elbow").origin.translation.x(), 0.5);
  EXPECT_DOUBLE_EQ(robot.joint("elbow").axis.x(), 0.6);
  EXPECT_EQ(robot.joint("elbow").mimic->offset, 0.25);
}

TEST(ReadUrdf, GivesTheOutputHandlerBack) {
  console_bridge::OutputHandler* const before = console_bridge::getOutputHandler();
  const console_bridge::LogLevel level = console_bridge::getLogLevel();
  (void)parse_urdf(elbow(kLinks), "arm.urdf");
  (void)refusal(elbow(kLinks, "revolute"));
  EXPECT_EQ(console_bridge::getOutputHandler(), before);
  EXPECT_EQ(console_bridge::getLogLevel(), level);
}

TEST(ReadUrdfError, AFileThatIsMissingOrAFolder) {
  const auto message = [](const std::string& path) {
    return test::thrown<InputError>([&] { (void)read_urdf(path); }, "accepted");
  };
  EXPECT_THAT(message("no/such/arm.urdf"),
              AllOf(StartsWith("no/such/arm.urdf: "), HasSubstr("No such file")));
  EXPECT_THAT(message("."), StartsWith(".: is a folder"));
}

TEST(ReadUrdfError, AnEmptyFile) {
  EXPECT_THAT(refusal(""), StartsWith("arm.urdf: the file is empty"));
  EXPECT_THAT(refusal(" \n\t"), StartsWith("arm.urdf: the file is empty"));
}

TEST(ReadUrdfError, AnAttributeThatOccursTwiceWithItsLine) {
  EXPECT_THAT(refusal("<robot name='a'>\n<link name='b'>\n<visual name='v' name='w'/>\n</link>\n"
                      "</robot>"),
              StartsWith("arm.urdf:3: <visual> has the attribute 'name' twice; remove one"));
}

TEST(ReadUrdfError, MalformedXmlWithItsLine) {
  EXPECT_THAT(refusal("<robot name='a'>\n  <link name='b'>\n</robot>\n"),
              StartsWith("arm.urdf:3: malformed XML: "));
  EXPECT_THAT(refusal("<robot name='a'>\n<link name=b/>\n</robot>"),
              StartsWith("arm.urdf:2: malformed XML: "));
  EXPECT_THAT(refusal("shoulder: 0.1\n"), HasSubstr("malformed XML"));
  EXPECT_THAT(refusal("\xFF\xFE<\0r\0"), HasSubstr("UTF-16"));
}

TEST(ReadUrdfError, NotARobot) {
  EXPECT_THAT(refusal("<?xml version='1.0'?>\n<sdf version='1.6'/>\n"),
              AllOf(StartsWith("arm.urdf:2: "), HasSubstr("<sdf>"), HasSubstr("<robot>")));
}

TEST(ReadUrdfError, AnUnknownTypeOfJoint) {
  EXPECT_THAT(refusal(elbow(kLinks, "revolut")),
              AllOf(StartsWith("arm.urdf:6: joint 'elbow' has the unknown type 'revolut'"),
                    HasSubstr("did you mean 'revolute'?")));
  EXPECT_THAT(refusal(robot_with("<joint name='elbow'>" + std::string(kLinks) + "</joint>")),
              "arm.urdf:6: joint 'elbow' has no type");
}

TEST(ReadUrdfError, AJointWithoutNameParentOrChild) {
  EXPECT_THAT(refusal(elbow("<child link=\"lower\"/>")),
              StartsWith("arm.urdf:6: joint 'elbow' has no <parent "));
  EXPECT_THAT(refusal(elbow("<parent link=\"upper\"/>\n<child/>")),
              StartsWith("arm.urdf:6: joint 'elbow' has no <child "));
  EXPECT_THAT(refusal(robot_with("<joint type='fixed'/>")), "arm.urdf:6: a joint has no name");
}

TEST(ReadUrdfError, ALinkThatDoesNotExist) {
  EXPECT_THAT(refusal(elbow("<parent link=\"uper\"/><child link=\"lower\"/>")),
              AllOf(StartsWith("arm.urdf:6: "), HasSubstr("uper"), HasSubstr("elbow")));
}

TEST(ReadUrdfError, TwoRootsOrACircleWithoutARoot) {
  EXPECT_THAT(refusal(robot_with("")),
              AllOf(StartsWith("arm.urdf:3: "), HasSubstr("root"), HasSubstr("lower")));
  const std::string circle =
      "<robot name='r'><link name='a'/><link name='b'/>"
      "<joint name='ab' type='fixed'><parent link='a'/><child link='b'/></joint>"
      "<joint name='ba' type='fixed'><parent link='b'/><child link='a'/></joint></robot>";
  EXPECT_THAT(refusal(circle), AllOf(StartsWith("arm.urdf:1: "), HasSubstr("is below itself")));
}

TEST(ReadUrdfError, ACircleBesideTheTree) {
  EXPECT_THAT(refusal("<robot name='r'>\n<link name='root'/>\n<link name='a'/>\n<link name='b'/>\n"
                      "<joint name='ab' type='fixed'><parent link='a'/><child link='b'/></joint>\n"
                      "<joint name='ba' type='fixed'><parent link='b'/><child link='a'/></joint>\n"
                      "</robot>"),
              AllOf(StartsWith("arm.urdf:"), HasSubstr("is below itself")));
}

TEST(ReadUrdfError, ALinkWithTwoParents) {
  EXPECT_THAT(refusal(robot_with("<joint name='a' type='fixed'>" + std::string(kLinks) +
                                 "</joint>\n<joint name='b' type='fixed'><parent link='base'/>"
                                 "<child link='lower'/></joint>")),
              AllOf(StartsWith("arm.urdf:6: "), HasSubstr("'lower'"), HasSubstr("'b'")));
}

TEST(ReadUrdfError, AJointThatOccursTwice) {
  const std::string joint = "<joint name='elbow' type='fixed'>" + std::string(kLinks) + "</joint>";
  EXPECT_THAT(refusal(robot_with(joint + "\n" + joint)),
              "arm.urdf:7: joint 'elbow' occurs twice, first in line 6");
}

TEST(ReadUrdf, AJointWithAnAxisOfLengthZeroMattersToChainsOnly) {
  const Robot robot = parse_urdf(elbow(kLinks + std::string("<axis xyz=\"0 0 0\"/>")), "arm.urdf");
  EXPECT_EQ(robot.joint("elbow").type, JointType::planar);
  EXPECT_THROW((void)make_chain(robot, "upper", "lower"), RobotError);
}

TEST(ReadUrdf, AFixedJointHasNoAxisThatCouldBeWrong) {
  EXPECT_NO_THROW((void)parse_urdf(elbow(kLinks + std::string("<axis xyz=\"\"/>"), "fixed"), "a"));
}

TEST(ReadUrdf, FindsLinksWithAndWithoutALeadingSlash) {
  const Robot robot = parse_urdf(
      "<robot name='r'><link name='/px/base'/><link name='/'/><link name='tool'/>"
      "<joint name='a' type='fixed'><parent link='/px/base'/><child link='/'/></joint>"
      "<joint name='b' type='fixed'><parent link='/'/><child link='tool'/></joint></robot>",
      "r.urdf");
  EXPECT_EQ(robot.link_names(), (std::vector<std::string>{"/", "/px/base", "tool"}));
  for (const char* link : {"/px/base", "px/base", "/", "tool", "/tool"}) {
    EXPECT_TRUE(robot.has_link(link)) << link;
  }
  EXPECT_FALSE(robot.has_link(""));
  EXPECT_EQ(robot.parent_joint("/tool")->name, "b");
  const RuntimeChain chain = make_chain(robot, "px/base", "/tool");
  EXPECT_EQ(chain.base, "/px/base");
  EXPECT_EQ(chain.tip, "tool");
}

TEST(ReadUrdfError, LinksThatDifferOnlyByTheSlash) {
  EXPECT_THAT(
      refusal("<robot name='r'>\n<link name='a'/>\n<link name='tool'/>\n<link name='/tool'/>"
              "<joint name='1' type='fixed'><parent link='a'/><child link='tool'/></joint>"
              "<joint name='2' type='fixed'><parent link='a'/><child link='/tool'/></joint>"
              "</robot>"),
      AllOf(StartsWith("arm.urdf:4: links '/tool' and 'tool' differ only by the leading"),
            HasSubstr("rename one")));
}

TEST(ReadUrdfError, TextsThatAreNotNumbers) {
  EXPECT_THAT(refusal(elbow(kLinks + std::string("\n<origin xyz=\"0 O 0\"/>"))),
              "arm.urdf:7: joint 'elbow': xyz=\"0 O 0\" of <origin> is not 3 numbers");
  for (const std::string bad : {"", "1 2", "1 2 3 4", "1,5 0 0", "nan 0 0", "0 inf 0", "1e999 0 0",
                                "+-1 0 0", "0x1 0 0", "1 2 3m"}) {
    for (const std::string where : {"origin xyz", "origin rpy", "axis xyz"}) {
      EXPECT_THAT(refusal(elbow(kLinks + ("<" + where + "=\"" + bad + "\"/>"))),
                  AllOf(StartsWith("arm.urdf:6: joint 'elbow'"), HasSubstr("\"" + bad + "\"")));
    }
  }
}

TEST(ReadUrdf, AMimicOfAMissingJointOrInACircleHasItsOwnPosition) {
  for (const char* mimicked : {"sholder", "elbow"}) {
    const Robot robot = parse_urdf(
        elbow(kLinks + ("<mimic joint=\"" + std::string(mimicked) + "\"/>")), "arm.urdf");
    EXPECT_FALSE(robot.joint("elbow").mimic) << mimicked;
  }
}

TEST(ReadUrdfError, WhatUrdfdomRefusesIsReportedInItsWordsWithTheLine) {
  EXPECT_THAT(refusal(elbow(kLinks, "revolute")),
              AllOf(StartsWith("arm.urdf:6: "), HasSubstr("elbow"), HasSubstr("limits")));
  EXPECT_THAT(refusal(elbow(kLinks + std::string("<limit effort='much' velocity='1'/>"))),
              AllOf(StartsWith("arm.urdf:6: "), HasSubstr("elbow"), HasSubstr("much")));
}

TEST(ReadUrdfError, AllErrorsOfTheJointsAreReportedAtOnce) {
  const std::string message =
      refusal(elbow("<origin xyz=\"a\"/>\n<parent link=\"upper\"/>", "revolt"));
  EXPECT_THAT(message, AllOf(HasSubstr("unknown type"), HasSubstr("no <child"),
                             HasSubstr("not 3 numbers"), Not(HasSubstr("xacro"))));
}

TEST(ReadUrdfError, XacroLeftInTheFile) {
  EXPECT_THAT(refusal("<robot name='r' xmlns:xacro='http://www.ros.org/wiki/xacro'>\n"
                      "<link name='a'/><link name='b'/>\n"
                      "<joint name='j' type='fixed'><origin xyz='0 0 ${height}'/>\n"
                      "<parent link='a'/><child link='b'/></joint></robot>"),
              AllOf(StartsWith("arm.urdf:3: joint 'j'"), HasSubstr("${height}"),
                    HasSubstr("run xacro on it first")));
}

TEST(ReadUrdfError, XacroIsNamedAsTheCauseOnlyIfItCanBe) {
  const auto robot = [](const std::string& joint) {
    return "<robot name='r'><xacro:property name='m' value='1'/><link name='a'><inertial>"
           "<mass value='${m}'/></inertial><visual><xacro:grey/></visual></link><link name='b'/>"
           "<joint name='j' type='fixed'><parent link='a'/>" +
           joint + "</joint></robot>";
  };
  EXPECT_NO_THROW((void)parse_urdf(robot("<child link='b'/>"), "arm.urdf"));
  EXPECT_THAT(refusal(robot("")),
              AllOf(HasSubstr("joint 'j' has no <child"), Not(HasSubstr("xacro"))));
  EXPECT_THAT(refusal(robot("<xacro:ends/>")),
              AllOf(HasSubstr("joint 'j' has no <child"), HasSubstr("run xacro on it first")));
}

TEST(ReadUrdf, ExpandedXacroIsNotTakenForXacro) {
  EXPECT_NO_THROW((void)parse_urdf(
      "<robot name='r' xmlns:xacro='http://www.ros.org/wiki/xacro'><link name='a'/></robot>",
      "arm.urdf"));
}

TEST(ReadUrdf, ReadsFetch) {
  KINECAL_NEEDS_DATA("fetch");
  const Robot robot = read_urdf((test::data_folder() / "fetch/fetch.urdf").string());
  EXPECT_EQ(robot.name(), "fetch");
  EXPECT_EQ(robot.joint("head_camera_rgb_optical_joint").type, JointType::fixed);
  const Joint& torso = robot.joint("torso_lift_joint");
  EXPECT_EQ(torso.type, JointType::prismatic);
  ASSERT_TRUE(torso.limits);
  EXPECT_EQ(torso.limits->upper, 0.38615);
  EXPECT_EQ(torso.origin.translation, Vector3<double>(-0.086875, 0.0, 0.37743));
  EXPECT_NO_THROW((void)make_chain(robot, "base_link", "gripper_link"));
}

TEST(ReadUrdf, TakesTheUrdfOutOfWhatRosPrints) {
  const test::TemporaryFolder folder;
  const std::string file = (folder.path() / "arm.urdf").string(), urdf = elbow(kLinks);
  const auto text_of = [&](const std::string& text) {
    std::ofstream(file) << text;
    return read_urdf_text(file);
  };
  EXPECT_EQ(text_of(urdf), urdf);
  EXPECT_EQ(text_of("String value is: " + urdf), urdf) << "ros2 param get";
  std::string indented = urdf;
  for (std::size_t at = 0; (at = indented.find('\n', at)) != std::string::npos; at += 5) {
    indented.insert(at + 1, "    ");
  }
  EXPECT_EQ(parse_urdf(text_of("/state:\n  ros__parameters:\n   robot_description: |\n    " +
                               indented + "\n"),
                       file)
                .joints()
                .size(),
            2u)
      << "ros2 param dump";
  std::string quoted;
  for (const char c : urdf) quoted += c == '\n' ? "\\n" : c == '"' ? "\\\"" : std::string(1, c);
  EXPECT_EQ(text_of("data: \"" + quoted + "\"\n---\n"), urdf) << "ros2 topic echo";
  EXPECT_EQ(text_of("no robot\n"), "no robot\n");
}

TEST(ReadUrdf, ReadsTheOtherRobotsOfTheData) {
  for (const std::string file : {"mukca_panda/panda.urdf", "ur5_tracker/ur5.urdf"}) {
    KINECAL_NEEDS_DATA(file);
    EXPECT_FALSE(read_urdf((test::data_folder() / file).string()).joints().empty());
  }
}

}  // namespace
}  // namespace kinecal
