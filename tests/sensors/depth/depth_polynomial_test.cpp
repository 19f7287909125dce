#include "kinecal/sensors/depth/depth_polynomial.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cstring>
#include <random>

#include "kinecal/sensors/depth/depth_camera.hpp"
#include "kinecal/sensors/depth/true_depth.hpp"

namespace kinecal {
namespace {

// Derivatives, packets and those by some parameters: tests/testing/check_sensor_test.cpp.

constexpr std::array<double, 6> kRecorded = {500, 400, 320, 240, 0.02, 1.25};
constexpr DepthCamera::Values kBent = {0.01,  -0.02, 0.015, -0.01, 0.004, -0.03,
                                       0.012, 0.03,  -0.02, 0.05,  0.04,  -0.06};

Vector3<double> bent_point(const Vector3<double>& measured, const DepthCamera::Values& v) {
  return DepthCamera{}.place(
      Measurement<DepthCamera, double>{.point = measured, .settings = kRecorded}, v);
}

/// Pixels and raw depths in the image.
std::vector<Vector3<double>> random_pixels(int count) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> u(0, 640), v(0, 480), z(0.4, 3.0);
  std::vector<Vector3<double>> all;
  for (int i = 0; i < count; ++i) all.emplace_back(u(random), v(random), z(random));
  return all;
}

/// The same bits, not just the same number.
void expect_same_bits(const Vector3<double>& a, const Vector3<double>& b) {
  EXPECT_EQ(std::memcmp(a.data(), b.data(), 3 * sizeof(double)), 0) << a << "\n" << b;
}

/// Worked out by hand at x = 0.4, y = -0.2: the raw depth 0.98 becomes (0.98 + 0.02) 2 = 2.
TEST(DepthPolynomial, IsAFactorOfTheDepth) {
  const Vector3<double> measured(520, 160, 0.98);
  const auto depth = [&](std::size_t k, double value) {
    DepthCamera::Values v = {0, 0, 0, 0, 0.02, 1.0};
    v[k] = value;
    return bent_point(measured, v).z();
  };
  EXPECT_NEAR(depth(6, 0.1), 2.0 * 1.2, 1e-14);
  EXPECT_NEAR(depth(7, 0.1), 2.0 * 1.04, 1e-14);
  EXPECT_NEAR(depth(8, 0.1), 2.0 * 0.98, 1e-14);
  EXPECT_NEAR(depth(9, 0.1), 2.0 * 1.016, 1e-14);
  EXPECT_NEAR(depth(10, 0.1), 2.0 * 0.992, 1e-14);
  EXPECT_NEAR(depth(11, 0.1), 2.0 * 1.004, 1e-14);
}

TEST(DepthPolynomial, LeavesThePointOnItsRay) {
  DepthCamera::Values plain = kBent;
  std::fill(plain.begin() + DepthCamera::kWithoutPolynomial, plain.end(), 0.0);
  for (const Vector3<double>& pixel : random_pixels(20)) {
    const Vector3<double> bent = bent_point(pixel, kBent), straight = bent_point(pixel, plain);
    EXPECT_LE(bent.cross(straight).norm(), 1e-14 * bent.squaredNorm());
    EXPECT_GT((bent - straight).norm(), 1e-4);
  }
}

/// Held at zero, points and derivatives have the same bits as without it; free at zero, points.
TEST(DepthPolynomial, OfZerosChangesNoBit) {
  const Pose<double> pose{exp(Vector3<double>(0.3, -0.2, 0.9)), {0.1, -0.4, 1.2}};
  DepthCamera::Values v = kBent;
  std::fill(v.begin() + DepthCamera::kWithoutPolynomial, v.end(), 0.0);
  std::array<double, 6> six{};
  std::copy_n(v.begin(), 6, six.begin());
  const std::array<int, 6> usual = {0, 1, 2, 3, 4, 5};
  const std::array<int, 12> all = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11};
  const CorrectedDepthCamera<double> without(pose, kRecorded, six), with(pose, kRecorded, v);
  for (const Vector3<double>& pixel : random_pixels(50)) {
    std::array<Vector3<double>, 12> a, b, c;
    const Vector3<double> point = without.place(pixel, usual, a.data());
    expect_same_bits(with.place(pixel, usual, b.data()), point);
    expect_same_bits(with.place(pixel, all, c.data()), point);
    for (std::size_t k = 0; k < 6; ++k) {
      expect_same_bits(a[k], b[k]);
      EXPECT_LE((a[k] - c[k]).norm(), 1e-15 * a[k].norm());  // multiplied in another order
    }
    const Measurement<DepthCamera, double> m{.point = pixel, .settings = kRecorded};
    expect_same_bits(DepthCamera{}.place(m, v), DepthCamera{}.place(m, six));
  }
}

/// What a driver applies is what was evaluated, also where it has some of it already.
TEST(TrueDepth, IsTheDepthOfThePoint) {
  DepthErrors e{.fx = 500, .fy = 400, .cx = 320, .cy = 240};
  e.recorded_z_offset = kRecorded[4];
  e.recorded_z_scaling = kRecorded[5];
  e.z_offset = kBent[4];
  e.z_scaling = kBent[5];
  e.z_quadratic = kBent[6];
  e.z_x = kBent[7];
  e.z_y = kBent[8];
  e.z_xx = kBent[9];
  e.z_xy = kBent[10];
  e.z_yy = kBent[11];
  DepthErrors of_new_driver = e;
  of_new_driver.recorded_z_offset = e.z_offset;
  of_new_driver.recorded_z_scaling = 1.0 + e.z_scaling;
  for (const Vector3<double>& pixel : random_pixels(50)) {
    const double u = pixel.x(), v = pixel.y(), raw = pixel.z();
    const double z = bent_point(pixel, kBent).z();
    EXPECT_NEAR(true_depth(e, u, v, (raw + kRecorded[4]) * kRecorded[5]), z, 1e-14 * z);
    EXPECT_NEAR(true_depth(of_new_driver, u, v, (raw + e.z_offset) * (1.0 + e.z_scaling)), z,
                1e-14 * z);
  }
  EXPECT_EQ(true_depth(e, 320, 240, 0.0), 0.0) << "a pixel without measurement";
}

TEST(TrueDepth, OfACameraWithoutErrorsIsTheMeasuredDepth) {
  for (const Vector3<double>& pixel : random_pixels(50)) {
    EXPECT_EQ(true_depth(DepthErrors{}, pixel.x(), pixel.y(), pixel.z()), pixel.z());
  }
}

}  // namespace
}  // namespace kinecal
