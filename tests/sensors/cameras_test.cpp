#include <gtest/gtest.h>

#include "kinecal/sensors/depth/depth_camera.hpp"
#include "kinecal/sensors/lens_camera.hpp"

namespace kinecal {
namespace {

// Derivatives, packets and rays of both: tests/testing/check_sensor_test.cpp.

/// The point of a measurement, for any scalar of the parameters.
template <class S, std::size_t N>
Vector3<S> point(const std::array<double, 6>& settings, const Vector3<double>& measured,
                 const std::array<S, N>& v) {
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
      point<double, 6>({550, 545, 320, 240, 0.0, 1.0}, {320, 240, 2.0}, {0, 0, 0, 0, 0.01, -0.1});
  EXPECT_LE((p - Vector3<double>(0, 0, 2.01 * 0.9)).norm(), 1e-15);
}

/// Figures worked out by hand, away from the centre: the pixel, its raw depth and the point.
TEST(DepthCamera, FindsThePixelAndRawDepthOfAPoint) {
  const std::array<double, 6> camera{500, 400, 320, 240, 0.02, 1.25};
  const Vector3<double> measured = DepthCamera::measurement({0.5, -0.25, 1.25}, camera);
  EXPECT_LE((measured - Vector3<double>(520, 160, 0.98)).norm(), 1e-12);
  // fx = 1000, fy = 200, cx = 160, cy = 360, z = (0.98 + 0.52) * 2
  const Vector3<double> p = point<double, 6>(camera, measured, {1.0, -0.5, -0.5, 0.5, 0.52, 1.0});
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

TEST(PinholeCamera, ProjectsWithoutDistortion) {
  const std::array<double, 12> camera{500, 510, 320, 240};
  const Eigen::Vector2d pixel = PinholeCamera{}.predict(Vector3<double>(0.2, -0.1, 2.0), camera,
                                                        std::array<double, 4>{0.1, 0, 0, -0.5});
  EXPECT_LE((pixel - Eigen::Vector2d(550 * 0.1 + 320, -510 * 0.05 + 120)).norm(), 1e-12);
}

/// Figures worked out by hand from the plumb_bob formula at x = 0.1, y = 0.2.
TEST(PinholeCamera, DistortsAsPlumbBobDoes) {
  const std::array<double, 12> camera{1, 1, 0, 0, 0.1, 0.01, 0.002, -0.003, 0.001};
  const Eigen::Vector2d pixel =
      PinholeCamera{}.predict(Vector3<double>(0.1, 0.2, 1.0), camera, std::array<double, 4>{});
  const double r2 = 0.05, radial = 1 + 0.1 * r2 + 0.01 * r2 * r2 + 0.001 * r2 * r2 * r2;
  EXPECT_NEAR(pixel.x(), 0.1 * radial + 2 * 0.002 * 0.02 - 0.003 * (r2 + 0.02), 1e-15);
  EXPECT_NEAR(pixel.y(), 0.2 * radial + 0.002 * (r2 + 0.08) + 2 * -0.003 * 0.02, 1e-15);
}

/// The quotient of two polynomials, as OpenCV and ROS define it; a pixel is placed where it was seen.
TEST(PinholeCamera, DistortsAsRationalPolynomialDoes) {
  CameraInfo info;
  info.k = {500, 0, 320, 0, 501, 240, 0, 0, 1};
  info.distortion_model = "rational_polynomial";
  info.d = {0.52, -2.1, 6e-4, -2e-4, 1.3, 0.41, -1.9, 1.2};
  const auto settings = [&] { return PinholeCamera{ImageKind::raw}.settings({"eye", {}, info}); };
  const std::array<double, 12> camera = settings();
  const Vector3<double> p(0.3, -0.2, 1.0);
  const Eigen::Vector2d pixel = PinholeCamera{}.predict(p, camera, std::array<double, 4>{});
  const double x = 0.3, y = -0.2, r2 = x * x + y * y;
  const double radial = (1 + 0.52 * r2 - 2.1 * r2 * r2 + 1.3 * r2 * r2 * r2) /
                        (1 + 0.41 * r2 - 1.9 * r2 * r2 + 1.2 * r2 * r2 * r2);
  EXPECT_NEAR(pixel.x(), 320 + 500 * (x * radial + 2 * 6e-4 * x * y - 2e-4 * (r2 + 2 * x * x)),
              1e-12);
  EXPECT_NEAR(pixel.y(), 240 + 501 * (y * radial + 6e-4 * (r2 + 2 * y * y) - 2 * 2e-4 * x * y),
              1e-12);
  Measurement<PinholeCamera, double> seen{};
  seen.point = {pixel.x(), pixel.y(), 0.0};
  seen.settings = camera;
  const auto ray = PinholeCamera{}.place(seen, std::array<double, 4>{});
  EXPECT_LE((ray.direction - p).norm(), 1e-9);
  info.d.resize(12, 0.0);  // thin prism coefficients that are zero
  EXPECT_EQ(settings(), camera);
  info.d.back() = 1e-3;
  EXPECT_THROW((void)settings(), SettingsError);
}

TEST(PinholeCamera, ARectifiedImageIsDescribedByPAndADistortedOneByK) {
  CameraInfo info;
  info.k = {500, 0, 320, 0, 501, 240, 0, 0, 1};
  info.p = {480, 0, 310, 0, 0, 481, 230, 0, 0, 0, 1, 0};
  const std::array<double, 12> rectified{480, 481, 310, 230};
  const auto settings = [&] { return PinholeCamera{}.settings({"eye", {}, info}); };
  info.d = {0, 0, 0, 0, 0};
  EXPECT_EQ(settings(), rectified);
  info.d = {0.1, 0, 0, 0, 0};
  EXPECT_EQ(settings(), (std::array<double, 12>{500, 501, 320, 240, 0.1}));
  info.d = {};
  EXPECT_EQ(settings(), rectified);
}

TEST(PinholeCamera, ANamedImageIsDescribedByItsMatrix) {
  CameraInfo info;
  info.k = {500, 0, 320, 0, 501, 240, 0, 0, 1};
  info.p = {480, 0, 310, 0, 0, 481, 230, 0, 0, 0, 1, 0};
  info.d = {0.1, 0, 0, 0, 0};
  const auto settings = [&](ImageKind image) {
    return PinholeCamera{image}.settings({"eye", {}, info});
  };
  const std::array<double, 12> by_k{500, 501, 320, 240, 0.1}, by_p{480, 481, 310, 230};
  EXPECT_EQ(settings(ImageKind::raw), by_k);
  EXPECT_EQ(settings(ImageKind::rectified), by_p);
  info.distortion_model = "equidistant";
  EXPECT_THROW((void)settings(ImageKind::raw), SettingsError);
  EXPECT_THROW((void)settings(ImageKind::automatic), SettingsError);
  EXPECT_EQ(settings(ImageKind::rectified), by_p);
}

TEST(PinholeCamera, AMatrixOfZerosIsReplacedByTheOtherUnlessItIsNamed) {
  CameraInfo info;
  info.k = {500, 0, 320, 0, 501, 240, 0, 0, 1};
  info.p = {480, 0, 310, 0, 0, 481, 230, 0, 0, 0, 1, 0};
  CameraInfo no_k = info, no_p = info;
  no_k.k = {};
  no_p.p = {};
  const auto settings = [](const CameraInfo& camera, ImageKind image) {
    return PinholeCamera{image}.settings({"eye", {}, camera});
  };
  using enum ImageKind;
  EXPECT_EQ(settings(no_k, automatic), (std::array<double, 12>{480, 481, 310, 230}));
  EXPECT_EQ(settings(no_p, automatic), (std::array<double, 12>{500, 501, 320, 240}));
  no_k.d = {0.1};
  EXPECT_EQ(settings(no_k, automatic), (std::array<double, 12>{480, 481, 310, 230}));
  EXPECT_THROW((void)settings(no_k, raw), SettingsError);
  EXPECT_THROW((void)settings(no_p, rectified), SettingsError);
  no_k.p = {};
  EXPECT_THROW((void)settings(no_k, automatic), SettingsError);
  EXPECT_EQ(DepthCamera::settings({"camera", {}, no_p}),
            (std::array<double, 6>{500, 501, 320, 240, 0, 1}));
}

}  // namespace
}  // namespace kinecal
