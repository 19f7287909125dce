#include "kinecal/files/urdf/patch_urdf.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <limits>
#include <locale>
#include <map>
#include <set>
#include <sstream>
#include <string>
#include <tuple>
#include <vector>

#include "kinecal/files/urdf/read_urdf.hpp"
#include "kinecal/files/urdf/urdf_text.ipp"
#include "kinecal/geometry/rpy.hpp"
#include "kinecal/kinematics/chain.hpp"
#include "kinecal/kinematics/forward_kinematics.hpp"
#include "kinecal/kinematics/joint_state.hpp"
#include "support/data.hpp"
#include "support/thrown.hpp"

namespace kinecal {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::StartsWith;

/// Two ways to the same pose: ten joints, each a few operations on numbers of size one, and angles
/// taken out of a matrix and put back.
constexpr double kSamePlace = 1e-12;

/// What a calibration meets: skew axes, sliding joints, mimic joints (one mimics another that
/// mimics), origins without xyz, without rpy, empty, missing; a joint on one line, tags over
/// several, both quotes, comments, and names that occur elsewhere.
constexpr const char* kDifficult = R"(<?xml version='1.0' ?>
<!-- <joint name="pan"><origin xyz="9 9 9"/></joint> -->
<robot name="difficult" xmlns:vendor='http://example.com'>
  <link name="l0"/><link name="l1"/><link name="l2"/><link name="l3"/><link name="l4"/>
  <link name="l5"/><link name="l6"/><link name="l7"/>
  <gazebo><joint name="pan"><origin xyz="8 8 8" rpy="0 0 0"/></joint></gazebo>
  <transmission name="t"><joint name="pan"><calibration rising="7"/></joint></transmission>
  <joint
     type="continuous" name="pan">
    <!-- > a "comment" with <origin xyz="1 2 3"/> -->
    <origin   rpy = "0.10  -0.20	0.30"
              xyz	=	'0.10
                   0.20 &#48;.30' vendor:note="a > b"   />
    <parent link="l0" />
    <child link="l1" />
    <axis xyz="1 2 3"><!-- </axis> --></axis>
    <dynamics damping="1"/>
  </joint>
  <joint name='lift' type='prismatic'>
    <origin xyz='0 0 0.500'/>
    <parent link='l1'/> <child link='l2'/>
    <axis xyz='0.6 0 0.8'/>
    <limit lower='0' upper='1' effort='1' velocity='1'/>
    <calibration falling='0.25'/>
  </joint>

  <joint name="elbow" type="continuous">

    <parent link="l2"/> <child link="l3"/>
    <axis xyz="-1 1 1"/><calibration  rising="1.50"  falling = "-2e0" />
    <vendor:data><![CDATA[ <origin xyz="5 5 5"/> ]]></vendor:data>
  </joint>
  <joint name="follower" type="continuous"><origin rpy="1.5707963267948966 0 0.1"/>
    <parent link="l3"/><child link="l4"/><axis xyz="0 1 0"/>
    <mimic joint="elbow" multiplier="-1.5" offset="0.2"/></joint>
  <joint name="slide" type="prismatic"><parent link="l4"/><child link="l5"/><axis xyz="1 1 0"/><limit lower="0" upper="1" effort="1" velocity="1"/><mimic joint="lift" multiplier="0.5"/></joint>
  <joint name="last" type="continuous"><origin/> <parent link="l5"/><child link="l6"/>
    <mimic joint="follower" multiplier="2"/></joint>
  <joint name="tool" type="fixed"><origin xyz="0 0 0.1" rpy="0 1.5707963267948966 0" /><parent link="l6"/><child link="l7"/></joint>
</robot>)";

std::string with_crlf(const std::string& text) {
  std::string result;
  for (char c : text) result += c == '\n' ? std::string("\r\n") : std::string(1, c);
  return result;
}

Pose<double> pose(const Vector3<double>& translation, const Vector3<double>& rotation) {
  return {exp(rotation), translation};
}

/// A correction of every joint but "last", offsets of those that may have one.
std::vector<JointPatch> all_patches() {
  return {{"pan", 0.11, pose({0.01, 0.02, -0.03}, {0.02, 0.01, -0.03})},
          {"lift", -0.04, pose({0.001, 0.0, 0.0}, {0.2, -0.1, 0.4})},
          {"elbow", 0.7, pose({0.0, 0.5, 0.0}, {-0.3, 0.0, 0.0})},
          {"follower", 0.0, pose({0.1, 0.2, 0.3}, {1.0, 2.0, 0.5})},
          {"slide", 0.0, pose({0.0, 0.0, 0.25}, {0.0, 0.0, 0.0})},
          {"tool", 0.0, pose({0.0, 0.0, 0.0}, {0.1, 0.2, 0.3})}};
}

