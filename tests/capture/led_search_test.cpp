#include "kinecal/capture/led_search.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "capture/led_scene.hpp"

namespace kinecal {
namespace {

View dark_view(LedScene& scene) {
  (void)scene.light(0);
  return scene.next_view(scene.now);
}

TEST(LedSearch, LightsEachInTurnUntilAllAreClear) {
  LedScene scene;
  const LedFinder finder = scene.finder();
  scene.works[2] = false;
  const View first = dark_view(scene);
  LedSearch search(finder, first, dark_view(scene));
  std::vector<std::size_t> order;
  while (const auto led = search.next()) {
    order.push_back(*led);
    (void)scene.light(finder.leds[*led].code);
    const View lit = scene.next_view(scene.now);
    search.pulse(*led, lit, dark_view(scene));
  }
  EXPECT_THAT(order, testing::ElementsAre(0, 1, 2, 3, 0, 1, 2, 3, 2, 2, 2, 2))
      << "25 iterations are twelve pulses";
  EXPECT_EQ(search.found().marks.size(), 3u);
}

TEST(LedSearch, IsOverWhereViewsCannotBeUsed) {
  LedScene scene;
  const LedFinder finder = scene.finder();
  LedSearch none(finder, View{}, View{});
  EXPECT_FALSE(none.next().has_value());
  EXPECT_FALSE(none.found());
  const View dark = dark_view(scene);
  View small = dark;
  small.image = GrayImage(0, 0);
  LedSearch search(finder, dark, dark);
  search.pulse(0, small, dark);
  EXPECT_FALSE(search.next().has_value());
  EXPECT_EQ(search.found().refusal, "the view has no image");
  LedSearch other(finder, dark, dark);
  small.image = GrayImage(480, 640);
  other.pulse(0, small, dark);
  EXPECT_THAT(other.found().refusal, testing::HasSubstr("differ in size"));
}

}  // namespace
}  // namespace kinecal
