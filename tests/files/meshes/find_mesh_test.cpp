// SPDX-License-Identifier: Apache-2.0
#include "kinecal/files/meshes/find_mesh.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>

#include "support/temporary_folder.hpp"

namespace kinecal {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

/// A package with a URDF and a mesh, and a secret beside it.
class FindMesh : public test::FolderTest {
 protected:
  fs::path root_ = fs::canonical(folder_);

  void SetUp() override {
    fs::create_directories(folder_ / "ws/fetch_description/meshes");
    fs::create_directories(folder_ / "ws/fetch_description/robots");
    write("ws/fetch_description/meshes/base.stl", "x");
    write("ws/fetch_description/meshes/a b.stl", "x");
    write("ws/secret.stl", "x");
  }
  [[nodiscard]] fs::path mesh() const { return root_ / "ws/fetch_description/meshes/base.stl"; }
  /// The file that is found, or the error.
  [[nodiscard]] static std::string found(const std::string& name, const MeshPlaces& places) {
    try {
      return find_mesh(name, places).string();
    } catch (const MeshError& e) {
      return e.what();
    }
  }
};

constexpr const char* kName = "package://fetch_description/meshes/base.stl";

TEST_F(FindMesh, APackageIsFoundInAnyOfItsPlaces) {
  const fs::path ws = folder_ / "ws";
  EXPECT_EQ(found(kName, {.given = {ws}}), mesh());
  EXPECT_EQ(found(kName, {.given = {ws / "fetch_description"}}), mesh());
  EXPECT_EQ(found(kName, {.ros_packages = {"/nowhere", ws}}), mesh());
  EXPECT_EQ(found(kName, {.urdf = ws / "fetch_description/robots"}), mesh());
  fs::create_directories(folder_ / "install/share");
  fs::rename(ws / "fetch_description", folder_ / "install/share/fetch_description");
  const fs::path installed = root_ / "install/share/fetch_description/meshes/base.stl";
  EXPECT_EQ(found(kName, {.prefixes = {folder_ / "install"}}), installed);
  EXPECT_EQ(found(kName, {.given = {folder_ / "install"}}), installed);
}

TEST_F(FindMesh, APackageMayBeInAFolderOfAnotherName) {
  fs::rename(folder_ / "ws/fetch_description", folder_ / "ws/src");
  const MeshPlaces places{.urdf = folder_ / "ws/src/robots"};
  EXPECT_THAT(found(kName, places), HasSubstr("package 'fetch_description', which was not found"));
  write("ws/src/package.xml", "<package><name>fetch_description</name></package>");
  EXPECT_EQ(found(kName, places), root_ / "ws/src/meshes/base.stl");
}

TEST_F(FindMesh, TheEnvironmentNamesFolders) {
  ::setenv("ROS_PACKAGE_PATH", ("/nowhere::" + (folder_ / "ws").string()).c_str(), 1);
  ::setenv("AMENT_PREFIX_PATH", "/opt/a:/opt/b", 1);
  const MeshPlaces places = mesh_places("robots/fetch.urdf", {"extra"});
  ::unsetenv("ROS_PACKAGE_PATH");
  ::unsetenv("AMENT_PREFIX_PATH");
  EXPECT_EQ(places.urdf, "robots");
  EXPECT_EQ(places.given, std::vector<fs::path>{"extra"});
  EXPECT_EQ(places.ros_packages, (std::vector<fs::path>{"/nowhere", folder_ / "ws"}));
  EXPECT_EQ(places.prefixes, (std::vector<fs::path>{"/opt/a", "/opt/b"}));
  EXPECT_EQ(found(kName, places), mesh());
}

TEST_F(FindMesh, NothingOutsideOfThePackageIsRead) {
  const MeshPlaces places{.urdf = folder_ / "ws/fetch_description/robots",
                          .given = {folder_ / "ws"}};
  for (const std::string name :
       {"package://fetch_description/../secret.stl",
        "package://fetch_description/meshes/../../secret.stl",
        "package://fetch_description/%2e%2e/secret.stl", "package://../ws/secret.stl",
        "package://fetch_description//etc/passwd", "package:///etc/passwd"}) {
    EXPECT_FALSE(fs::exists(found(name, places))) << name;
  }
  for (const std::string name :
       {"file:///etc/passwd", "/etc/passwd", "../../../../../etc/passwd"}) {
    EXPECT_THAT(found(name, places), HasSubstr("outside")) << name;
  }
  fs::create_symlink(root_ / "ws/secret.stl", folder_ / "ws/fetch_description/meshes/link.stl");
  EXPECT_THAT(found("package://fetch_description/meshes/link.stl", places), HasSubstr("outside"));
}

TEST_F(FindMesh, APackageOfLinksIsPassedOverForThePackageItself) {
  fs::create_directories(folder_ / "install/share/fetch_description/meshes");
  fs::create_symlink(mesh(), folder_ / "install/share/fetch_description/meshes/base.stl");
  EXPECT_THAT(found(kName, {.prefixes = {folder_ / "install"}}), HasSubstr("outside"));
  EXPECT_EQ(found(kName, {.urdf = folder_ / "ws", .prefixes = {folder_ / "install"}}), mesh());
}

TEST_F(FindMesh, NothingIsFetched) {
  for (const std::string name : {"http://a.b/c.stl", "https://a.b/c.stl", "model://x/y.stl"}) {
    EXPECT_THAT(found(name, {.urdf = folder_}), HasSubstr("nothing is fetched"));
  }
}

TEST_F(FindMesh, NamesWithoutAPackageAreRelativeToTheUrdf) {
  const fs::path robots = folder_ / "ws/fetch_description/robots";
  EXPECT_THAT(found("../meshes/base.stl", {.urdf = robots}), HasSubstr("--mesh-path"));
  EXPECT_EQ(found("../meshes/base.stl", {.urdf = robots, .given = {folder_ / "ws"}}), mesh());
  write("ws/fetch_description/package.xml", "<package/>");
  EXPECT_EQ(found("../meshes/base.stl", {.urdf = robots}), mesh());
  EXPECT_EQ(found("file://" + mesh().string(), {.urdf = robots}), mesh());
  EXPECT_EQ(found("file://" + (mesh().parent_path() / "a%20b.stl").string(), {.urdf = robots}),
            mesh().parent_path() / "a b.stl");
}

TEST_F(FindMesh, ImpossibleNamesAreNotThere) {
  const MeshPlaces places{.urdf = folder_ / "ws/fetch_description"};
  for (const std::string& name :
       {std::string(5000, 'x'), "package://fetch_description/" + std::string(5000, 'y'),
        std::string("package://fetch_description/meshes"),
        std::string("package://fetch_description"), std::string("%00%zz%"),
        std::string("a\nb\xFF.stl"), std::string("package://")}) {
    EXPECT_FALSE(fs::path(found(name, places)).is_absolute()) << name.substr(0, 60);
  }
}

}  // namespace
}  // namespace kinecal