/// Forward kinematics of the corrected robot, to each link: what a calibration believes.
std::vector<Pose<double>> corrected_kinematics(const Robot& robot,
                                               const std::vector<JointPatch>& patches,
                                               const std::map<std::string, double>& positions) {
  std::map<std::string, JointPatch> patch_of;
  std::set<std::string> corrected;
  for (const JointPatch& patch : patches) {
    patch_of[patch.joint] = patch;
    corrected.insert(patch.joint);
  }
  std::vector<Pose<double>> poses;
  for (const std::string& link : robot.link_names()) {
    const RuntimeChain chain = make_chain(robot, robot.joints().front().parent, link, corrected);
    Corrections<double> corrections(chain.joints.size());
    for (std::size_t i = 0; i < chain.joints.size(); ++i) {
      const ChainJoint& joint = chain.joints[i];
      corrections[i].frame = patch_of[joint.name].correction;
      corrections[i].offset =
          make_joint_state(joint.drive.multiplier * patch_of[joint.drive.joint].offset);
    }
    const auto position_of = [&](const std::string& name) { return positions.at(name); };
    poses.push_back(forward_kinematics(chain, position_of, corrections));
  }
  return poses;
}

/// Forward kinematics by the file alone, as a driver does it that adds `rising`.
std::vector<Pose<double>> kinematics_of_file(const std::string& text,
                                             std::map<std::string, double> positions) {
  const Robot robot = parse_urdf(text, "patched.urdf");
  const detail::UrdfText source(text, "patched.urdf");
  for (auto& [joint, position] : positions) {
    const pugi::xml_node calibration = source.joint(joint).child("calibration");
    position += calibration.attribute("rising").as_double();
  }
  return corrected_kinematics(robot, {}, positions);
}

void expect_equal(const std::vector<Pose<double>>& a, const std::vector<Pose<double>>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_LE((a[i].rotation - b[i].rotation).cwiseAbs().maxCoeff(), kSamePlace) << "link " << i;
    EXPECT_LE((a[i].translation - b[i].translation).cwiseAbs().maxCoeff(), kSamePlace)
        << "link " << i;
  }
}

std::string patched(const std::string& text, const std::vector<JointPatch>& patches,
                    OffsetStyle style = OffsetStyle::rising) {
  return patch_urdf(text, "arm.urdf", parse_urdf(text, "arm.urdf"), patches, style);
}

std::vector<std::string> lines_of(const std::string& text) {
  std::istringstream stream(text);
  std::vector<std::string> lines;
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  if (text.ends_with('\n')) lines.emplace_back();
  return lines;
}

/// "old -> new" of each line that differs; the texts have as many lines as each other.
std::vector<std::string> differences(const std::string& before, const std::string& after) {
  const std::vector<std::string> a = lines_of(before), b = lines_of(after);
  EXPECT_EQ(a.size(), b.size());
  std::vector<std::string> result;
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i) {
    if (a[i] != b[i]) result.push_back(a[i] + " -> " + b[i]);
  }
  return result;
}

/// Of the joints that mimic none, radians or metres.
const std::map<std::string, double> kPositions = {{"pan", 0.4}, {"lift", 0.3}, {"elbow", -1.1}};

/// Positions as a driver sees them that adds the `rising` of the file as it was.
std::map<std::string, double> measured_with(const std::string& text) {
  std::map<std::string, double> positions = kPositions;
  const detail::UrdfText source(text, "arm.urdf");
  for (auto& [joint, position] : positions) {
    position += source.joint(joint).child("calibration").attribute("rising").as_double();
  }
  return positions;
}

class PatchUrdfBothStyles : public testing::TestWithParam<std::tuple<OffsetStyle, bool>> {
 protected:
  const OffsetStyle style = std::get<0>(GetParam());
  const std::string text = std::get<1>(GetParam()) ? with_crlf(kDifficult) : kDifficult;
};

INSTANTIATE_TEST_SUITE_P(AndLineEnds, PatchUrdfBothStyles,
                         testing::Combine(testing::Values(OffsetStyle::rising, OffsetStyle::origin),
                                          testing::Bool()));

