#include <gtest/gtest.h>

#include <random>

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

/// Figures worked out by hand, away from the centre: the pixel, its raw depth and the point.
TEST(DepthCamera, FindsThePixelAndRawDepthOfAPoint) {
  const DepthCamera<> camera{500, 400, 320, 240, 0.02, 1.25};
  const Vector3<double> measured = camera.measurement({0.5, -0.25, 1.25});
  EXPECT_LE((measured - Vector3<double>(520, 160, 0.98)).norm(), 1e-12);
  // fx = 1000, fy = 200, cx = 160, cy = 360, z = (0.98 + 0.52) * 2
  const Vector3<double> p =
      camera.point(measured, std::array<double, 6>{1.0, -0.5, -0.5, 0.5, 0.52, 1.0});
  EXPECT_LE((p - Vector3<double>(360 * 3.0 / 1000, -200 * 3.0 / 200, 3.0)).norm(), 1e-12);
}

TEST(DepthCamera, TakesItsSettingsFromPAndItsDriver) {
  CameraInfo info;
  info.k = {500, 0, 320, 0, 501, 240, 0, 0, 1};
  info.p = {480, 0, 310, 0, 0, 481, 230, 0, 0, 0, 1, 0};
  info.z_offset = 0.01;
  info.z_scaling = 1.1;
  const DepthCamera<> camera = DepthCamera<>::from(info);
  EXPECT_EQ(camera.fx, 480);
  EXPECT_EQ(camera.fy, 481);
  EXPECT_EQ(camera.cx, 310);
  EXPECT_EQ(camera.cy, 230);
  EXPECT_EQ(camera.z_offset, 0.01);
  EXPECT_EQ(camera.z_scaling, 1.1);
}

/// Random settings and measurements: another camera and another pixel in each lane.
template <class Q>
struct RandomViews {
  DepthCamera<Q> camera;
  Vector3<Q> measured;
  std::vector<DepthCamera<double>> cameras;
  std::vector<Vector3<double>> pixels;

  explicit RandomViews(unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> focal(400, 600), pixel(0, 500), depth(0.3, 3.0),
        small(-0.02, 0.02);
    for (int i = 0; i < kLanes<Q>; ++i) {
      cameras.push_back({focal(random), focal(random), pixel(random), pixel(random), small(random),
                         1.0 + small(random)});
      pixels.push_back(Vector3<double>{pixel(random), pixel(random), depth(random)});
      set_lane(camera.fx, i, cameras.back().fx);
      set_lane(camera.fy, i, cameras.back().fy);
      set_lane(camera.cx, i, cameras.back().cx);
      set_lane(camera.cy, i, cameras.back().cy);
      set_lane(camera.z_offset, i, cameras.back().z_offset);
      set_lane(camera.z_scaling, i, cameras.back().z_scaling);
      for (int k = 0; k < 3; ++k) set_lane(measured(k), i, pixels.back()(k));
    }
  }
};

/// CorrectedDepthCamera against DepthCamera::point on jets, in each lane.
template <class Q>
void expect_the_jets_of_a_depth_camera(const std::array<double, 6>& v, unsigned seed) {
  constexpr double kRounding = 1e-14;  // a dozen operations on metres, metres per unit
  const RandomViews<Q> views(seed);
  const CorrectedDepthCamera<Q> corrected(views.camera, v);
  const auto seen = corrected.see(views.measured);
  using J = Jet<double, 6>;
  std::array<J, 6> variables;
  for (std::size_t k = 0; k < 6; ++k) variables[k] = J(v[k], static_cast<int>(k));
  for (int i = 0; i < kLanes<Q>; ++i) {
    const auto n = static_cast<std::size_t>(i);
    const Vector3<double> p = views.cameras[n].point(views.pixels[n], v);
    const Eigen::Matrix<J, 3, 1> jets = views.cameras[n].point(views.pixels[n], variables);
    Eigen::Matrix<double, 3, 6> expected, found = Eigen::Matrix<double, 3, 6>::Zero();
    for (int k = 0; k < 3; ++k) {
      const Q ray = k == 0 ? seen.s : k == 1 ? seen.t : Q(1.0);
      EXPECT_NEAR(lane(ray * seen.depth, i), p(k), kRounding);
      expected.row(k) = jets(k).v.transpose();
      found(k, 4) = lane(ray * seen.depth_by_offset, i);
      found(k, 5) = lane(ray * seen.depth_by_scaling, i);
    }
    found(0, 0) = lane(seen.x_by_fx, i);
    found(1, 1) = lane(seen.y_by_fy, i);
    found(0, 2) = lane(seen.x_by_cx, i);
    found(1, 3) = lane(seen.y_by_cy, i);
    EXPECT_LE((found - expected).cwiseAbs().maxCoeff(), kRounding) << "lane " << i << "\n"
                                                                   << found << "\njets\n"
                                                                   << expected;
  }
}

class CorrectedDepthCameras : public testing::TestWithParam<unsigned> {};

TEST_P(CorrectedDepthCameras, SeeThePointsOfADepthCameraAndItsDerivatives) {
  std::array<double, 6> v = {};  // first the settings as recorded
  if (GetParam() > 0) {
    std::mt19937 random(GetParam());
    std::normal_distribution<double> normal(0.0, 0.1);
    for (double& value : v) value = normal(random);
  }
  expect_the_jets_of_a_depth_camera<double>(v, 100 + GetParam());
  expect_the_jets_of_a_depth_camera<Packet>(v, 200 + GetParam());
}

INSTANTIATE_TEST_SUITE_P(AtZeroAndRandom, CorrectedDepthCameras, testing::Range(0u, 20u));

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
  EXPECT_EQ(PinholeCamera<>::from(info).d[0], 0.1);
  const auto numbers = [](const PinholeCamera<>& c) {
    return std::array<double, 4>{c.fx, c.fy, c.cx, c.cy};
  };
  EXPECT_EQ(numbers(PinholeCamera<>::from(info)), (std::array<double, 4>{500, 501, 320, 240}));
  info.d = {};
  EXPECT_EQ(numbers(PinholeCamera<>::from(info)), (std::array<double, 4>{480, 481, 310, 230}));
}

}  // namespace
}  // namespace kinecal
