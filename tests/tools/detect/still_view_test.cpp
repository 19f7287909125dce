// SPDX-License-Identifier: Apache-2.0
#include "kinecal/tools/detect/still_view.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "kinecal/study/seeded_random.hpp"

namespace kinecal {
namespace {

/// Stripes that begin at a column.
View stripes(int from, double noise = 0.0, std::uint64_t seed = 1) {
  SeededRandom random(seed);
  View view;
  view.image = GrayImage(64, 48);
  for (int v = 0; v < 48; ++v) {
    for (int u = 0; u < 64; ++u) {
      const int stripe = ((u + 64 - from) / 4) % 2;
      view.image(u, v) = static_cast<std::uint8_t>(60 + 100 * stripe + noise * random.normal());
    }
  }
  return view;
}

TEST(StillView, OfImagesThatDifferByNoiseTheMiddleOneIsTaken) {
  const std::vector<View> views = {stripes(0, 2, 1), stripes(0, 2, 2), stripes(0, 2, 3),
                                   stripes(0, 2, 4), stripes(0, 2, 5)};
  const StillView chosen = still_view(views);
  EXPECT_EQ(chosen.refusal, "");
  EXPECT_EQ(chosen.index, 2U);
}

TEST(StillView, TheLongestRestIsTaken) {
  const std::vector<View> views = {stripes(0), stripes(0), stripes(1), stripes(3),
                                   stripes(2), stripes(2), stripes(2)};
  EXPECT_EQ(still_view(views).index, 5U);
}

TEST(StillView, AClearlySharperImageIsTaken) {
  std::vector<View> views(3, stripes(0));
  for (const std::size_t blurred : {0U, 1U}) {
    for (auto& pixel : views[blurred].image.pixels) {
      pixel = static_cast<std::uint8_t>(110 + (pixel - 110) * 8 / 10);
    }
  }
  EXPECT_GT(sharpness(views[2].image), 1.2 * sharpness(views[1].image));
  EXPECT_EQ(still_view(views).index, 2U);
}

TEST(StillView, AnImageThatAlwaysMovesIsRefused) {
  const std::vector<View> views = {stripes(0), stripes(1), stripes(2)};
  EXPECT_THAT(still_view(views).refusal, testing::HasSubstr("the image moves although"));
}

TEST(StillView, ImagesOfOtherSizesMove) {
  std::vector<View> views = {stripes(0), stripes(0)};
  views[1].image = GrayImage(32, 48, 60);
  EXPECT_NE(still_view(views).refusal, "");
}

TEST(StillView, OneImageAndCloudsAreTakenAsTheyAre) {
  EXPECT_EQ(still_view(std::vector<View>{stripes(0)}).refusal, "");
  EXPECT_EQ(still_view(std::vector<View>(3)).index, 1U);
}

}  // namespace
}  // namespace kinecal
