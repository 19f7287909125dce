#include <gtest/gtest.h>

#include <random>

#include "kinecal/sensors/depth_camera.hpp"
#include "kinecal/sensors/pinhole_camera.hpp"

namespace kinecal {
namespace {

/// The point of a measurement, for any scalar of the parameters.
template <class S>
Vector3<S> point(const std::array<double, 6>& settings, const Vector3<double>& measured,
                 const std::array<S, 6>& v) {
  return DepthCamera{}.place(
      Measurement<DepthCamera, double>{.point = measured, .settings = settings}, v);
}

TEST(DepthCamera, GivesBackTheRecordedPointWithTheRecordedSettings) {
  const std::array<double, 6> camera{550, 545, 320, 240, 0.012, 1.02};
  const Vector3<double> p(0.2, -0.1, 0.9);
  const Vector3<double> again =
      point(camera, DepthCamera::measurement(p, camera), DepthCamera::initial(camera));
  EXPECT_LE((again - p).norm(), 1e-15);
}

TEST(DepthCamera, FollowsTheDriversDepthFormula) {
  const Vector3<double> p =
      point<double>({550, 545, 320, 240, 0.0, 1.0}, {320, 240, 2.0}, {0, 0, 0, 0, 0.01, -0.1});
  EXPECT_LE((p - Vector3<double>(0, 0, 2.01 * 0.9)).norm(), 1e-15);
}

/// Figures worked out by hand, away from the centre: the pixel, its raw depth and the point.
TEST(DepthCamera, FindsThePixelAndRawDepthOfAPoint) {
  const std::array<double, 6> camera{500, 400, 320, 240, 0.02, 1.25};
  const Vector3<double> measured = DepthCamera::measurement({0.5, -0.25, 1.25}, camera);
  EXPECT_LE((measured - Vector3<double>(520, 160, 0.98)).norm(), 1e-12);
  // fx = 1000, fy = 200, cx = 160, cy = 360, z = (0.98 + 0.52) * 2
  const Vector3<double> p = point<double>(camera, measured, {1.0, -0.5, -0.5, 0.5, 0.52, 1.0});
  EXPECT_LE((p - Vector3<double>(360 * 3.0 / 1000, -200 * 3.0 / 200, 3.0)).norm(), 1e-12);
}

TEST(DepthCamera, TakesItsSettingsFromPAndItsDriver) {
  CameraInfo info;
  info.k = {500, 0, 320, 0, 501, 240, 0, 0, 1};
  info.p = {480, 0, 310, 0, 0, 481, 230, 0, 0, 0, 1, 0};
  info.z_offset = 0.01;
  info.z_scaling = 1.1;
  EXPECT_EQ(DepthCamera::settings({"camera", {}, info}),
            (std::array<double, 6>{480, 481, 310, 230, 0.01, 1.1}));
}

/// Random settings, measurements and a pose: others in each lane.
template <class Q>
struct RandomViews {
  std::array<Q, 6> camera;
  Vector3<Q> measured;
  Pose<Q> pose;
  std::vector<std::array<double, 6>> cameras;
  std::vector<Vector3<double>> pixels;
  std::vector<Pose<double>> poses;

