// SPDX-License-Identifier: Apache-2.0
#include "kinecal/trust/lens_pattern.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "support/pixel_scene.hpp"
#include "support/repetitions.hpp"

namespace kinecal {
namespace {

TEST(LensPattern, FindsK1OfBoardsWithItsSize) {
  for (const double k1 : {0.05, -0.1, 0.2, -0.3}) {
    const auto found = test::PixelScene{.k1 = k1}.found();
    ASSERT_TRUE(found) << k1;
    EXPECT_EQ(found->sensor, "eye");
    EXPECT_EQ(found->taken, TakenLens::none);
    EXPECT_NEAR(found->k1, k1, 0.3 * std::abs(k1)) << k1;  // other parameters have absorbed a part
    EXPECT_GT(found->pixels * k1, 0.0) << k1;
    EXPECT_LT(found->noise_left, 0.95) << k1;
  }
}

}  // namespace
}  // namespace kinecal
