#include "kinecal/capture/finders/light_blob.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace kinecal {
namespace {

Image<float> gaussian(double at_u, double at_v, double along, double across) {
  Image<float> light(60, 40);
  for (int v = 0; v < 40; ++v) {
    for (int u = 0; u < 60; ++u) {
      const double x = (u - at_u) / along, y = (v - at_v) / across;
      light(u, v) = static_cast<float>(1000.0 * std::exp(-0.5 * (x * x + y * y)));
    }
  }
  return light;
}

TEST(LightBlob, CentroidIsBetweenPixels) {
  for (double shift = -0.5; shift <= 0.5; shift += 0.1) {
    for (const double sigma : {0.8, 1.5, 4.0}) {
      Image<float> light = gaussian(30.0 + shift, 20.0 - 0.5 * shift, sigma, sigma);
      const LightBlob blob = light_blob(light, {30, 20});
      EXPECT_NEAR(blob.u, 30.0 + shift, 0.15) << sigma;
      EXPECT_NEAR(blob.v, 20.0 - 0.5 * shift, 0.15) << sigma;
      EXPECT_LT(blob.elongation(), 1.3) << sigma;
      for (float& level : light.pixels) level = std::min(level, 400.0F);  // saturated
      EXPECT_NEAR(light_blob(light, {30, 20}).u, 30.0 + shift, 0.15) << sigma;
    }
  }
}

TEST(LightBlob, KnowsASmearFromADisc) {
  EXPECT_GT(light_blob(gaussian(30.0, 20.0, 6.0, 1.0), {30, 20}).elongation(), 2.5);
  EXPECT_GT(light_blob(gaussian(30.0, 20.0, 1.0, 6.0), {30, 20}).elongation(), 2.5);
}

TEST(LightBlob, OfOnePixelIsThere) {
  Image<float> light(1, 1, 5.0F);
  const LightBlob blob = light_blob(light, {0, 0});
  EXPECT_EQ(blob.u, 0.0);
  EXPECT_EQ(blob.pixels, 1);
  EXPECT_EQ(blob.elongation(), 1.0);
}

}  // namespace
}  // namespace kinecal