  explicit RandomViews(unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> focal(400, 600), pixel(0, 500), depth(0.3, 3.0),
        small(-0.02, 0.02), any(-1.0, 1.0);
    for (int i = 0; i < kLanes<Q>; ++i) {
      cameras.push_back({focal(random), focal(random), pixel(random), pixel(random), small(random),
                         1.0 + small(random)});
      pixels.push_back(Vector3<double>{pixel(random), pixel(random), depth(random)});
      poses.push_back({exp(Vector3<double>{any(random), any(random), any(random)}),
                       Vector3<double>{any(random), any(random), any(random)}});
      for (std::size_t k = 0; k < 6; ++k) set_lane(camera[k], i, cameras.back()[k]);
      for (int k = 0; k < 3; ++k) {
        set_lane(measured(k), i, pixels.back()(k));
        set_lane(pose.translation(k), i, poses.back().translation(k));
        for (int c = 0; c < 3; ++c) {
          set_lane(pose.rotation(k, c), i, poses.back().rotation(k, c));
        }
      }
    }
  }
};

/// CorrectedDepthCamera against DepthCamera::place on jets, in each lane.
template <class Q>
void expect_the_jets_of_a_depth_camera(const std::array<double, 6>& v, unsigned seed) {
  constexpr double kRounding = 1e-14;  // two dozen operations on metres, metres per unit
  const RandomViews<Q> views(seed);
  const CorrectedDepthCamera<Q> corrected(views.pose, views.camera, v);
  const std::array<int, 6> all = {0, 1, 2, 3, 4, 5}, some = {2, 5, 0, 0, 0, 0};
  std::array<Vector3<Q>, 6> changes, of_some;
  const Vector3<Q> found = corrected.place(views.measured, all, changes.data());
  (void)corrected.place(views.measured, std::span(some).first(2), of_some.data());
  using J = Jet<double, 6>;
  std::array<J, 6> variables;
  for (std::size_t k = 0; k < 6; ++k) variables[k] = J(v[k], static_cast<int>(k));
  for (int i = 0; i < kLanes<Q>; ++i) {
    const auto n = static_cast<std::size_t>(i);
    const Vector3<J> jets = point(views.cameras[n], views.pixels[n], variables);
    const Vector3<double> p(jets.x().a, jets.y().a, jets.z().a);
    const Vector3<double> p_base = views.poses[n] * p;
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(lane(found(k), i), p_base(k), kRounding);
    for (int parameter = 0; parameter < 6; ++parameter) {
      const Vector3<double> by(jets.x().v(parameter), jets.y().v(parameter), jets.z().v(parameter));
      const Vector3<double> expected = views.poses[n].rotation * by;
      for (int k = 0; k < 3; ++k) {
        EXPECT_NEAR(lane(changes[static_cast<std::size_t>(parameter)](k), i), expected(k),
                    kRounding)
            << "parameter " << parameter << ", lane " << i;
      }
    }
    for (int k = 0; k < 3; ++k) {
      EXPECT_EQ(lane(of_some[0](k), i), lane(changes[2](k), i));
      EXPECT_EQ(lane(of_some[1](k), i), lane(changes[5](k), i));
    }
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
  const std::array<double, 9> camera{500, 510, 320, 240};
  const Eigen::Vector2d pixel = PinholeCamera{}.predict(Vector3<double>(0.2, -0.1, 2.0), camera,
                                                        std::array<double, 4>{0.1, 0, 0, -0.5});
  EXPECT_LE((pixel - Eigen::Vector2d(550 * 0.1 + 320, -510 * 0.05 + 120)).norm(), 1e-12);
}

/// Figures worked out by hand from the plumb_bob formula at x = 0.1, y = 0.2.
TEST(PinholeCamera, DistortsAsPlumbBobDoes) {
  const std::array<double, 9> camera{1, 1, 0, 0, 0.1, 0.01, 0.002, -0.003, 0.001};
  const Eigen::Vector2d pixel =
      PinholeCamera{}.predict(Vector3<double>(0.1, 0.2, 1.0), camera, std::array<double, 4>{});
  const double r2 = 0.05, radial = 1 + 0.1 * r2 + 0.01 * r2 * r2 + 0.001 * r2 * r2 * r2;
  EXPECT_NEAR(pixel.x(), 0.1 * radial + 2 * 0.002 * 0.02 - 0.003 * (r2 + 0.02), 1e-15);
  EXPECT_NEAR(pixel.y(), 0.2 * radial + 0.002 * (r2 + 0.08) + 2 * -0.003 * 0.02, 1e-15);
}

/// The ray to a pixel goes through the points that appear there, also through a lens.
TEST(PinholeCamera, SeesAlongTheRayToItsPixel) {
  const std::array<double, 4> v{0.02, -0.01, 0.03, -0.02};
  for (const auto& camera :
       {std::array<double, 9>{500, 510, 320, 240},
        std::array<double, 9>{500, 510, 320, 240, -0.2, 0.05, 1e-3, -2e-3, 0.0}}) {
    const Vector3<double> p(0.3, -0.2, 1.0);
    const Eigen::Vector2d pixel = PinholeCamera{}.predict(p, camera, v);
    const Measurement<PinholeCamera, double> m{.point = {pixel.x(), pixel.y(), 0.0},
                                               .settings = camera};
    const Ray<double> ray = PinholeCamera{}.place(m, v);
    EXPECT_LE((ray.direction - p).norm(), 1e-12);
    EXPECT_EQ(ray.origin, Vector3<double>(0, 0, 0));
  }
}

TEST(PinholeCamera, ARectifiedImageIsDescribedByPAndADistortedOneByK) {
  CameraInfo info;
  info.k = {500, 0, 320, 0, 501, 240, 0, 0, 1};
  info.p = {480, 0, 310, 0, 0, 481, 230, 0, 0, 0, 1, 0};
  const std::array<double, 9> rectified{480, 481, 310, 230};
  const auto settings = [&] { return PinholeCamera::settings({"eye", {}, info}); };
  info.d = {0, 0, 0, 0, 0};
  EXPECT_EQ(settings(), rectified);
  info.d = {0.1, 0, 0, 0, 0};
  EXPECT_EQ(settings(), (std::array<double, 9>{500, 501, 320, 240, 0.1}));
  info.d = {};
  EXPECT_EQ(settings(), rectified);
}

}  // namespace
}  // namespace kinecal
