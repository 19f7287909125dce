#include "kinecal/errors/plane_fit.hpp"

#include <gtest/gtest.h>

#include <random>

namespace kinecal {
namespace {

std::vector<Vector3<double>> noisy_plane(double noise) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> side(-1.0, 1.0);
  std::normal_distribution<double> normal(0.0, noise > 0 ? noise : 1.0);
  std::vector<Vector3<double>> points;
  const Matrix3<double> turn = exp(Vector3<double>(0.3, -0.5, 0.2));
  for (int i = 0; i < 20; ++i) {
    points.push_back(
        turn * Vector3<double>(side(random), 0.4 * side(random), noise > 0 ? normal(random) : 0.0) +
        Vector3<double>(1, 2, 3));
  }
  return points;
}

TEST(PlaneFit, FindsTheNormalAndCentroid) {
  const auto points = noisy_plane(0.0);
  const PlaneFit<double> fit(points);
  ASSERT_TRUE(fit.determined());
  const Vector3<double> normal = exp(Vector3<double>(0.3, -0.5, 0.2)).col(2);
  EXPECT_NEAR(std::abs(fit.plane().normal.dot(normal)), 1.0, 1e-14);
  for (const auto& p : points) {
    EXPECT_NEAR((p - fit.plane().centroid).dot(fit.plane().normal), 0.0, 1e-14);
  }
}

TEST(PlaneFit, HasTheDerivativesOfCentralDifferences) {
  for (const double noise : {0.0, 0.05}) {
    auto points = noisy_plane(noise);
    const PlaneFit<double> fit(points);
    for (std::size_t i = 0; i < points.size(); i += 7) {
      for (int k = 0; k < 3; ++k) {
        constexpr double kStep = 1e-6;
        const Vector3<double> saved = points[i];
        points[i](k) = saved(k) + kStep;
        const Plane<double> up = PlaneFit<double>(points).plane();
        points[i](k) = saved(k) - kStep;
        const Plane<double> down = PlaneFit<double>(points).plane();
        points[i] = saved;
        const double side = up.normal.dot(fit.plane().normal) < 0 ? -1.0 : 1.0;
        const double other = down.normal.dot(fit.plane().normal) < 0 ? -1.0 : 1.0;
        const Vector3<double> numeric = (up.normal * side - down.normal * other) / (2 * kStep);
        EXPECT_LE((fit.normal_by_point(saved).col(k) - numeric).norm(), 1e-8);
        const Vector3<double> shift = (up.centroid - down.centroid) / (2 * kStep);
        EXPECT_LE((fit.centroid_by_point().col(k) - shift).norm(), 1e-8);
      }
    }
  }
}

TEST(PlaneFit, KnowsWhenThePointsSpanNoPlane) {
  const std::vector<Vector3<double>> line = {{0, 0, 0}, {1, 1, 1}, {2, 2, 2}, {-3, -3, -3}};
  EXPECT_FALSE(PlaneFit<double>(line).determined());
  EXPECT_FALSE(PlaneFit<double>(std::span(line).first(2)).determined());
  const std::vector<Vector3<double>> cube = {{1, 0, 0},  {-1, 0, 0}, {0, 1, 0},
                                             {0, -1, 0}, {0, 0, 1},  {0, 0, -1}};
  EXPECT_FALSE(PlaneFit<double>(cube).determined());
}

}  // namespace
}  // namespace kinecal
