#include "kinecal/errors/point_to_outline.hpp"

#include <gtest/gtest.h>

namespace kinecal {
namespace {

static_assert(ErrorBlock<PointToOutline> && kResiduals<PointToOutline> == 1 &&
              PixelBlock<PointToOutline>);

TEST(PointToOutline, IsTheDistanceAlongTheNormal) {
  const Eigen::Vector2d edge(100.0, 50.0), n(0.6, 0.8);
  const auto distance = [&](const Eigen::Vector2d& outline) {
    const PixelObservation<double> pixel{outline, edge};
    return PointToOutline{}(pixel, std::array{n.x(), n.y()})(0);
  };
  EXPECT_NEAR(distance(edge + 3.0 * n), 3.0, 1e-14);
  EXPECT_NEAR(distance(edge - 3.0 * n), -3.0, 1e-14) << "the outline is inside of the mask";
  EXPECT_NEAR(distance(edge + Eigen::Vector2d(0.8, -0.6)), 0.0, 1e-14) << "along the outline";
}

}  // namespace
}  // namespace kinecal
