#include "kinecal/capture/finders/led_search.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

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

TEST(LedSearch, TakesViewsOfAnySizeAndContent) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const int size : {1, 2, 7}) {
    for (const double wrong : {0.0, nan, 1e300}) {
      LedFinder finder = LedScene{}.finder();
      finder.frame_T_camera = [wrong](const View&) {
        Pose<double> pose;
        pose.translation = {wrong, -0.5, wrong};
        return pose;
      };
      View view;
      view.camera = vga_camera();
      view.camera->width = view.camera->height = size;
      view.image = GrayImage(size, size, 30);
      view.points = PointCloud(size, size, Vector3<float>(-0.6F, -0.45F, 1.0F));
      view.points(0, 0) = no_point();
      View lit = view;
      lit.image(0, 0) = 255;
      LedSearch search(finder, view, view);
      while (const auto led = search.next()) search.pulse(*led, lit, view);
      const Found found = search.found();
      EXPECT_FALSE(found) << size << ' ' << wrong;
      EXPECT_NE(found.refusal, "");
    }
  }
}

}  // namespace
}  // namespace kinecal
