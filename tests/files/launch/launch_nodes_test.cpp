#include "kinecal/files/launch/launch_nodes.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <map>
#include <string>

#include "support/temporary_folder.hpp"

namespace kinecal {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::Pair;

/// A package with a launch file in it.
class LaunchNodesTest : public test::FolderTest {
 protected:
  LaunchNodesTest() { std::filesystem::create_directories(folder_ / "fetch_calibration/launch"); }

  [[nodiscard]] LaunchNodes nodes(const std::string& text,
                                  const std::map<std::string, std::string>& given = {}) {
    write("fetch_calibration/launch/capture.launch", text);
    diagnostics_ = {};
    return read_launch_nodes(file(), given, {"robot_calibration", "rosbag"}, diagnostics_);
  }
  [[nodiscard]] std::string file() const {
    return (folder_ / "fetch_calibration/launch/capture.launch").string();
  }
  /// The error without the name of the file.
  [[nodiscard]] std::string error_of(const std::string& text,
                                     const std::map<std::string, std::string>& given = {}) {
    (void)nodes(text, given);
    if (diagnostics_.errors.size() != 1) return std::to_string(diagnostics_.errors.size());
    return diagnostics_.errors.front().substr(file().size() + 1);
  }

  Diagnostics diagnostics_;
};

/// As Fetch's: a node of a package that is not here, an include, a recorder.
constexpr const char* kLaunch = R"xml(<launch>
  <arg name="velocity_factor" default="1.0" />
  <arg name="other" default="$(find nowhere)/x" />
  <arg name="poses" value="$(find fetch_calibration)/config/poses.bag" />
  <node pkg="nowhere" type="camera" name="camera" args="$(find nowhere)/config.yaml" />
  <rosparam command="delete" param="robot_calibration" />
  <rosparam file="$(dirname)/all.yaml" ns="robot_calibration" />
  <rosparam file="other.yaml" ns="robot" />
  <param name="robot_calibration/verbose" value="true" />
  <param name="robot_description" textfile="$(dirname)/robot.urdf" />
  <node pkg="robot_calibration" type="calibrate" name="robot_calibration"
        args="$(arg poses) 'a word'" output="screen" required="true">
    <param name="velocity_factor" value="$(arg velocity_factor)" />
    <param name="never" command="rm -rf /" />
    <rosparam file="$(find fetch_calibration)/config/capture.yaml" command="load" />
    <remap from="joint_states" to="$(optenv KINECAL_NO_SUCH /arm/joint_states)" />
  </node>
  <node pkg="rosbag" type="record" name="bagger" args="--bz2 -o /tmp/x/data" unless="false" />
  <node pkg="rosbag" type="record" name="none" if="$(arg no)" />
  <arg name="no" default="0" />
  <include file="$(find fetch_moveit_config)/launch/move_group.launch" />
</launch>)xml";

TEST_F(LaunchNodesTest, HaveWhatRoslaunchGivesThem) {
  const LaunchNodes launch = nodes(kLaunch);
  EXPECT_THAT(diagnostics_.errors, IsEmpty());
  ASSERT_EQ(launch.nodes.size(), 2U);
  const LaunchNode& node = launch.nodes[0];
  const std::string package = (folder_ / "fetch_calibration").string();
  EXPECT_EQ(node.type, "calibrate");
  EXPECT_EQ(node.name, "robot_calibration");
  EXPECT_THAT(node.arguments, ElementsAre(package + "/config/poses.bag", "a word"));
  EXPECT_THAT(node.parameters,
              ElementsAre(Pair("velocity_factor", "1.0"), Pair("verbose", "true")));
  EXPECT_THAT(node.parameter_files,
              ElementsAre(package + "/launch/all.yaml", package + "/config/capture.yaml"));
  EXPECT_THAT(node.remaps, ElementsAre(Pair("joint_states", "/arm/joint_states")));
  EXPECT_EQ(node.place.line, 11);
  EXPECT_EQ(launch.robot_description, package + "/launch/robot.urdf");
  EXPECT_THAT(launch.nodes[1].arguments, ElementsAre("--bz2", "-o", "/tmp/x/data"));
  EXPECT_THAT(launch.included, ElementsAre("$(find fetch_moveit_config)/launch/move_group.launch"));
}

TEST_F(LaunchNodesTest, TakeArgumentsAndNamespaces) {
  const std::string grouped =
      "<launch><arg name='v'/><group ns='fetch'><rosparam file='a.yaml' ns='cal'/>"
      "<node pkg='robot_calibration' type='calibrate' name='cal'>"
      "<param name='velocity_factor' value='$(arg v)'/></node></group></launch>";
  const LaunchNodes launch = nodes(grouped, {{"v", "0.5"}});
  EXPECT_THAT(diagnostics_.errors, IsEmpty());
  ASSERT_EQ(launch.nodes.size(), 1U);
  EXPECT_EQ(launch.nodes[0].name, "fetch/cal");
  EXPECT_THAT(launch.nodes[0].parameters, ElementsAre(Pair("velocity_factor", "0.5")));
  EXPECT_THAT(launch.nodes[0].parameter_files, ElementsAre("a.yaml"));
  EXPECT_EQ(error_of(grouped), "1: argument 'v' has no value; give it: v:=VALUE");
  EXPECT_EQ(error_of(kLaunch, {{"velocity_facto", "1"}}),
            " has no argument 'velocity_facto'; did you mean 'velocity_factor'?");
}

TEST_F(LaunchNodesTest, NameWhatCannotBeRead) {
  const auto with_args = [](const std::string& args) {
    return "<launch>\n<arg name='turns' default='$(arg turns)'/>\n"
           "<node pkg='robot_calibration' type='calibrate' name='c' args='" +
           args + "'/>\n</launch>";
  };
  EXPECT_EQ(error_of(with_args("$(arg turn)")),
            "3: argument 'turn' has no value; did you mean 'turns'?");
  EXPECT_EQ(error_of(with_args("$(arg turns)")), "3: '$(arg turns)' refers to itself");
  EXPECT_EQ(error_of(with_args("$(find nowhere)/x")),
            "3: $(find nowhere): package 'nowhere' was not found; name the folder above it in "
            "ROS_PACKAGE_PATH");
  EXPECT_EQ(error_of(with_args("$(eval 1 + 1)")),
            "3: $(eval 1 + 1) is not read here; write its value");
  EXPECT_EQ(error_of(with_args("$(arg ")), "3: '$(arg' has no ')'");
  EXPECT_EQ(error_of("<launch>\n<node pkg='robot_calibration' type='calibrate' name='c'>\n"
                     "<rosparam>{base_link: a}</rosparam></node></launch>"),
            "3: parameters of node 'c' stand in the launch file; put them into a file that is "
            "loaded into 'c'");
  EXPECT_EQ(error_of("<launch>\n<group if='maybe'/></launch>"),
            "2: if=\"maybe\" is neither true nor false");
}

}  // namespace
}  // namespace kinecal
