// SPDX-License-Identifier: Apache-2.0
#include "kinecal/report/scene_meshes.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/meshes.hpp"
#include "support/temporary_folder.hpp"

namespace kinecal {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

class SceneMeshes : public test::FolderTest {
 protected:
  RobotScene scene_;
  Diagnostics diagnostics_;

  SceneMeshes() { scene_.links = {{"base"}, {"arm"}}; }

  static Visual mesh(const std::string& link, const std::string& file) {
    Visual visual;
    visual.link = link;
    visual.shape = VisualShape::mesh;
    visual.mesh = file;
    return visual;
  }
  void add(const std::vector<Visual>& visuals, const MeshBudget& budget = {}) {
    add_visuals(visuals, {.urdf = folder_}, "r.urdf", scene_, diagnostics_, budget);
  }
};

TEST_F(SceneMeshes, AFileThatIsUsedTwiceIsReadOnce) {
  write("a.stl", test::binary_stl(test::tetrahedron()));
  Visual box;
  box.link = "arm";
  add({mesh("base", "a.stl"), mesh("arm", "./a.stl"), box});
  EXPECT_THAT(scene_.meshes, SizeIs(1));
  EXPECT_THAT(scene_.links[0].visuals, SizeIs(1));
  ASSERT_THAT(scene_.links[1].visuals, SizeIs(2));
  EXPECT_EQ(scene_.links[1].visuals[0].mesh, 0);
  EXPECT_EQ(scene_.links[1].visuals[1].mesh, -1);
  EXPECT_THAT(diagnostics_.warnings, IsEmpty());
}

TEST_F(SceneMeshes, WhatIsNotThereIsOneWarningForEachReason) {
  write("cut.stl", "solid vertex");
  add({mesh("base", "package://absent_description/a.stl"),
       mesh("arm", "package://absent_description/b.stl"),
       mesh("arm", "package://absent_description/b.stl"), mesh("arm", "cut.stl"),
       mesh("nowhere", "x.stl")});
  EXPECT_THAT(scene_.links[0].visuals, IsEmpty());
  EXPECT_THAT(scene_.links[1].visuals, IsEmpty());
  EXPECT_THAT(
      diagnostics_.warnings,
      ElementsAre(
          AllOf(HasSubstr("r.urdf: mesh 'cut.stl' is not drawn: "), HasSubstr("not three numbers")),
          AllOf(
              HasSubstr(
                  "mesh 'package://absent_description/a.stl' (and 1 other) is not drawn: it is of"),
              HasSubstr("--mesh-path"))));
}

TEST_F(SceneMeshes, TogetherTheyStayInTheirBudget) {
  write("a.stl", test::binary_stl(test::ball(40)));
  write("b.stl", test::binary_stl(test::ball(60)));
  write("c.stl", test::binary_stl(test::tetrahedron()));
  add({mesh("base", "a.stl"), mesh("arm", "b.stl"), mesh("arm", "c.stl")},
      {.triangles = 3000, .bytes = 40000});
  std::size_t triangles = 0, numbers = 0;
  for (const Mesh& one : scene_.meshes) {
    triangles += one.num_triangles();
    numbers += one.vertices.size() + one.triangles.size();
    EXPECT_GT(one.num_triangles(), 3U);
  }
  EXPECT_LE(triangles, 3000U);
  EXPECT_LE(4 * numbers, 40000U);
  EXPECT_GT(4 * numbers, 10000U);
  EXPECT_EQ(scene_.meshes[2].num_triangles(), 4U) << "small ones stay as they are";
}

}  // namespace
}  // namespace kinecal