TEST_P(PatchUrdfBothStyles, TheFileReadAgainMovesLikeTheCorrectedRobot) {
  const Robot robot = parse_urdf(text, "arm.urdf");
  const std::string result = patch_urdf(text, "arm.urdf", robot, all_patches(), style);
  expect_equal(kinematics_of_file(result, kPositions),
               corrected_kinematics(robot, all_patches(), measured_with(text)));
}

TEST_P(PatchUrdfBothStyles, OffsetsPatchedTwiceAddUp) {
  std::vector<JointPatch> offsets = {{"pan", 0.1, {}}, {"lift", 0.02, {}}, {"elbow", 0.3, {}}};
  const std::string twice = patched(patched(text, offsets, style), offsets, style);
  for (JointPatch& patch : offsets) patch.offset *= 2.0;
  const std::string doubled = patched(text, offsets, style);
  expect_equal(kinematics_of_file(twice, kPositions), kinematics_of_file(doubled, kPositions));
}

TEST_P(PatchUrdfBothStyles, ASecondCalibrationGoesOnTopOfTheFirst) {
  const std::string once = patched(text, all_patches(), style);
  const std::string twice = patched(once, all_patches(), style);
  const Robot robot = parse_urdf(once, "arm.urdf");
  expect_equal(kinematics_of_file(twice, kPositions),
               corrected_kinematics(robot, all_patches(), measured_with(once)));
}

TEST_P(PatchUrdfBothStyles, APatchThatChangesNothingGivesTheSameBytes) {
  std::vector<JointPatch> patches;
  const Robot robot = parse_urdf(text, "arm.urdf");
  for (const Joint& joint : robot.joints()) patches.push_back({joint.name});
  EXPECT_EQ(patched(text, patches, style), text);
  EXPECT_EQ(patched(text, {}, style), text);
}

TEST_P(PatchUrdfBothStyles, LineEndsStayAsTheyAre) {
  const std::string result = patched(text, all_patches(), style);
  const bool crlf = std::get<1>(GetParam());
  for (std::size_t i = 0; i < result.size(); ++i) {
    if (result[i] != '\n') continue;
    EXPECT_EQ(i > 0 && result[i - 1] == '\r', crlf) << "at byte " << i;
  }
}

TEST(PatchUrdf, TheInverseCorrectionTakesAPatchBack) {
  std::vector<JointPatch> undo = all_patches();
  const std::string result = patched(kDifficult, undo);
  for (JointPatch& patch : undo) {
    patch.offset = -patch.offset;
    patch.correction = patch.correction.inverse();
  }
  expect_equal(kinematics_of_file(patched(result, undo), kPositions),
               kinematics_of_file(kDifficult, kPositions));
}

/// One joint between two links, on line 2.
std::string one_joint(const std::string& content, const std::string& type = "continuous") {
  return "<robot name='r'><link name='a'/><link name='b'/>\n  <joint name='j' type='" + type +
         "'>" + content + "</joint>\n</robot>\n";
}

const std::string kAB = "<parent link='a'/><child link='b'/>";

TEST(PatchUrdf, OnlyNumbersThatChangeAreRewritten) {
  const std::string text = one_joint("<origin rpy=\"0 0 0.10\"  xyz = '1.0\t2.00  3'/>" + kAB);
  EXPECT_EQ(patched(text, {{"j", 0.0, pose({0, 0, 0.5}, {0, 0, 0})}}),
            one_joint("<origin rpy=\"0 0 0.10\"  xyz = '1.0\t2.00  3.5'/>" + kAB));
  const std::string turned = patched(text, {{"j", 0.0, pose({0, 0, 0}, {0, 0, 0.25})}});
  EXPECT_THAT(turned, HasSubstr("  xyz = '1.0\t2.00  3'/>" + kAB));
  EXPECT_NEAR(rpy_from_rotation(parse_urdf(turned, "r").joint("j").origin.rotation).z(), 0.35,
              kSamePlace);
}

TEST(PatchUrdf, WritesTheShortestNumberThatReadsBackTheSame) {
  const double x = 0.1 + 0.2, y = 1e-7 / 3.0, z = 123456789.123456789;
  const std::string text =
      patched(one_joint("<origin xyz='0 0 0'/>" + kAB), {{"j", 0.0, pose({x, y, z}, {0, 0, 0})}});
  EXPECT_EQ(parse_urdf(text, "r").joint("j").origin.translation, Vector3<double>(x, y, z));
  EXPECT_THAT(patched(one_joint("<origin xyz='0 0 0'/>" + kAB),
                      {{"j", 0.0, pose({0.1, 0, -0.25}, {0, 0, 0})}}),
              HasSubstr("<origin xyz='0.1 0 -0.25'/>"));
}

