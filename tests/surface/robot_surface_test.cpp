#include "kinecal/surface/robot_surface.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>

#include "support/mesh_robot.hpp"
#include "support/temporary_folder.hpp"

namespace kinecal {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

const std::map<std::string, double> kPosition = {{"pan", 0.4}, {"lift", 0.7}, {"elbow", -0.9}};

class RobotSurfaceOfFiles : public test::FolderTest {
 protected:
  RobotSurface read_with(const std::string& urdf, const SurfaceSource& source) {
    found_ = {};
    SurfaceSource of = source;
    of.urdf = "arm.urdf";
    of.places = {.urdf = folder_};
    of.place = {"calibrate.yaml", 7};
    return read_surface(urdf, of, found_);
  }
  Diagnostics found_;
};

TEST(RobotSurface, FindsTheNearestLinkAndTheNormal) {
  const Robot robot = parse_urdf(test::mesh_robot_urdf(), "arm.urdf");
  const RobotSurface surface = test::mesh_robot_surface();
  const std::vector<Pose<double>> poses = test::mesh_robot_poses(robot, kPosition);
  std::mt19937 engine(1);
  std::uniform_real_distribution<double> along(-0.6, 0.9);
  SurfaceHit last;
  for (int i = 0; i < 300; ++i) {
    const Vector3<double> p(along(engine), along(engine), along(engine));
    double least = 1e9;
    for (std::size_t l = 0; l < poses.size(); ++l) {
      const Vector3<double> in_link = poses[l].inverse() * p;
      least = std::min(least, surface.links()[l].tree.closest(in_link)->distance);
    }
    const SurfaceHit hit = surface.closest(poses, p);
    ASSERT_GE(hit.link, 0);
    EXPECT_NEAR(hit.distance, least, 1e-6);
    const Vector3<double> q = poses[static_cast<std::size_t>(hit.link)] * hit.point;
    EXPECT_NEAR(std::abs(hit.normal.dot(p - q)), hit.distance, 1e-12) << "n is parallel to p - q";
    EXPECT_GE(hit.normal.dot(hit.face), -1e-12) << "outward";
    EXPECT_EQ(surface.closest(poses, p, 0.9 * least).link, -1);
    EXPECT_NEAR(surface.closest(poses, p, 10.0, last).distance, least, 1e-6);
    last = hit;
  }
}

TEST(RobotSurface, GivesTheNormalOfTheFaceOnTheSurfaceItself) {
  const Robot robot = parse_urdf(test::mesh_robot_urdf(), "arm.urdf");
  const std::vector<Pose<double>> poses = test::mesh_robot_poses(robot, kPosition);
  const Vector3<double> on_top(-0.05, 0.0, 0.25);
  const SurfaceHit hit = test::mesh_robot_surface().closest(poses, on_top);
  EXPECT_NEAR(hit.distance, 0.0, 1e-12);
  EXPECT_TRUE(hit.normal.isApprox(Vector3<double>::UnitZ(), 1e-9));
}

// The gradient of point_to_mesh with constant normals against differences of the distance, associated anew.
TEST(RobotSurface, NormalsAreTheGradientOfTheDistance) {
  const Robot robot = parse_urdf(test::mesh_robot_urdf(), "arm.urdf");
  const RobotSurface surface = test::mesh_robot_surface();
  std::mt19937 engine(5);
  std::uniform_real_distribution<double> along(-0.5, 0.8);
  int on_edges = 0;
  for (int i = 0; i < 400; ++i) {
    const Vector3<double> p(along(engine), along(engine), along(engine));
    const auto distance = [&](double lift, const Vector3<double>& at) {
      std::map<std::string, double> q = kPosition;
      q["lift"] += lift;
      return surface.closest(test::mesh_robot_poses(robot, q), at);
    };
    const SurfaceHit hit = distance(0.0, p);
    constexpr double kStep = 1e-5,
                     kTolerance = 2e-3;  // floats choose, so distances have kinks of 1e-8
    const double sign =
        hit.normal.dot(hit.face) >= 0.0 &&
                hit.normal.dot(p - test::mesh_robot_poses(
                                       robot, kPosition)[static_cast<std::size_t>(hit.link)] *
                                       hit.point) < 0.0
            ? -1.0
            : 1.0;
    for (Eigen::Index k = 0; k < 3; ++k) {
      const Vector3<double> step = kStep * Vector3<double>::Unit(k);
      const double difference =
          (distance(0.0, p + step).distance - distance(0.0, p - step).distance) / (2.0 * kStep);
      EXPECT_NEAR(difference, sign * hit.normal[k], kTolerance) << "point " << i;
    }
    // The link turns: q moves with it, n does not.
    const auto at = [&](double lift) {
      std::map<std::string, double> q = kPosition;
      q["lift"] += lift;
      return Vector3<double>(test::mesh_robot_poses(robot, q)[static_cast<std::size_t>(hit.link)] *
                             hit.point);
    };
    const double of_block = hit.normal.dot(at(-kStep) - at(kStep)) / (2.0 * kStep);
    const double difference =
        (distance(kStep, p).distance - distance(-kStep, p).distance) / (2.0 * kStep);
    EXPECT_NEAR(difference, sign * of_block, kTolerance) << "point " << i;
    on_edges += std::abs(hit.normal.dot(hit.face)) < 0.999 ? 1 : 0;
  }
  EXPECT_GT(on_edges, 40) << "edges and corners are among them";
}

TEST(RobotSurface, CastsRaysOnAllLinks) {
  const Robot robot = parse_urdf(test::mesh_robot_urdf(), "arm.urdf");
  const RobotSurface surface = test::mesh_robot_surface();
  const std::vector<Pose<double>> poses = test::mesh_robot_poses(robot, kPosition);
  const Vector3<double> eye(-1.5, 0.2, 0.6);
  int hits = 0;
  for (int i = 0; i < 100; ++i) {
    const Vector3<double> ray(1.0, 0.002 * (i - 50) - 0.13, 0.3 - 0.008 * i);
    const SurfaceHit hit = surface.cast(poses, eye, ray);
    if (hit.link < 0) continue;
    ++hits;
    const Vector3<double> p = eye + hit.distance * ray;
    EXPECT_NEAR(surface.closest(poses, p).distance, 0.0, 1e-9);
    EXPECT_NEAR((poses[static_cast<std::size_t>(hit.link)] * hit.point - p).norm(), 0.0, 1e-9);
  }
  EXPECT_GT(hits, 20);
}

TEST_F(RobotSurfaceOfFiles, ReadsMeshesWithOriginsAndScales) {
  test::write_meshes(folder_, 1000.0);
  const std::string urdf = test::mesh_robot_urdf(".stl", "0.001 0.001 -0.001");
  const RobotSurface surface = read_with(urdf, {});
  EXPECT_THAT(found_.errors, IsEmpty());
  ASSERT_EQ(surface.links().size(), 4U);
  const SurfaceFacts& facts = surface.links()[0].tree.facts();
  EXPECT_NEAR(facts.low.z(), -0.25, 1e-6);
  EXPECT_TRUE(facts.closed);
  EXPECT_GT(facts.volume, 0.0) << "a mirrored mesh is turned again";
  ASSERT_EQ(found_.notes.size(), 1U);
  EXPECT_THAT(found_.notes[0], HasSubstr("triangles of 4 links"));
  EXPECT_EQ(surface.find("fore"), 2);
  EXPECT_EQ(surface.find("finger"), -1);
}

TEST_F(RobotSurfaceOfFiles, TakesCollisionsOnRequestOrWhereNothingElseIs) {
  test::write_meshes(folder_);
  std::string urdf = test::mesh_robot_urdf();
  (void)read_with(urdf, {.geometry = SurfaceGeometry::collision});
  ASSERT_EQ(found_.errors.size(), 1U);
  EXPECT_THAT(found_.errors[0],
              HasSubstr("calibrate.yaml:7: no link has a mesh or shape in a <collision>"));
  for (std::size_t at = 0; (at = urdf.find("visual>", at)) != std::string::npos; at += 5) {
    urdf.replace(at, 7, "collision>");
  }
  EXPECT_EQ(read_with(urdf, {}).links().size(), 4U);
  EXPECT_EQ(read_with(urdf, {.geometry = SurfaceGeometry::collision}).links().size(), 4U);
  EXPECT_TRUE(read_with(urdf, {.geometry = SurfaceGeometry::visual}).links().empty());
}

TEST_F(RobotSurfaceOfFiles, NamesLinksWithoutAMesh) {
  test::write_meshes(folder_);
  (void)read_with(test::mesh_robot_urdf(), {.links = {"camera", "base"}});
  EXPECT_THAT(found_.errors,
              ElementsAre("calibrate.yaml:7: link 'camera' has no mesh or shape in a <visual> of "
                          "arm.urdf"));
}

TEST_F(RobotSurfaceOfFiles, TakesShapesWhereNoLinkHasAMesh) {
  const auto link = [](const std::string& name, const std::string& shape) {
    return "<link name=\"" + name + "\"><visual><origin xyz=\"0.1 0 0\"/><geometry>" + shape +
           "</geometry></visual></link>";
  };
  const std::string shapes = link("base", "<box size=\"0.2 0.3 0.4\"/>") +
                             link("rod", "<cylinder radius=\"0.05\" length=\"0.3\"/>") +
                             link("ball", "<sphere radius=\"0.1\"/>");
  const auto robot = [](const std::string& links) {
    return "<robot name=\"r\">" + links + "</robot>";
  };
  const RobotSurface surface = read_with(robot(shapes), {});
  EXPECT_THAT(found_.errors, IsEmpty());
  ASSERT_EQ(surface.links().size(), 3U);
  const std::array<Vector3<double>, 3> size = {
      Vector3<double>(0.2, 0.3, 0.4), {0.1, 0.1, 0.3}, {0.2, 0.2, 0.2}};
  const std::array<double, 3> volume = {0.024, std::numbers::pi * 0.05 * 0.05 * 0.3,
                                        4.0 / 3.0 * std::numbers::pi * 1e-3};
  for (std::size_t i = 0; i < 3; ++i) {
    const SurfaceFacts& facts = surface.links()[i].tree.facts();
    EXPECT_TRUE(facts.closed) << i;
    EXPECT_EQ(facts.without_area, 0U) << i;
    EXPECT_NEAR(facts.volume / volume[i], 1.0, 0.01) << i;  // of rings of 64 corners
    EXPECT_LT((facts.high - facts.low - size[i]).norm(), 1e-6) << i;
    EXPECT_LT((surface.links()[i].tree.center() - Vector3<double>(0.1, 0, 0)).norm(), 1e-6) << i;
  }
  test::write_meshes(folder_);
  const std::string meshed = robot(shapes + link("arm", "<mesh filename=\"hand.stl\"/>"));
  EXPECT_EQ(read_with(meshed, {}).links().size(), 1U) << "as without shapes";
  EXPECT_EQ(read_with(meshed, {.links = {"rod", "arm"}}).links().size(), 2U);
  EXPECT_THAT(found_.errors, IsEmpty());
}

TEST_F(RobotSurfaceOfFiles, NamesMeshesThatAreMissingOrNoMesh) {
  test::write_meshes(folder_);
  std::filesystem::remove(folder_ / "fore.stl");
  write("hand.stl", "not a mesh");
  (void)read_with(test::mesh_robot_urdf(), {});
  ASSERT_EQ(found_.errors.size(), 2U);
  EXPECT_THAT(found_.errors[0], HasSubstr("link 'fore': mesh 'fore.stl' is not there"));
  EXPECT_THAT(found_.errors[1], HasSubstr("link 'hand': mesh 'hand.stl'"));
  std::string urdf = test::mesh_robot_urdf();
  urdf.replace(urdf.find("base.stl"), 8, "package://nobody/base.stl");
  (void)read_with(urdf, {.links = {"base"}});
  ASSERT_EQ(found_.errors.size(), 1U);
  EXPECT_THAT(found_.errors[0], HasSubstr("package 'nobody', which was not found"));
  EXPECT_THAT(found_.errors[0], HasSubstr("--mesh-path"));
}

TEST_F(RobotSurfaceOfFiles, NamesSizesThatNoLinkHas) {
  test::write_meshes(folder_, 1000.0);
  (void)read_with(test::mesh_robot_urdf(), {.links = {"base"}});
  ASSERT_EQ(found_.errors.size(), 1U);
  EXPECT_THAT(found_.errors[0], HasSubstr("link 'base': its mesh is 326.1 m long"));
  EXPECT_THAT(found_.errors[0], HasSubstr("is it in millimetres?"));
  test::write_meshes(folder_, 0.001);
  (void)read_with(test::mesh_robot_urdf(), {.links = {"base"}});
  ASSERT_EQ(found_.errors.size(), 1U);
  EXPECT_THAT(found_.errors[0], HasSubstr("0.326 mm long"));
}

}  // namespace
}  // namespace kinecal
