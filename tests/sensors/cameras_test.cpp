#include <gtest/gtest.h>

#include "kinecal/geometry/jet.hpp"
#include "kinecal/sensors/depth_camera.hpp"
#include "kinecal/sensors/pinhole_camera.hpp"

namespace kinecal {
namespace {

TEST(DepthCamera, GivesBackTheRecordedPointWithTheRecordedSettings) {
  const DepthCamera<> camera{550, 545, 320, 240, 0.012, 1.02};
  const Vector3<double> p(0.2, -0.1, 0.9);
  const Vector3<double> again =
      camera.point(camera.measurement(p), std::array<double, 6>{0, 0, 0, 0, 0.012, 0.02});
  EXPECT_LE((again - p).norm(), 1e-15);
}

TEST(DepthCamera, FollowsTheDriversDepthFormula) {
  const DepthCamera<> camera{550, 545, 320, 240, 0.0, 1.0};
  const Vector3<double> p =
      camera.point(Vector3<double>(320, 240, 2.0), std::array<double, 6>{0, 0, 0, 0, 0.01, -0.1});
  EXPECT_LE((p - Vector3<double>(0, 0, 2.01 * 0.9)).norm(), 1e-15);
}

TEST(PinholeCamera, ProjectsWithoutDistortion) {
  const PinholeCamera<> camera{500, 510, 320, 240, {}};
  const Eigen::Vector2d pixel =
      camera.project(Vector3<double>(0.2, -0.1, 2.0), std::array<double, 4>{0.1, 0, 0, -0.5});
  EXPECT_LE((pixel - Eigen::Vector2d(550 * 0.1 + 320, -510 * 0.05 + 120)).norm(), 1e-12);
}

/// Figures worked out by hand from the plumb_bob formula at x = 0.1, y = 0.2.
TEST(PinholeCamera, DistortsAsPlumbBobDoes) {
  const PinholeCamera<> camera{1, 1, 0, 0, {0.1, 0.01, 0.002, -0.003, 0.001}};
  const Eigen::Vector2d pixel =
      camera.project(Vector3<double>(0.1, 0.2, 1.0), std::array<double, 4>{});
  const double r2 = 0.05, radial = 1 + 0.1 * r2 + 0.01 * r2 * r2 + 0.001 * r2 * r2 * r2;
  EXPECT_NEAR(pixel.x(), 0.1 * radial + 2 * 0.002 * 0.02 - 0.003 * (r2 + 0.02), 1e-15);
  EXPECT_NEAR(pixel.y(), 0.2 * radial + 0.002 * (r2 + 0.08) + 2 * -0.003 * 0.02, 1e-15);
}

TEST(PinholeCamera, ARectifiedImageIsDescribedByPAndADistortedOneByK) {
  CameraInfo info;
  info.k = {500, 0, 320, 0, 501, 240, 0, 0, 1};
  info.p = {480, 0, 310, 0, 0, 481, 230, 0, 0, 0, 1, 0};
  info.d = {0, 0, 0, 0, 0};
  EXPECT_EQ(PinholeCamera<>::from(info).fx, 480);
  info.d = {0.1, 0, 0, 0, 0};
  EXPECT_EQ(PinholeCamera<>::from(info).fx, 500);
  EXPECT_EQ(PinholeCamera<>::from(info).d[0], 0.1);
}

}  // namespace
}  // namespace kinecal