TEST(PatchUrdf, ASlidingJointsOffsetShiftsItsOriginAndLimits) {
  const std::string rest = kAB + "<axis xyz='0 0 1'/><limit lower='";
  const std::string before = rest + "0' upper='1.0' effort='1' velocity='1'/>";
  const std::string after = rest + "-0.25' upper='0.75' effort='1' velocity='1'/>";
  EXPECT_EQ(patched(one_joint("<origin xyz='0 0 1' rpy='0 0 1.570'/>" + before, "prismatic"),
                    {{"j", 0.25, {}}}, OffsetStyle::origin),
            one_joint("<origin xyz='0 0 1.25' rpy='0 0 1.570'/>" + after, "prismatic"));
}

TEST(PatchUrdf, OffsetsInOriginsAllowTheSamePosesAsOnesInRising) {
  const std::vector<JointPatch> offset = {{"lift", 0.125, {}}};
  const Robot before = parse_urdf(kDifficult, "arm.urdf");
  const Robot rising = parse_urdf(patched(kDifficult, offset), "arm.urdf");
  const Robot origin = parse_urdf(patched(kDifficult, offset, OffsetStyle::origin), "arm.urdf");
  EXPECT_EQ(rising.joint("lift").limits->upper, before.joint("lift").limits->upper);
  // positions are readings now, which are lower by the offset; "slide" follows by half of it
  EXPECT_EQ(origin.joint("lift").limits->lower, before.joint("lift").limits->lower - 0.125);
  EXPECT_EQ(origin.joint("lift").limits->upper, before.joint("lift").limits->upper - 0.125);
  EXPECT_EQ(origin.joint("slide").limits->upper, before.joint("slide").limits->upper - 0.0625);
}

TEST(PatchUrdf, SoftLimitsMoveWithTheLimits) {
  const std::string text = one_joint(
      kAB +
          "<limit lower='-1' upper='1' effort='1' velocity='1'/>"
          "<safety_controller soft_lower_limit='-0.5' soft_upper_limit='0.5' k_velocity='1'/>",
      "revolute");
  EXPECT_THAT(patched(text, {{"j", 0.25, {}}}, OffsetStyle::origin),
              AllOf(HasSubstr("lower='-1.25' upper='0.75' effort"),
                    HasSubstr("soft_lower_limit='-0.75' soft_upper_limit='0.25' k_velocity")));
}

TEST(PatchUrdf, ATurningJointsOffsetTurnsItsOriginOnly) {
  const std::string rest = kAB + "<axis xyz='0 0 1'/>";
  EXPECT_EQ(patched(one_joint("<origin xyz='0 0 1.0' rpy='0 0 0'/>" + rest), {{"j", 0.25, {}}},
                    OffsetStyle::origin),
            one_joint("<origin xyz='0 0 1.0' rpy='0 0 0.25'/>" + rest));
}

/// One joint that ros2_control drives.
std::string driven_joint(const std::string& content, const std::string& calibration = "") {
  std::string text = one_joint(kAB + calibration);
  const std::string control = "  <ros2_control name='arm'>" + content + "</ros2_control>\n";
  return text.insert(text.rfind("</robot>"), control);
}

TEST(PatchUrdfRos2Control, AddsToTheOffsetOfAJoint) {
  const std::string before = "<joint name='j'>\n<param name='id'>3</param><param name='offset'> ";
  const std::string after = " </param><param name='gear'>2</param></joint>";
  EXPECT_EQ(
      patched(driven_joint(before + "0.50" + after), {{"j", 0.25, {}}}, OffsetStyle::ros2_control),
      driven_joint(before + "0.75" + after));
}

TEST(PatchUrdfRos2Control, AddsToTheOffsetsOfPositionInterfacesOnly) {
  const auto content = [](const std::string& offset) {
    const std::string param = "<param name='offset'>" + offset + "</param>";
    return "<joint name='j'><command_interface name='position'>" + param +
           "</command_interface><state_interface name='position'>" + param +
           "</state_interface><state_interface name='velocity'><param name='offset'>0</param>"
           "</state_interface></joint>";
  };
  EXPECT_EQ(patched(driven_joint(content("0")), {{"j", 0.25, {}}}, OffsetStyle::ros2_control),
            driven_joint(content("0.25")));
}

