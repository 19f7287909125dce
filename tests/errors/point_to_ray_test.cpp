#include "kinecal/errors/point_to_ray.hpp"

#include <gtest/gtest.h>

namespace kinecal {
namespace {

static_assert(ErrorBlock<PointToRay> && kResiduals<PointToRay> == 3);

Ray<double> along_x() {
  return {.origin = {1.0, 2.0, 3.0}, .direction = {5.0, 0.0, 0.0}};
}

TEST(PointToRay, IsTheDistanceFromTheLine) {
  const Vector3<double> r = PointToRay{}(Vector3<double>(7.0, 2.3, 3.4), along_x());
  EXPECT_NEAR(r.norm(), 0.5, 1e-15);
  EXPECT_EQ(r.x(), 0.0) << "perpendicular to the line";
}

TEST(PointToRay, IsDefinedBehindTheCameraAndInIt) {
  const auto distance = [](double x) {
    return PointToRay{}(Vector3<double>(x, 2.0, 3.5), along_x()).norm();
  };
  EXPECT_NEAR(distance(-4.0), 0.5, 1e-15);
  EXPECT_NEAR(distance(1.0), 0.5, 1e-15);
}

TEST(PointToRay, IsZeroOnTheLine) {
  EXPECT_EQ(PointToRay{}(Vector3<double>(9.0, 2.0, 3.0), along_x()).norm(), 0.0);
}

}  // namespace
}  // namespace kinecal
