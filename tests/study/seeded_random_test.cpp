#include "kinecal/study/seeded_random.hpp"

#include <gtest/gtest.h>

namespace kinecal {
namespace {

TEST(SeededRandom, IsTheSameForTheSameSeed) {
  SeededRandom a(7), b(7), other(8);
  for (int i = 0; i < 100; ++i) {
    const double x = a.uniform(-1.0, 1.0);
    EXPECT_EQ(x, b.uniform(-1.0, 1.0));
    EXPECT_NE(x, other.uniform(-1.0, 1.0));
  }
}

TEST(SeededRandom, IsDistributedAsItSays) {
  SeededRandom random(1);
  constexpr int kDraws = 20000;
  double mean = 0.0, variance = 0.0;
  for (int i = 0; i < kDraws; ++i) {
    const double x = random.normal();
    mean += x / kDraws;
    variance += x * x / kDraws;
    const int n = random.integer(2, 4);
    EXPECT_TRUE(n >= 2 && n <= 4);
    EXPECT_NEAR(random.direction().norm(), 1.0, 1e-12);
  }
  EXPECT_NEAR(mean, 0.0, 5.0 / std::sqrt(kDraws));
  EXPECT_NEAR(variance, 1.0, 5.0 * std::sqrt(2.0 / kDraws));
}

}  // namespace
}  // namespace kinecal
