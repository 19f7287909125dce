#include "kinecal/capture/finders/led_difference.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "capture/led_scene.hpp"

namespace kinecal {
namespace {

using testing::HasSubstr;

/// Images with a light, drawn as the scene does.
struct Drawing {
  LedScene scene;
  GrayImage dark() {
    GrayImage image(320, 240);
    for (auto& pixel : image.pixels) pixel = scene.grey(70.0);
    return image;
  }
  GrayImage lit(double u, double v, double level) {
    GrayImage image = dark();
    scene.add_light(image, u, v, level);
    return image;
  }
};

TEST(LedDifference, CentroidIsBetterThanAThirdOfAPixel) {
  double worst = 0.0;
  for (int i = 0; i < 30; ++i) {
    Drawing draw;
    draw.scene.random.seed(static_cast<unsigned>(i));
    draw.scene.sigma = 2.0 + 0.1 * i;
    draw.scene.spot_sigma = 0.8 + 0.05 * i;
    const double u = 100.0 + 0.13 * i, v = 80.0 - 0.07 * i;
    LedDifference difference;
    for (int pulse = 0; pulse < 2; ++pulse) {
      difference.add(draw.dark(), draw.lit(u, v, 100.0 + 5.0 * i), draw.dark());
    }
    const LedSpot spot = difference.spot(500.0);
    ASSERT_EQ(spot.problem, "") << i;
    worst = std::max(worst, std::hypot(spot.u - u, spot.v - v));
  }
  EXPECT_LT(worst, 0.3);
}

TEST(LedDifference, CountsBothSwitchesAsASumOfThreeColours) {
  GrayImage dark(20, 20), lit(20, 20);
  lit(10, 10) = 50;
  LedDifference difference;
  difference.add(dark, lit, dark);
  EXPECT_EQ(difference.spot(0.0).peak, 0.0) << "one pulse is not enough";
  difference.add(dark, lit, dark);
  EXPECT_EQ(difference.pulses(), 2);
  EXPECT_EQ(difference.spot(0.0).peak, 2 * 2 * 3 * 50.0);
  EXPECT_EQ(difference.spot(600.0).problem, "");
  EXPECT_THAT(difference.spot(601.0).problem, HasSubstr("it does not light"));
}

TEST(LedDifference, IgnoresWhatFlashesOnceOrStays) {
  Drawing draw;
  LedDifference difference;
  difference.add(draw.dark(), draw.lit(50, 50, 180), draw.dark());            // a flash
  difference.add(draw.dark(), draw.lit(90, 50, 180), draw.lit(90, 50, 180));  // it stays
  difference.add(draw.lit(90, 90, 180), draw.lit(90, 90, 180), draw.dark());  // it went
  difference.add(draw.dark(), draw.dark(), draw.lit(150, 50, 180));           // too late
  EXPECT_THAT(difference.spot(500.0).problem, HasSubstr("not light twice at the same place"));
}

TEST(LedDifference, RefusesLightsThatAreNotClearlyOne) {
  const auto problem_of = [](auto draw_lit) {
    Drawing draw;
    LedDifference difference;
    for (int i = 0; i < 2; ++i) difference.add(draw.dark(), draw_lit(draw), draw.dark());
    return difference.spot(500.0).problem;
  };
  EXPECT_EQ(problem_of([](Drawing& d) { return d.lit(100, 100, 120); }), "");
  EXPECT_THAT(problem_of([](Drawing& d) { return d.lit(1, 100, 120); }), HasSubstr("border"));
  EXPECT_THAT(problem_of([](Drawing& d) {
                GrayImage image = d.lit(100, 100, 120);
                d.scene.add_light(image, 160, 100, 90);
                return image;
              }),
              HasSubstr("another light, 6"));
  EXPECT_THAT(problem_of([](Drawing& d) {
                GrayImage image = d.lit(100, 100, 120);
                for (int u = 101; u < 115; ++u) d.scene.add_light(image, u, 100, 60);
                return image;
              }),
              HasSubstr("elongated"));
  EXPECT_THAT(problem_of([](Drawing& d) {
                d.scene.spot_sigma = 40.0;
                return d.lit(160, 120, 150);
              }),
              HasSubstr("too many for an LED"));
}

TEST(LedDifference, LooksInACircleOnly) {
  Drawing draw;
  LedDifference difference;
  for (int i = 0; i < 2; ++i) {
    GrayImage lit = draw.lit(100, 100, 90);
    draw.scene.add_light(lit, 220, 100, 150);
    difference.add(draw.dark(), lit, draw.dark());
  }
  EXPECT_NEAR(difference.spot(500.0, PixelCircle{110.0, 100.0, 30.0}).u, 100.0, 0.3);
  EXPECT_EQ(difference.spot(500.0, PixelCircle{110.0, 100.0, 30.0}).problem, "");
  EXPECT_NEAR(difference.spot(500.0, PixelCircle{69.0, 100.0, 30.0}).u, 100.0, 0.5)
      << "a light at the edge of the circle is not cut";
  EXPECT_NE(difference.spot(500.0, PixelCircle{30.0, 30.0, 30.0}).problem, "");
  EXPECT_NE(difference.spot(500.0, PixelCircle{-1e9, 1e9, 30.0}).problem, "");
  EXPECT_NE(difference.spot(500.0, PixelCircle{std::nan(""), 0.0, 30.0}).problem, "");
}

TEST(LedDifference, TakesAnySizeButNotTwo) {
  LedDifference empty;
  EXPECT_NE(empty.spot(0.0).problem, "");
  empty.add({}, {}, {});
  empty.add({}, {}, {});
  EXPECT_NE(empty.spot(0.0).problem, "");
  LedDifference tiny;
  const GrayImage dark(1, 1), lit(1, 1, 200);
  tiny.add(dark, lit, dark);
  tiny.add(dark, lit, dark);
  EXPECT_THAT(tiny.spot(500.0).problem, HasSubstr("border"));
  EXPECT_THROW(tiny.add(GrayImage(2, 1), lit, dark), std::invalid_argument);
  EXPECT_THROW(tiny.add(GrayImage(2, 1), GrayImage(2, 1), GrayImage(2, 1)), std::invalid_argument);
}

}  // namespace
}  // namespace kinecal
