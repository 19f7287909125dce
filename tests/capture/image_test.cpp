#include "kinecal/capture/image.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>

namespace kinecal {
namespace {

CameraInfo small_camera() {
  CameraInfo camera;
  camera.width = 3;
  camera.height = 2;
  camera.p = {100, 0, 1, 0, 0, 200, 0.5, 0, 0, 0, 1, 0};
  return camera;
}

TEST(Image, DepthBecomesPointsByTheProjection) {
  DepthImage depth(3, 2, 2.0F);
  depth(0, 1) = std::numeric_limits<float>::quiet_NaN();
  depth(1, 1) = 0.0F;
  const PointCloud points = points_of(depth, small_camera());
  EXPECT_FLOAT_EQ(points(2, 0).x(), 0.02F);
  EXPECT_FLOAT_EQ(points(2, 0).y(), -0.005F);
  EXPECT_FLOAT_EQ(points(2, 0).z(), 2.0F);
  EXPECT_TRUE(std::isnan(points(0, 1).z()));
  EXPECT_TRUE(std::isnan(points(1, 1).z()));  // zero is how drivers say "nothing"
}

TEST(Image, DepthOfAnotherSizeThanItsCameraIsRefused) {
  EXPECT_THROW((void)points_of(DepthImage(2, 2, 1.0F), small_camera()), std::invalid_argument);
  CameraInfo blank = small_camera();
  blank.p = {};
  EXPECT_THROW((void)points_of(DepthImage(3, 2, 1.0F), blank), std::invalid_argument);
}

}  // namespace
}  // namespace kinecal
