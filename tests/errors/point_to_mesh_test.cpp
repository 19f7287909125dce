#include "kinecal/errors/point_to_mesh.hpp"

#include <gtest/gtest.h>

namespace kinecal {
namespace {

static_assert(ErrorBlock<PointToMesh> && kResiduals<PointToMesh> == 1);

TEST(PointToMesh, IsTheDistanceAlongTheNormal) {
  const Vector3<double> q(0.1, 0.2, 0.3), n(0.6, 0.0, 0.8);
  const auto distance = [&](const Vector3<double>& p) {
    return PointToMesh{}(p, q, std::array{n.x(), n.y(), n.z()})(0);
  };
  EXPECT_NEAR(distance(q + 0.02 * n), 0.02, 1e-16);
  EXPECT_NEAR(distance(q - 0.02 * n), -0.02, 1e-16) << "inside";
  EXPECT_NEAR(distance(q + Vector3<double>(0.8, 1.0, -0.6)), 0.0, 1e-15) << "along the surface";
}

}  // namespace
}  // namespace kinecal
