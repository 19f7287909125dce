// SPDX-License-Identifier: Apache-2.0
#include "kinecal/files/meshes/read_mesh.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <limits>
#include <random>

#include "support/meshes.hpp"
#include "support/repetitions.hpp"
#include "support/temporary_folder.hpp"
#include "support/thrown.hpp"

namespace kinecal {
namespace {

using testing::ElementsAre;
using testing::FloatNear;
using testing::HasSubstr;

constexpr const char* kObj =
    "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvn 0 0 1\nf 1//1 2//1 3//1\nf 1 3 4\n";

class ReadMesh : public test::FolderTest {
 protected:
  [[nodiscard]] Mesh read_bytes(const std::string& name, const std::string& bytes,
                                const MeshLimits& limits = {}) const {
    write(name, bytes);
    return read_mesh(folder_ / name, limits);
  }
  /// Why a file is refused.
  [[nodiscard]] std::string refusal(const std::string& name, const std::string& bytes,
                                    const MeshLimits& limits = {}) const {
    return test::thrown<MeshError>([&] { (void)read_bytes(name, bytes, limits); }, "read");
  }
  /// Indices are those of vertices, and all numbers finite.
  static void expect_valid(const Mesh& mesh) {
    EXPECT_EQ(mesh.vertices.size() % 3, 0U);
    EXPECT_EQ(mesh.triangles.size() % 3, 0U);
    for (const std::uint32_t vertex : mesh.triangles) EXPECT_LT(vertex, mesh.num_vertices());
    for (const float x : mesh.vertices) EXPECT_TRUE(std::isfinite(x));
  }
  /// The first bytes of a file are refused, or are a mesh with no more than its triangles.
  static void expect_first_bytes_have_no_more(const std::string& type, const std::string& bytes) {
    const std::size_t all = detail::mesh_of(bytes, type).num_triangles();
    for (std::size_t size = 0; size < bytes.size(); ++size) {
      SCOPED_TRACE(type + ", the first " + std::to_string(size) + " bytes");
      try {
        const Mesh mesh = detail::cleaned(detail::mesh_of(bytes.substr(0, size), type));
        expect_valid(mesh);
        EXPECT_LE(mesh.num_triangles(), all);
      } catch (const MeshError& e) {
        EXPECT_STRNE(e.what(), "");
      }
    }
  }
  /// Reads a file with some bytes changed: a sanitizer sees what is read beyond its end.
  void read_with_changed_bytes(const std::string& name, const std::string& bytes) const {
    std::mt19937 random(5);
    for (int n = 0; n < 60; ++n) {
      std::string changed = bytes.substr(0, n % 2 == 0 ? random() % bytes.size() : bytes.size());
      for (int k = 0; k < n % 5 && !changed.empty(); ++k) {
        changed[random() % changed.size()] = static_cast<char>(random());
      }
      try {
        expect_valid(read_bytes(name, changed));
      } catch (const MeshError& e) {
        EXPECT_STRNE(e.what(), "");
      }
    }
  }
};

TEST_F(ReadMesh, BinaryAndTextStlAreTheSameMesh) {
  const Mesh binary = read_bytes("a.stl", test::binary_stl(test::tetrahedron()));
  const Mesh text = read_bytes("b.STL", test::text_stl(test::tetrahedron()));
  EXPECT_EQ(binary.num_vertices(), 4U) << "equal corners are one vertex";
  EXPECT_EQ(binary.num_triangles(), 4U);
  EXPECT_EQ(binary.vertices, text.vertices);
  EXPECT_EQ(binary.triangles, text.triangles);
  EXPECT_EQ(binary.vertices[3], 0.0F);
  EXPECT_EQ(binary.vertices[4], 1.0F);
}

TEST_F(ReadMesh, DropsWhatCannotBeDrawn) {
  std::vector<test::Triangle> triangles = test::tetrahedron();
  const float nan = std::numeric_limits<float>::quiet_NaN();
  triangles[0][1] = {nan, 0, 0};
  triangles[1][2] = {0, std::numeric_limits<float>::infinity(), 0};
  triangles[2][1] = triangles[2][0];  // a line
  const Mesh mesh = read_bytes("a.stl", test::binary_stl(triangles));
  EXPECT_EQ(mesh.num_triangles(), 1U);
  EXPECT_EQ(mesh.num_vertices(), 3U);
  expect_valid(mesh);
  const Mesh wrong =
      detail::cleaned({{0, 0, 0, 1, 0, 0, 0, 1, 0}, {0, 1, 2, 0, 1, 3, 0, 1, 4000000000U}});
  EXPECT_EQ(wrong.num_triangles(), 1U);
}

TEST_F(ReadMesh, ThinsALargeMeshAndKeepsItsSize) {
  const std::string bytes = test::binary_stl(test::ball(100));
  const Mesh whole = read_bytes("ball.stl", bytes);
  EXPECT_GT(whole.num_triangles(), 19000U);
  const Mesh mesh = read_bytes("ball.stl", bytes, {.triangles = 2000});
  EXPECT_LE(mesh.num_triangles(), 2000U);
  EXPECT_GT(mesh.num_triangles(), 500U);
  expect_valid(mesh);
  const auto [low, high] = std::minmax_element(mesh.vertices.begin(), mesh.vertices.end());
  EXPECT_NEAR(*low, -1.0F, 0.1F);
  EXPECT_NEAR(*high, 1.0F, 0.1F);
  const Mesh again = read_bytes("ball.stl", bytes, {.triangles = 2000});
  EXPECT_EQ(mesh.vertices, again.vertices);
  EXPECT_EQ(mesh.triangles, again.triangles);
}

TEST_F(ReadMesh, RefusesWithASentence) {
  const std::string stl = test::binary_stl(test::tetrahedron());
  EXPECT_THAT(refusal("a.stl", stl.substr(0, stl.size() - 1)), HasSubstr("cut off"));
  EXPECT_THAT(refusal("a.stl", ""), HasSubstr("cut off"));
  EXPECT_THAT(refusal("a.stl", "solid\n vertex 1 2\n"), HasSubstr("vertex"));
  EXPECT_THAT(refusal("a.stl", "solid\n vertex 1 2 3\n"), HasSubstr("no triangles"));
  EXPECT_THAT(refusal("a.stl", stl, {.bytes = 100}), HasSubstr("MB are drawn"));
  std::string endless = stl;  // says that it has four billion triangles
  endless.replace(80, 4, "\xFF\xFF\xFF\xFF");
  EXPECT_THAT(refusal("a.stl", endless), HasSubstr("cut off"));
  EXPECT_THROW((void)read_mesh(folder_ / "not_there.stl"), MeshError);
  EXPECT_THROW((void)read_mesh(folder_), MeshError);
}

TEST_F(ReadMesh, TheFirstBytesOfABinaryStlOrADaeAreRefused) {
  const std::string stl = test::binary_stl(test::tetrahedron());
  for (std::size_t size = 0; size < stl.size(); ++size) {
    EXPECT_THROW((void)detail::mesh_of(stl.substr(0, size), "stl"), MeshError) << size << " bytes";
  }
  const std::string dae = test::dae("0.01", "Z_UP");
  for (std::size_t size = 0; size <= dae.rfind('>'); ++size) {
    EXPECT_THROW((void)detail::mesh_of(dae.substr(0, size), "dae"), MeshError) << size << " bytes";
  }
}

TEST_F(ReadMesh, TheFirstBytesOfATextHaveNoMoreTriangles) {
  expect_first_bytes_have_no_more("stl", test::text_stl(test::tetrahedron()));
  expect_first_bytes_have_no_more("obj", kObj);
}

TEST_F(ReadMesh, ChangedBytesAreRefusedOrRead) {
  if (!test::kHasSanitizers) GTEST_SKIP() << "only a sanitizer sees a read beyond the end";
  read_with_changed_bytes("a.stl", test::binary_stl(test::tetrahedron()));
  read_with_changed_bytes("a.stl", test::text_stl(test::tetrahedron()));
  read_with_changed_bytes("a.dae", test::dae("0.01", "Z_UP"));
  read_with_changed_bytes("a.obj", kObj);
}

TEST_F(ReadMesh, OfADaeTheUnitCountsAndTheUpAxisDoesNot) {
  for (const std::string up : {"X_UP", "Y_UP", "Z_UP"}) {
    for (const double unit : {1.0, 0.0254, 0.001}) {
      const Mesh mesh = read_bytes("a.dae", test::dae(std::to_string(unit), up));
      ASSERT_EQ(mesh.num_triangles(), 1U);
      const auto u = static_cast<float>(unit);
      const auto near = [&](float x) { return FloatNear(x * u, 1e-6F); };
      EXPECT_THAT(mesh.vertices, ElementsAre(near(0), near(0), near(3), near(1), near(0), near(3),
                                             near(0), near(1), near(5)))
          << up;
    }
  }
}

TEST_F(ReadMesh, OfADaePolygonsAndNodesThatAreUsedTwiceAreRead) {
  std::string text = test::dae("1", "Z_UP");
  const auto replace = [&](const std::string& from, const std::string& to) {
    ASSERT_NE(text.find(from), std::string::npos) << from;
    text.replace(text.find(from), from.size(), to);
  };
  replace("count=\"9\">0 0 0 1 0 0 0 1 2", "count=\"12\">0 0 0 1 0 0 1 1 0 0 1 0");
  replace("<triangles count=\"1\">", "<polylist count=\"1\">");
  replace("offset=\"0\"/><p>0 1 2</p></triangles>",
          "offset=\"1\"/><vcount>4</vcount><p>9 0 9 1 9 2 9 3</p></polylist>");
  replace("<scene>",
          "<library_nodes><node id=\"again\"><rotate>0 0 1 90</rotate><scale>2 2 2</scale>"
          "<instance_geometry url=\"#g\"/></node></library_nodes><scene>");
  replace("<instance_geometry url=\"#g\"/></node>\n </visual",
          "<instance_node url=\"#again\"/><instance_geometry url=\"#g\"/></node>\n </visual");
  const Mesh mesh = read_bytes("a.dae", text);
  EXPECT_EQ(mesh.num_triangles(), 4U);
  ASSERT_EQ(mesh.num_vertices(), 8U);
  // The second corner, (1, 0, 0): twice as far and turned by 90 degrees.
  EXPECT_NEAR(mesh.vertices[3], 0.0F, 1e-6F);
  EXPECT_NEAR(mesh.vertices[4], 2.0F, 1e-6F);
  EXPECT_NEAR(mesh.vertices[5], 3.0F, 1e-6F);
}

TEST_F(ReadMesh, ADaeWhoseNodesMultiplyEnds) {
  std::string nodes;
  for (int i = 0; i < 40; ++i) {
    const std::string next = "<instance_node url=\"#n" + std::to_string(i + 1) + "\"/>";
    nodes += "<node id=\"n" + std::to_string(i) + "\">" + next + next + "</node>";
  }
  const auto file = [](const std::string& library, const std::string& first) {
    return "<COLLADA><library_nodes>" + library +
           "</library_nodes><library_visual_scenes><visual_scene id=\"s\"><node>"
           "<instance_node url=\"#" +
           first +
           "\"/></node></visual_scene></library_visual_scenes>"
           "<scene><instance_visual_scene url=\"#s\"/></scene></COLLADA>";
  };
  EXPECT_THAT(refusal("a.dae", file(nodes, "n0")), HasSubstr("too many nodes"));
  const std::string itself = "<node id=\"x\"><instance_node url=\"#x\"/></node>";
  EXPECT_THAT(refusal("a.dae", file(itself, "x")), HasSubstr("too many nodes"));
}

TEST_F(ReadMesh, ReadsObj) {
  const Mesh mesh =
      read_bytes("a.obj",
                 "mtllib ../../../etc/passwd\nv 0 0 0\nv 1 0 0\r\nv 1 1 0 1.0\nv 0 1 0\n"
                 "usemtl x\nf 1 2/7 3//1 4/2/3\nf -1 -2 -3\nf 1 2 9\nf -9 1 2\n");
  EXPECT_EQ(mesh.num_triangles(), 3U) << "two corners do not exist";
  EXPECT_EQ(mesh.num_vertices(), 4U);
  EXPECT_EQ(mesh.triangles[6], mesh.triangles[5]);
}

TEST_F(ReadMesh, RefusesWhatIsNoMesh) {
  EXPECT_NE(refusal("a.dae", "<COLLADA>"), "read");
  EXPECT_THAT(refusal("a.step", "nonsense"), HasSubstr("STL, DAE and OBJ"));
  EXPECT_NE(refusal("a.dae", std::string(2000, '\xFF')), "read");
}

}  // namespace
}  // namespace kinecal