TEST(PatchUrdfRos2Control, CreatesAMissingOffsetFirstInTheJoint) {
  const std::vector<JointPatch> offset = {{"j", 0.25, {}}};
  const auto patch = [&](const std::string& content) {
    return patched(driven_joint(content), offset, OffsetStyle::ros2_control);
  };
  EXPECT_EQ(patch("\n    <joint name=\"j\">\n      <param name=\"id\">1</param>\n    </joint>\n  "),
            driven_joint("\n    <joint name=\"j\">\n      <param name=\"offset\">0.25</param>\n"
                         "      <param name=\"id\">1</param>\n    </joint>\n  "));
  EXPECT_EQ(patch("<joint name='j' />"),
            driven_joint("<joint name='j'><param name='offset'>0.25</param></joint>"));
}

TEST(PatchUrdfRos2Control, IsChosenForJointsThatHaveAnOffsetThere) {
  const std::vector<JointPatch> offset = {{"j", 0.25, {}}};
  const std::string with = driven_joint("<joint name='j'><param name='offset'>0</param></joint>");
  const std::string without = driven_joint("<joint name='j'/>");
  EXPECT_EQ(patched(with, offset, OffsetStyle::as_read),
            patched(with, offset, OffsetStyle::ros2_control));
  EXPECT_EQ(patched(without, offset, OffsetStyle::as_read),
            patched(without, offset, OffsetStyle::rising));
  const std::string calibrated = driven_joint("", "<calibration rising='0'/>");
  const auto places = [&](const std::string& text) {
    return offset_places(text, "arm.urdf", parse_urdf(text, "arm.urdf"), offset);
  };
  EXPECT_THAT(places(with).ros2_control, ElementsAre("j"));
  EXPECT_THAT(places(with).rising, ElementsAre());
  EXPECT_THAT(places(without).rising, ElementsAre("j"));
  EXPECT_FALSE(places(without).has_calibration);
  EXPECT_TRUE(places(calibrated).has_calibration);
}

TEST(PatchUrdfRos2Control, AnOffsetInTicksIsLeftToItsDriver) {
  const std::string text =
      driven_joint("<joint name='j'><param name='offset'>2048</param></joint>");
  const std::vector<JointPatch> offset = {{"j", 0.25, {}}};
  EXPECT_EQ(patched(text, offset, OffsetStyle::as_read), patched(text, offset));
  EXPECT_EQ(
      test::thrown<InputError>([&] { (void)patched(text, offset, OffsetStyle::ros2_control); }),
      "arm.urdf:3: joint 'j': offset '2048' of <ros2_control> is not in "
      "radians; use --offsets origin");
}

TEST(PatchUrdfRos2Control, AJointThatItDoesNotHaveIsAnError) {
  EXPECT_THAT(test::thrown<InputError>([&] {
                (void)patched(driven_joint("<joint name='jj'/>"), {{"j", 0.25, {}}},
                              OffsetStyle::ros2_control);
              }),
              AllOf(StartsWith("arm.urdf: <ros2_control> has no joint 'j'"),
                    HasSubstr("--offsets origin")));
}

TEST(PatchUrdfRos2Control, OffsetsAreReadBack) {
  const std::string text = driven_joint(
      "<joint name='j'><param name='offset'>0.5</param></joint>"
      "<joint name='k'><param name='offset'>0</param></joint>");
  EXPECT_THAT(ros2_control_offsets(text, "arm.urdf"), ElementsAre(testing::Pair("j", 0.5)));
}

TEST(CalibratedOrigins, AreThoseOfTheFileWithOffsetsInOrigins) {
  const Robot robot = parse_urdf(kDifficult, "arm.urdf");
  const auto origins = calibrated_origins(robot, all_patches());
  const Robot written =
      parse_urdf(patched(kDifficult, all_patches(), OffsetStyle::origin), "arm.urdf");
  ASSERT_EQ(origins.size(), robot.joints().size());
  std::vector<Pose<double>> expected, found;
  for (const Joint& joint : written.joints()) {
    expected.push_back(joint.origin);
    found.push_back(origins.at(joint.name));
  }
  expect_equal(found, expected);
}

TEST(PatchUrdf, CreatesMissingAttributesBehindTheOthers) {
  const Pose<double> shift = pose({1, 2, 3}, {0, 0, 0});
  EXPECT_EQ(patched(one_joint("<origin/>" + kAB), {{"j", 0.0, shift}}),
            one_joint("<origin xyz='1 2 3'/>" + kAB));
  EXPECT_EQ(patched(one_joint("<origin rpy=\"0 0 0.0\" />" + kAB), {{"j", 0.0, shift}}),
            one_joint("<origin rpy=\"0 0 0.0\" xyz=\"1 2 3\" />" + kAB));
  EXPECT_EQ(patched(one_joint("<origin></origin>" + kAB), {{"j", 0.0, shift}}),
            one_joint("<origin xyz='1 2 3'></origin>" + kAB));
}

