#include "kinecal/surface/outline.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <fstream>
#include <sstream>

#include "kinecal/files/images/read_image.hpp"
#include "kinecal/geometry/median.hpp"
#include "support/data.hpp"
#include "support/mask_robot.hpp"

namespace kinecal {
namespace {

using test::mask_pixel;

/// The arm in some poses, before its camera.
class OutlineOfAnArm : public testing::TestWithParam<unsigned> {
 protected:
  OutlineOfAnArm() {
    const Robot robot = parse_urdf(test::mesh_robot_urdf(), "arm.urdf");
    const Sample sample =
        test::mesh_robot_samples(robot, {.samples = 1, .pixels = 2, .seed = GetParam()})[0];
    base_T_links_ = test::mesh_robot_poses(robot, test::positions_of(sample));
  }
  std::vector<Pose<double>> in_camera(const Pose<double>& base_T_camera) const {
    std::vector<Pose<double>> links;
    for (const Pose<double>& link : base_T_links_) links.push_back(base_T_camera.inverse() * link);
    return links;
  }
  std::vector<OutlinePoint> outline_from(const Pose<double>& base_T_camera) const {
    return outliner_.outline(in_camera(base_T_camera), mask_pixel, 320, 240);
  }

  RobotSurface surface_ = test::mesh_robot_surface();
  Outliner outliner_{surface_};
  std::vector<Pose<double>> base_T_links_;
};

TEST_P(OutlineOfAnArm, MaskIsWhatRaysHit) {
  const GrayImage drawn = outliner_.mask(in_camera(test::true_camera()), mask_pixel, 320, 240),
                  cast = test::mask_of(surface_, base_T_links_, test::true_camera());
  int robot = 0, differ = 0;
  for (std::size_t i = 0; i < drawn.pixels.size(); ++i) {
    robot += cast.pixels[i] != 0 ? 1 : 0;
    differ += cast.pixels[i] != drawn.pixels[i] ? 1 : 0;
  }
  EXPECT_GT(robot, 2000);
  // Samples are a quarter of a pixel beside the middle: an outline of some hundred pixels.
  EXPECT_LT(differ, 0.3 * static_cast<double>(outline_from(test::true_camera()).size()));
}

TEST_P(OutlineOfAnArm, PointsAreWhereTheRobotEnds) {
  const auto seen = [&](const Eigen::Vector2d& pixel) {
    return test::seen_at(surface_, base_T_links_, test::true_camera(), pixel).link;
  };
  const std::vector<Pose<double>> links = in_camera(test::true_camera());
  int wrong = 0;
  const std::vector<OutlinePoint> outline = outline_from(test::true_camera());
  EXPECT_GT(outline.size(), 300U);
  for (const OutlinePoint& point : outline) {
    const Vector3<double> p = links[static_cast<std::size_t>(point.link)] * point.point;
    EXPECT_LT((mask_pixel(p) - point.pixel).norm(), 1e-9);
    EXPECT_NEAR(point.normal.norm(), 1.0, 1e-12);
    if (seen(point.pixel + 0.7 * point.normal) >= 0) ++wrong;
    if (seen(point.pixel - 0.7 * point.normal) < 0) ++wrong;
  }
  EXPECT_LE(wrong, 0.04 * static_cast<double>(outline.size())) << "narrower than the distance";
}

/// Where points of the outline go is where the outline goes: to first order of the motion.
TEST_P(OutlineOfAnArm, MovesAsItsPointsDo) {
  const std::vector<OutlinePoint> before = outline_from(test::true_camera());
  Pose<double> moved = test::true_camera();
  moved.translation += Vector3<double>(0.004, -0.003, 0.002);
  moved.rotation = exp(Vector3<double>(0.002, 0.004, -0.003)) * moved.rotation;
  const std::vector<Pose<double>> links = in_camera(moved);
  const std::vector<OutlinePoint> after = outline_from(moved);
  std::vector<Eigen::Vector2d> pixels;
  for (const OutlinePoint& point : after) pixels.push_back(point.pixel);
  const PixelGrid grid(pixels, 320, 240);
  std::vector<double> ways, errors;
  for (const OutlinePoint& point : before) {
    const Eigen::Vector2d pixel =
        mask_pixel(links[static_cast<std::size_t>(point.link)] * point.point);
    const int at = grid.nearest(pixel, 10.0, [&](int k) {
      return after[static_cast<std::size_t>(k)].normal.dot(point.normal) > 0.7;
    });
    if (at < 0) continue;
    const OutlinePoint& there = after[static_cast<std::size_t>(at)];
    errors.push_back(std::abs(there.normal.dot(there.pixel - pixel)));
    ways.push_back(std::abs(point.normal.dot(pixel - point.pixel)));
  }
  EXPECT_GT(errors.size(), before.size() * 9 / 10);
  EXPECT_GT(median_of(ways), 0.3) << "pixels";
  EXPECT_LT(median_of(errors), 0.02);
  std::sort(errors.begin(), errors.end());
  EXPECT_LT(errors[errors.size() * 9 / 10], 0.1);
}

INSTANTIATE_TEST_SUITE_P(Poses, OutlineOfAnArm, testing::Values(1U, 2U, 3U));

TEST(Outliner, IsTheSameForMeshesThatAreInsideOutOrOpen) {
  const auto outline_of = [](test::Shape shape) {
    std::vector<SurfaceLink> links;
    links.push_back({"link", TriangleTree(shape.vertices, shape.triangles)});
    const std::vector<Pose<double>> poses = {{Matrix3<double>::Identity(), {0.1, 0.05, 1.5}}};
    return Outliner(RobotSurface(std::move(links))).outline(poses, mask_pixel, 320, 240).size();
  };
  test::Shape shape = test::ball({0.0, 0.0, 0.0}, 0.3, 12);
  const std::size_t right = outline_of(shape);
  EXPECT_GT(right, 250U);
  test::Shape turned = shape;
  for (auto& corners : turned.triangles) std::swap(corners[0], corners[1]);
  EXPECT_EQ(outline_of(turned), right);
  std::erase_if(shape.triangles, [&](const auto& corners) {  // the far side is missing
    return shape.vertices[corners[0]].z() > 0.2;
  });
  EXPECT_NEAR(static_cast<double>(outline_of(shape)), static_cast<double>(right), 3.0);
}

TEST(PixelGrid, FindsTheNearest) {
  std::mt19937 engine(3);
  std::uniform_real_distribution<double> u(-20.0, 340.0), v(-20.0, 260.0);
  std::vector<Eigen::Vector2d> pixels;
  for (int i = 0; i < 200; ++i) pixels.emplace_back(u(engine), v(engine));
  const PixelGrid grid(pixels, 320, 240);
  for (int i = 0; i < 300; ++i) {
    const Eigen::Vector2d at(u(engine), v(engine));
    const auto odd = [](int k) { return k % 2 == 1; };
    int nearest = -1;
    for (int k = 1; k < 200; k += 2) {
      const auto distance = [&](int n) {
        return (pixels[static_cast<std::size_t>(n)] - at).norm();
      };
      if (nearest < 0 || distance(k) < distance(nearest)) nearest = k;
    }
    EXPECT_EQ(grid.nearest(at, 1e9, odd), nearest);
    const double away = (pixels[static_cast<std::size_t>(nearest)] - at).norm();
    EXPECT_EQ(grid.nearest(at, 0.99 * away, odd), -1);
  }
}

}  // namespace
}  // namespace kinecal
