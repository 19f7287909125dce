#include "kinecal/capture/finders/surface_point.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "capture/led_scene.hpp"

namespace kinecal {
namespace {

/// A plane a x + b y + z = d in front of a wall 2 m away; where `hidden` says so, there is no depth.
template <class F>
View tilted(double a, double b, double d, F hidden, int edge = 640) {
  DepthImage depth(640, 480, 2.0F);
  for (int v = 0; v < 480; ++v) {
    for (int u = 0; u < 640; ++u) {
      const double x = (u - 319.5) / kFocal, y = (v - 239.5) / kFocal;
      if (u < edge) depth(u, v) = static_cast<float>(d / (a * x + b * y + 1.0));
      if (hidden(u, v)) depth(u, v) = 0.0F;
    }
  }
  View view;
  view.camera = vga_camera();
  view.points = points_of(depth, *view.camera);
  return view;
}

TEST(SurfacePoint, IsOnATiltedPlaneInTheMiddleOfAHole) {
  const auto hole = [](int u, int v) { return std::hypot(u - 300.4, v - 200.7) < 7.0; };
  const View view = tilted(1.5, -0.5, 0.8, hole);
  const auto p = surface_point(view, 300.4, 200.7);
  ASSERT_TRUE(p.has_value());
  EXPECT_NEAR(1.5 * p->x() - 0.5 * p->y() + p->z(), 0.8, 1e-4);
  EXPECT_NEAR(kFocal * p->x() / p->z() + 319.5, 300.4, 1e-9);
  EXPECT_NEAR(kFocal * p->y() / p->z() + 239.5, 200.7, 1e-9);
}

TEST(SurfacePoint, IsOnTheNearSideOfAnEdge) {
  const auto hole = [](int u, int v) { return std::hypot(u - 300.0, v - 200.0) < 4.0; };
  const View view = tilted(0.0, 0.0, 0.8, hole, 302);  // the wall begins two pixels further
  const auto p = surface_point(view, 300.0, 200.0);
  ASSERT_TRUE(p.has_value());
  EXPECT_NEAR(p->z(), 0.8, 1e-6);
}

TEST(SurfacePoint, IsNotGuessedWithoutDepth) {
  const View view = tilted(0.0, 0.0, 0.8, [](int u, int) { return u > 280; });
  EXPECT_FALSE(surface_point(view, 300.0, 200.0).has_value());
  EXPECT_TRUE(surface_point(view, 285.0, 200.0).has_value());
  EXPECT_FALSE(surface_point(view, -5.0, 200.0).has_value());
  EXPECT_FALSE(surface_point(view, std::nan(""), 200.0).has_value());
  EXPECT_TRUE(surface_point(view, 0.0, 479.0).has_value());
  EXPECT_FALSE(surface_point(View{}, 0.0, 0.0).has_value());
}

}  // namespace
}  // namespace kinecal