TEST(PatchUrdf, CreatesAMissingOriginInTheMannerOfItsNeighbours) {
  const std::vector<JointPatch> shift = {{"j", 0.0, pose({1, 2, 3}, {0, 0, 0})}};
  EXPECT_EQ(patched(one_joint(kAB), shift), one_joint("<origin xyz='1 2 3' rpy='0 0 0'/>" + kAB));
  EXPECT_EQ(patched(one_joint("\r\n\r\n\t<parent link=\"a\" />\r\n\t<child link=\"b\" />"), shift),
            one_joint("\r\n\t<origin xyz=\"1 2 3\" rpy=\"0 0 0\" />\r\n\r\n\t<parent link=\"a\" />"
                      "\r\n\t<child link=\"b\" />"));
}

TEST(PatchUrdf, AddsToRisingAndToFallingWhereItStands) {
  const std::vector<JointPatch> offset = {{"j", 0.25, {}}};
  const auto calibration = [](const std::string& c) { return one_joint(kAB + c); };
  EXPECT_EQ(patched(calibration("<calibration rising='1.0'/>"), offset),
            calibration("<calibration rising='1.25'/>"));
  EXPECT_EQ(patched(calibration("<calibration falling=\"2\" rising='-1.0' />"), offset),
            calibration("<calibration falling=\"2.25\" rising='-0.75' />"));
  EXPECT_EQ(patched(calibration("<calibration falling='2'/>"), offset),
            calibration("<calibration falling='2.25' rising='0.25'/>"));
  EXPECT_EQ(patched(calibration("<calibration></calibration>"), offset),
            calibration("<calibration rising='0.25'></calibration>"));
}

TEST(PatchUrdf, CreatesAMissingCalibrationBehindTheAxis) {
  const std::vector<JointPatch> offset = {{"j", 0.25, {}}};
  EXPECT_EQ(patched(one_joint(kAB), offset), one_joint(kAB + "<calibration rising='0.25'/>"));
  EXPECT_EQ(patched(one_joint("\n    " + kAB +
                              "\n    <axis xyz=\"0 0 1\" ><!-- </axis> --></axis>\n"
                              "    <limit effort='1' velocity='1'/>\n  "),
                    offset),
            one_joint("\n    " + kAB +
                      "\n    <axis xyz=\"0 0 1\" ><!-- </axis> --></axis>\n"
                      "    <calibration rising=\"0.25\"/>\n"
                      "    <limit effort='1' velocity='1'/>\n  "));
}

TEST(PatchUrdf, JointsElsewhereInTheFileAreLeftAlone) {
  const std::string result = patched(kDifficult, {{"pan", 0.25, pose({1, 1, 1}, {0, 0, 0})}});
  EXPECT_THAT(
      result,
      AllOf(HasSubstr("<origin xyz=\"9 9 9\"/>"),
            HasSubstr("<origin xyz=\"8 8 8\" rpy=\"0 0 0\"/>"),
            HasSubstr("<calibration rising=\"7\"/>"), HasSubstr("with <origin xyz=\"1 2 3\"/>"),
            HasSubstr("rpy = \"0.10  -0.20\t0.30\""), HasSubstr("vendor:note=\"a > b\"   />")));
}

TEST(PatchUrdf, AByteOrderMarkAndOtherEncodingsStay) {
  const std::string text = "\xEF\xBB\xBF<?xml version='1.0' encoding='ISO-8859-1'?><!-- \xE9 -->" +
                           one_joint("<origin xyz='1 0 0'/>" + kAB);
  std::string expected = text;
  expected.replace(expected.find("xyz='1"), 6, "xyz='3");
  EXPECT_EQ(patched(text, {{"j", 0.0, pose({2, 0, 0}, {0, 0, 0})}}), expected);
}

TEST(PatchUrdf, DoesNotDependOnTheLocale) {
  struct DecimalComma : std::numpunct<char> {
    char do_decimal_point() const override { return ','; }
    char do_thousands_sep() const override { return '.'; }
    std::string do_grouping() const override { return "\3"; }
  };
  const std::locale before =
      std::locale::global(std::locale(std::locale::classic(), new DecimalComma));
  const std::string result = patched(one_joint("<origin xyz='0 0 0'/>" + kAB),
                                     {{"j", 0.0, pose({0.5, 12345.5, 0}, {0, 0, 0})}});
  std::locale::global(before);
  EXPECT_THAT(result, HasSubstr("xyz='0.5 12345.5 0'"));
}

