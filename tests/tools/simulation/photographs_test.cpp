#include "kinecal/tools/simulation/photographs.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "kinecal/files/urdf/read_urdf.hpp"
#include "support/paths.hpp"

namespace kinecal {
namespace {

SimulationPlan panda(const std::string& target = "checkerboard") {
  Diagnostics diagnostics;
  const Robot robot = read_urdf(test::source_folder() + "/examples/robots/panda/panda.urdf");
  SimulationPlan plan = read_simulation(robot, "", target, 1, diagnostics);
  plan.poses = 2;
  return plan;
}

std::string content(const PhotographFiles& files, const std::string& name) {
  for (const OutputFile& file : files.others) {
    if (file.name == name) return file.content;
  }
  return "";
}

TEST(Photographs, HaveARowOfJointsForEachImage) {
  const SimulationPlan plan = panda();
  const std::vector<JointTarget> poses = poses_of(plan);
  const PhotographFiles files = take_photographs(plan, poses, {});
  ASSERT_EQ(files.images.size(), 2U);
  EXPECT_EQ(files.images[1].name, "0002.png");
  EXPECT_TRUE(files.depth.empty());  // camera2d
  const std::string table = content(files, "poses.csv");
  EXPECT_TRUE(table.starts_with("image,panda_joint1,panda_joint2,")) << table;
  EXPECT_NE(table.find("\n0002.png,"), std::string::npos);
  EXPECT_NE(content(files, "truth.yaml").find("checkerboard_x: "), std::string::npos);
  EXPECT_NE(content(files, "capture.yaml").find("CheckerboardFinder2d"), std::string::npos);
  EXPECT_NE(content(files, "calibrate.yaml").find("base_link: panda_link0"), std::string::npos);
  EXPECT_NE(content(files, "camera.yaml").find("image_width: 640"), std::string::npos);
}

TEST(Photographs, ADepthCameraHasDepthInMillimetres) {
  SimulationPlan plan = panda();
  plan.setup.camera.has_depth = true;
  EXPECT_EQ(take_photographs(plan, poses_of(plan), {}).depth.size(), 2U);
}

TEST(Photographs, APoseThatFailsIsSkippedWithItsReason) {
  const SimulationPlan plan = panda();
  std::vector<JointTarget> poses = poses_of(plan);
  poses.front().positions.front() = 100.0;
  const PhotographFiles files = take_photographs(plan, poses, {});
  EXPECT_EQ(files.images.size(), 1U);
  ASSERT_EQ(files.skipped.size(), 1U);
  EXPECT_THAT(files.skipped.front(), testing::StartsWith("pose 1: joint 'panda_joint"));
  poses.pop_back();
  EXPECT_THROW(static_cast<void>(take_photographs(plan, poses, {})), InputError);
}

}  // namespace
}  // namespace kinecal
