#include "kinecal/files/results/transform_files.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include <map>
#include <nlohmann/json.hpp>
#include <pugixml.hpp>

#include "kinecal/files/json/json_text.hpp"
#include "kinecal/files/urdf/read_urdf.hpp"
#include "kinecal/geometry/rpy.hpp"
#include "kinecal/parameters/parameter_table.hpp"
#include "support/hostile_names.hpp"
#include "support/shell_words.hpp"

namespace kinecal {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

/// A flange, and a camera on it or beside it; the camera's joint is calibrated by half a turn about z.
std::map<std::string, std::string> files(bool on_hand, bool has_poses = true,
                                         const std::string& camera = "my camera") {
  const Robot robot("r", {{"flange_joint", JointType::floating, "base", "flange", {}},
                          {"camera_joint",
                           JointType::fixed,
                           on_hand ? "flange" : "base",
                           camera,
                           {Matrix3<double>::Identity(), {0.0, 0.25, 0.0}}}});
  ParameterTable table;
  for (const auto axis : kFrameAxes) table.add({.name = parameter_name("camera_joint", axis)});
  table["camera_joint_x"].value = 0.5;
  table["camera_joint_c"].value = 3.14159265358979323846;
  std::vector<Sample> samples(2);
  if (has_poses) samples[1].poses["flange_joint"] = {};
  std::map<std::string, std::string> all;
  for (const OutputFile& file : transform_files(robot, table, samples)) {
    all[file.name] = file.content;
  }
  return all;
}

TEST(TransformFiles, HaveThePoseOfTheCameraInEachForm) {
  const auto all = files(true);
  ASSERT_EQ(all.size(), 7u);
  EXPECT_THAT(all.at("camera_joint.sh"),
              HasSubstr("ros2 run tf2_ros static_transform_publisher --x 0.5 --y 0.25 --z 0 "));
  EXPECT_THAT(all.at("camera_joint.sh"),
              HasSubstr("--frame-id flange --child-frame-id 'my camera'"));
  EXPECT_THAT(all.at("camera_joint.launch.py"), HasSubstr("\"--child-frame-id\""));
  EXPECT_THAT(all.at("camera_joint.launch.py"), HasSubstr("\"my camera\"]"));
  EXPECT_THAT(all.at("camera_joint.txt"), HasSubstr("0 0 0 1\n"));
  EXPECT_THAT(all.at("camera_joint.txt"), testing::StartsWith("-1 "));
  EXPECT_THAT(all.at("camera_joint.launch"), HasSubstr("flange 'my camera'\"/>"));
  EXPECT_THAT(all.at("camera_joint.calib"), HasSubstr("calibration_type: eye_in_hand"));
  EXPECT_THAT(files(false).at("camera_joint.calib"), HasSubstr("calibration_type: eye_on_base"));
  EXPECT_THAT(all.at("camera_joint.easy_handeye.yaml"), HasSubstr("eye_on_hand: true"));
  EXPECT_THAT(all.at("camera_joint.easy_handeye.yaml"), HasSubstr("robot_effector_frame: flange"));
  EXPECT_THAT(files(false).at("camera_joint.easy_handeye.yaml"), HasSubstr("eye_on_hand: false"));
}

TEST(TransformFiles, TheJointIsOneOfAUrdf) {
  const std::string urdf = "<robot name='r'><link name='flange'/><link name='my camera'/>" +
                           files(true).at("camera_joint.xml") + "</robot>";
  const Joint joint = parse_urdf(urdf, "r.urdf").joint("camera_joint");
  EXPECT_EQ(joint.parent, "flange");
  EXPECT_EQ(joint.origin.translation, Vector3<double>(0.5, 0.25, 0.0));
  EXPECT_NEAR(joint.origin.rotation(0, 0), -1.0, 1e-15);
}

/// The last of some words.
std::string last(const test::PastedCommand& command) {
  EXPECT_FALSE(command.did_more);
  return command.words.empty() ? "" : command.words.back();
}

TEST(TransformFiles, HaveTheNameOfTheCameraInEachFormWhateverItIs) {
  for (const std::string& name : test::kHostileNames) {
    const auto all = files(true, true, name);
    EXPECT_EQ(last(test::paste(all.at("camera_joint.sh"))), name);
    pugi::xml_document joint, launch;
    ASSERT_TRUE(joint.load_string(all.at("camera_joint.xml").c_str())) << name;
    EXPECT_EQ(joint.select_node("//child/@link").attribute().value(), name);
    ASSERT_TRUE(launch.load_string(all.at("camera_joint.launch").c_str())) << name;
    const std::string args = launch.select_node("//node/@args").attribute().value();
    EXPECT_EQ(last(test::paste(args)), name);
    EXPECT_THAT(args, Not(HasSubstr("$("))) << "roslaunch would substitute it";
    const std::string& python = all.at("camera_joint.launch.py");
    const std::size_t open = python.find("arguments=[") + 10;
    EXPECT_EQ(detail::Json::parse(python.substr(open, python.find("],\n", open) + 1 - open)).back(),
              name);
    for (const char* file : {"camera_joint.easy_handeye.yaml", "camera_joint.calib"}) {
      EXPECT_EQ(YAML::Load(all.at(file))["parameters"]["tracking_base_frame"].as<std::string>(),
                name);
    }
  }
}

TEST(TransformFiles, ThereAreNoneWithoutMeasuredPoses) {
  EXPECT_THAT(files(true, false), IsEmpty());
}

}  // namespace
}  // namespace kinecal