TEST(PatchUrdf, OnFetchOnlyTheLinesOfThePatchedJointsChange) {
  KINECAL_NEEDS_DATA("fetch");
  const std::string path = (test::data_folder() / "fetch/fetch.urdf").string();
  std::ifstream file(path, std::ios::binary);
  const std::string text(std::istreambuf_iterator<char>(file), {});
  const Robot robot = read_urdf(path);
  const std::vector<JointPatch> patches = {
      {"torso_lift_joint", 0.0, pose({0, 0, 0.01}, {0, 0, 0})},
      {"head_camera_rgb_joint", 0.0, pose({0.001, 0.002, 0.003}, {0.01, 0, 0})},
      {"shoulder_pan_joint", 0.125, {}}};
  const std::string rising = patch_urdf(text, path, robot, patches, OffsetStyle::rising);
  const std::string in_origin = patch_urdf(text, path, robot, patches, OffsetStyle::origin);
  const std::string torso = "    <origin rpy=\"-6.123E-17 0 0\" xyz=\"-0.086875 ";
  EXPECT_THAT(differences(text, in_origin),
              ElementsAre(AllOf(StartsWith(torso + "0 0.37743\" />"), HasSubstr(" -> " + torso)),
                          AllOf(HasSubstr("<origin rpy="), HasSubstr(" xyz=\"0.119525 ")),
                          HasSubstr("lower=\"-1.7306\" upper=\"1.4806\""),
                          StartsWith("    <origin rpy=\"")));
  std::string without_calibration = rising;
  const std::string created = "\n    <calibration rising=\"0.125\" />";
  ASSERT_NE(rising.find(created), std::string::npos);
  without_calibration.erase(rising.find(created), created.size());
  EXPECT_EQ(differences(text, without_calibration).size(), 2u);
  std::map<std::string, double> positions;
  for (const Joint& joint : robot.joints()) positions[joint.name] = 0.1;
  const auto expected = corrected_kinematics(robot, patches, positions);
  expect_equal(kinematics_of_file(rising, positions), expected);
  expect_equal(kinematics_of_file(in_origin, positions), expected);
}

std::string refusal(const std::string& text, const std::vector<JointPatch>& patches) {
  try {
    return "accepted: " + patched(text, patches);
  } catch (const InputError& e) {
    return e.what();
  }
}

TEST(PatchUrdfError, AJointThatIsNotInTheFile) {
  EXPECT_THAT(refusal(kDifficult, {{"elbo"}}), "arm.urdf: no joint 'elbo'; did you mean 'elbow'?");
  const Robot robot = parse_urdf(kDifficult, "arm.urdf");
  EXPECT_THROW(
      (void)patch_urdf(one_joint(kAB), "other.urdf", robot, {{"pan", 0.1}}, OffsetStyle::origin),
      InputError);
  EXPECT_THROW((void)patch_urdf(one_joint(kAB), "other.urdf", robot, {{"j"}}, OffsetStyle::origin),
               InputError);
}

TEST(PatchUrdfError, AnOffsetOfAJointWithoutItsOwnPosition) {
  EXPECT_THAT(refusal(one_joint(kAB, "fixed"), {{"j", 0.1}}),
              StartsWith("arm.urdf:2: joint 'j' is fixed"));
  EXPECT_THAT(refusal(kDifficult, {{"last", 0.1}}),
              AllOf(StartsWith("arm.urdf:"), HasSubstr("'last'"), HasSubstr("'elbow'")));
}

TEST(PatchUrdfError, TwoPatchesOfOneJoint) {
  EXPECT_THAT(refusal(one_joint(kAB), {{"j", 0.1}, {"j", 0.2}}),
              "arm.urdf:2: joint 'j' is given two calibrations");
}

TEST(PatchUrdfError, ACalibrationThatIsNotFinite) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(refusal(one_joint(kAB), {{"j", nan}}),
              "arm.urdf:2: the calibration of joint 'j' is not finite");
  EXPECT_THAT(refusal(one_joint(kAB), {{"j", 0.0, pose({0, nan, 0}, {0, 0, 0})}}),
              "arm.urdf:2: the calibration of joint 'j' is not finite");
}

