#include "kinecal/capture/finders/led_finder.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "capture/led_scene.hpp"

namespace kinecal {
namespace {

TEST(LedFinder, CallsLedsByTheirNamesOrCodes) {
  LedFinder finder = LedScene{}.finder();
  finder.leds[3].name = "";
  EXPECT_EQ(finder.called(0), "LED 0 (led1)");
  EXPECT_EQ(finder.called(3), "LED 3 (code 8)");
}

TEST(LedFinder, DropsTheLedThatIsNotWhereTheOthersAre) {
  const LedFinder finder = LedScene{}.finder();
  const auto placed_with = [&](std::size_t wrong, double by) {
    std::vector<PlacedLed> placed;
    for (std::size_t i = 0; i < 4; ++i) placed.push_back({i, finder.leds[i].position});
    placed[wrong].p_camera.z() += by;
    return placed;
  };
  auto placed = placed_with(1, 0.001);
  EXPECT_TRUE(drop_inconsistent(finder, placed).empty());
  EXPECT_EQ(placed.size(), 4u);
  placed = placed_with(1, 0.08);
  const auto problems = drop_inconsistent(finder, placed);
  ASSERT_EQ(problems.size(), 1u);
  EXPECT_THAT(problems[0], testing::StartsWith("LED 1 (led2): it is "));
  ASSERT_EQ(placed.size(), 3u);
  EXPECT_EQ(placed[1].led, 2u);
  placed = placed_with(1, 0.08);
  placed.resize(2);
  EXPECT_EQ(drop_inconsistent(finder, placed).size(), 2u) << "either may be wrong";
  EXPECT_TRUE(placed.empty());
  EXPECT_TRUE(drop_inconsistent(finder, placed).empty());
}

}  // namespace
}  // namespace kinecal
