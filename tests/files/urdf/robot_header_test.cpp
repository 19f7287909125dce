#include "kinecal/files/urdf/robot_header.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "kinecal/files/urdf/cpp_text.ipp"
#include "kinecal/files/urdf/read_urdf.hpp"
#include "kinecal/kinematics/robot_data.hpp"
#include "robots/every_joint.hpp"
#include "support/data.hpp"
#include "support/paths.hpp"
#include "support/same_joint.hpp"
#if __has_include("robots/fetch_data.hpp")
#include "robots/fetch_data.hpp"
#endif

namespace kinecal {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

const std::string kEveryJoint = test::source_folder() + "/tests/io/urdf/every_joint.urdf";

/// Every joint of the header is that of the URDF, and the other way round.
template <RobotData R>
void expect_same(const Robot& robot) {
  EXPECT_EQ(R::kName, robot.name());
  ASSERT_EQ(R::kJoints.size(), robot.joints().size());
  const Robot at_run_time = robot_from<R>();
  for (const JointData& data : R::kJoints) {
    const std::string name(data.name);
    EXPECT_TRUE(test::same_joint(data, robot.joint(name)));
    EXPECT_TRUE(test::same_joint(data, at_run_time.joint(name)));
  }
}

TEST(RobotHeader, HoldsWhatReadUrdfReadsBitByBit) {
  expect_same<every_joint_v2::Robot>(read_urdf(kEveryJoint));
}

TEST(RobotHeader, HoldsFetchBitByBit) {
  KINECAL_NEEDS_DATA("fetch");
#if __has_include("robots/fetch_data.hpp")
  expect_same<fetch::Robot>(read_urdf((test::data_folder() / "fetch/fetch.urdf").string()));
#else
  GTEST_SKIP() << "data set 'fetch' was absent when the tests were configured";
#endif
}

TEST(RobotHeader, TheJointsAreConstant) {
  constexpr auto& joints = every_joint_v2::Robot::kJoints;
  static_assert(joints.size() == 8);
  static_assert(joints[2].name == "elbow" && joints[2].limits->upper == 0.1 + 0.2);
  static_assert(joints[4].mimic->joint == "finger \"left\"" && !joints[4].mimic->joint.empty());
  static_assert(joints[5].name ==
                "Kamera \xC3\xBC"
                "brig");
}

TEST(RobotHeader, ParentsStandBeforeChildrenOtherwiseAsInTheText) {
  const Robot robot = read_urdf(kEveryJoint);
  std::vector<std::string> names;
  for (const Joint* joint : detail::joints_parents_first(robot)) names.push_back(joint->name);
  EXPECT_THAT(names, ElementsAre("torso", "shoulder", "elbow", "finger \"left\"",
                                 "finger \\right\\", "Kamera übrig", "float?\?/ing", "%d {} \\n"));
  EXPECT_THAT(robot.joint_names().front(), "elbow");
}

TEST(RobotHeader, NumbersKeepTheirSignAndAreNoIntegers) {
  const std::vector<double> numbers = {-0.0, 1.0, -2.0, 0.1, 1e15, 1e16, 1.25e-300, 1.0 / 3.0};
  EXPECT_EQ(detail::cpp_numbers(numbers),
            "-0.0, 1.0, -2.0, 0.1, 1000000000000000.0, 1.e+16, 1.25e-300, 0.3333333333333333");
}

TEST(RobotHeader, StringsAreEscaped) {
  EXPECT_EQ(detail::cpp_string("a \"b\" \\c ?\?/ \n1 \xC3\xBC"),
            R"("a \"b\" \\c \?\?/ \0121 \303\274")");
}

TEST(RobotHeader, ANameBecomesANamespace) {
  const auto namespace_of = [](const std::string& name, const std::string& asked_for = "") {
    return detail::robot_namespace(detail::UrdfText("<robot name='" + name + "'/>", "a.urdf"),
                                   asked_for);
  };
  EXPECT_EQ(namespace_of("fetch"), "fetch");
  EXPECT_EQ(namespace_of("UR5-e  (left)"), "UR5_e_left");
  EXPECT_EQ(namespace_of("_a__b_"), "a_b");
  EXPECT_EQ(namespace_of("7 arms", "seven::arms"), "seven::arms");
  for (const char* name : {"7 arms", "class", "kinecal", "std", "---", "机器人"}) {
    EXPECT_THROW((void)namespace_of(name), InputError) << name;
  }
  for (const char* name : {"a b", "a:b", "a::", "::a", "a::new", "a-b", "7", "a;b", "a\n"}) {
    EXPECT_THROW((void)namespace_of("fetch", name), InputError) << name;
  }
}

}  // namespace
}  // namespace kinecal