TEST(PatchUrdfError, NumbersToBeChangedThatCannotBeRead) {
  const std::string good = one_joint("\n<origin xyz='1 2 3'/>" + kAB);
  const Robot robot = parse_urdf(good, "arm.urdf");
  std::string bad = good;
  bad.replace(bad.find("1 2 3"), 5, "1 2 ${z}");
  const auto patch = [&](const std::vector<JointPatch>& patches) {
    return patch_urdf(bad, "arm.urdf", robot, patches, OffsetStyle::rising);
  };
  EXPECT_NO_THROW((void)patch({{"j", 0.1}})) << "an origin that stays is not looked at";
  EXPECT_THAT(test::thrown<InputError>([&] {
                (void)patch({{"j", 0.0, pose({1, 0, 0}, {0, 0, 0})}});
              }),
              AllOf(StartsWith("arm.urdf:3: joint 'j'"), HasSubstr("${z}"),
                    HasSubstr("run xacro on it first")));
}

/// A driver and two mimic joints, the second of which mimics the first.
constexpr const char* kMimics = R"(<robot name="hand">
  <link name="a"/><link name="b"/><link name="c"/><link name="d"/>
  <joint name="j" type="revolute"><parent link="a"/><child link="b"/><axis xyz="0 0 1"/>
    <limit lower="-2" upper="2" effort="1" velocity="1"/></joint>
  <joint name="k" type="continuous"><parent link="b"/><child link="c"/><axis xyz="0 0 1"/>
    <mimic joint="j" multiplier="2.00"/></joint>
  <joint name="l" type="continuous"><parent link="c"/><child link="d"/><axis xyz="0 0 1"/>
    <mimic multiplier="-0.5" joint="k" offset="0.1"/></joint>
</robot>
)";

TEST(PatchUrdfMimic, HoldsTheErrorsOfAMimicJointWhereverZerosGo) {
  const Robot before = parse_urdf(kMimics, "hand.urdf");
  const JointPatch driver{"j", 0.25, {}}, k{"k", 0.0, {}, 0.1, 0.05}, l{"l", 0.0, {}, -0.02, 0.0};
  const double q = 0.7;  // a reading of j
  // What a joint model computes: the URDF's mimic of the true position, and errors of the reading.
  const double true_k = 2.0 * (q + 0.25) + 0.1 * q + 0.05;
  const double true_l = -0.5 * 2.0 * (q + 0.25) + 0.1 - 0.02 * q;
  for (const OffsetStyle style : {OffsetStyle::rising, OffsetStyle::origin}) {
    const std::string text = patch_urdf(kMimics, "hand.urdf", before, {driver, k, l}, style);
    const Robot after = parse_urdf(text, "hand.urdf");
    const bool is_published = style == OffsetStyle::rising;
    const double published = is_published ? q + 0.25 : q;
    const auto position = [&](const std::string& joint, double in_origin) {
      const Mimic by = drive(after, after.joint(joint));
      return by.multiplier * published + by.offset + (is_published ? 0.0 : in_origin);
    };
    EXPECT_NEAR(position("k", 2.0 * 0.25), true_k, kSamePlace) << text;
    EXPECT_NEAR(position("l", -0.5 * 2.0 * 0.25), true_l, kSamePlace) << text;
  }
}

TEST(PatchUrdfMimic, NumbersThatDoNotChangeKeepTheirText) {
  const Robot robot = parse_urdf(kMimics, "hand.urdf");
  std::string expected = kMimics;
  expected.replace(expected.find("offset=\"0.1\""), 12, "offset=\"0.125\"");
  EXPECT_EQ(
      patch_urdf(kMimics, "hand.urdf", robot, {{"l", 0.0, {}, 0.0, 0.025}}, OffsetStyle::rising),
      expected);
  const std::string of_k =
      patch_urdf(kMimics, "hand.urdf", robot, {{"k", 0.0, {}, 0.0, 0.5}}, OffsetStyle::rising);
  EXPECT_THAT(of_k, HasSubstr("<mimic joint=\"j\" multiplier=\"2.00\" offset=\"0.5\"/>"));
  EXPECT_THAT(of_k, HasSubstr("<mimic multiplier=\"-0.5\" joint=\"k\" offset=\"0.35\"/>"))
      << "the position of l stays";
}

TEST(PatchUrdfMimic, AJointThatDoesNotMimicIsAnError) {
  const Robot robot = parse_urdf(kMimics, "hand.urdf");
  EXPECT_EQ(test::thrown<InputError>([&] {
              (void)patch_urdf(kMimics, "hand.urdf", robot, {{"j", 0.0, {}, 0.1, 0.0}},
                               OffsetStyle::rising);
            }),
            "hand.urdf:3: joint 'j' does not mimic another: it has no <mimic> to correct");
}

}  // namespace
}  // namespace kinecal
