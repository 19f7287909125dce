#include "kinecal/capture/finders/image_motion.hpp"

#include <gtest/gtest.h>

#include <random>
#include <stdexcept>

namespace kinecal {
namespace {

GrayImage noisy(double sigma, int level, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal(level, sigma);
  GrayImage image(200, 100);
  for (auto& pixel : image.pixels) {
    pixel = static_cast<std::uint8_t>(std::min(255.0, std::max(0.0, normal(random))));
  }
  return image;
}

constexpr PixelBox kAll{0, 0, 199, 99};

TEST(ImageMotion, NoiseAndLightAreNoMotion) {
  ImageMotion motion;
  motion.add(noisy(5.0, 100, 1), noisy(5.0, 100, 2));
  motion.add(noisy(5.0, 100, 2), noisy(5.0, 150, 3));
  EXPECT_LT(motion.share(kAll), 0.001);
}

TEST(ImageMotion, IsWherePixelsChanged) {
  const GrayImage before = noisy(3.0, 100, 1);
  GrayImage after = noisy(3.0, 100, 2);
  for (int v = 10; v < 30; ++v) {
    for (int u = 50; u < 70; ++u) after(u, v) = 200;
  }
  ImageMotion motion;
  motion.add(before, after);
  motion.add(before, before);  // what changed once is remembered
  EXPECT_NEAR(motion.share(kAll), 0.02, 0.001);
  EXPECT_EQ(motion.share({50, 10, 69, 29}), 1.0);
  EXPECT_EQ(motion.share({45, 5, 74, 34}, {50, 10, 69, 29}), 0.0);
  EXPECT_EQ(motion.share({-50, -50, -1, -1}), 0.0) << "outside of the image";
}

TEST(ImageMotion, OfSizesThatDifferIsAnError) {
  ImageMotion motion;
  EXPECT_EQ(motion.share(kAll), 0.0);
  EXPECT_THROW(motion.add(GrayImage(4, 4), GrayImage(4, 3)), std::invalid_argument);
  EXPECT_THROW(motion.add(GrayImage(8, 2), GrayImage(8, 2)), std::invalid_argument);
}

}  // namespace
}  // namespace kinecal
