#include "kinecal/study/render.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>

namespace kinecal {
namespace {

/// A camera whose base is its own optical frame.
Pose<double> in_camera(const std::string&) {
  return {};
}

SimulatedCamera plain_camera() {
  SimulatedCamera camera;
  camera.blur = 0.0;
  camera.noise = 0.0;
  return camera;
}

/// A patch that looks at the camera, turned by a rotation vector.
Patch opposite(const Vector3<double>& centre, const Vector3<double>& turn = {0, 0, 0}) {
  Patch patch;
  patch.pose = {exp(turn), centre};
  return patch;
}

/// Centroid of what is brighter than the background in a square around a pixel.
Eigen::Vector2d centroid(const Image<float>& image, const Eigen::Vector2d& about, int reach,
                         double background) {
  Eigen::Vector3d sum(0, 0, 0);
  const int u0 = static_cast<int>(std::lround(about.x()));
  const int v0 = static_cast<int>(std::lround(about.y()));
  for (int v = v0 - reach; v <= v0 + reach; ++v) {
    for (int u = u0 - reach; u <= u0 + reach; ++u) {
      sum += (image(u, v) - background) * Eigen::Vector3d(u, v, 1.0);
    }
  }
  return sum.head<2>() / sum.z();
}

/// Where a row changes from one brightness to another: the sum of all pixels says it.
double edge_of_row(const Image<float>& image, int v, int left, int right) {
  const double a = image(left, v), b = image(right, v);
  double share = 0.0;
  for (int u = left; u <= right; ++u) share += (image(u, v) - b) / (a - b);
  return left + share - 0.5;
}

constexpr double kPixelTolerance = 0.02;

TEST(Render, AnEdgeIsAtItsPlaceInEachRow) {
  const SimulatedCamera camera = plain_camera();
  const Renderer renderer(camera);
  Scene scene;
  scene.light.lamp = 0.0;
  scene.patches = {opposite({0.0, 0.0, 1.0})};
  for (const double shift : {0.0, 0.0001, 0.0003, 0.00049, 0.00085, 0.00131}) {
    scene.patches[0].pose.translation.x() = shift;
    const Picture picture = renderer.render(scene, in_camera, 0);
    const double expected = renderer.lens().project({shift + 0.05, 0.0, 1.0}).x();
    const int near = static_cast<int>(expected);
    EXPECT_NEAR(edge_of_row(picture.brightness, 240, near - 5, near + 5), expected,
                kPixelTolerance);
  }
}

TEST(Render, ASkewEdgeBehindADistortingLensIsAtItsPlace) {
  SimulatedCamera camera = plain_camera();
  camera.info.d = {-0.25, 0.08, 0.001, -0.0005, 0.0};
  camera.image = ImageKind::raw;
  camera.errors = {0.01, -0.008, 0.012, 0.005, 0.0, 0.0};
  const Renderer renderer(camera);
  Scene scene;
  scene.light.lamp = 0.0;
  scene.patches = {opposite({0.25, 0.1, 1.0}, {0.2, -0.3, 0.15})};
  scene.patches[0].width = scene.patches[0].height = 0.2;
  const Picture picture = renderer.render(scene, in_camera, 0);
  for (const double along : {-0.06, -0.02, 0.013, 0.05}) {  // on the left edge
    const Vector3<double> point(-0.1, along, 0.0);
    const Eigen::Vector2d pixel = renderer.lens().project(scene.patches[0].pose * point);
    // The edge crosses the row of a whole pixel elsewhere: go along the edge by its slope.
    const Eigen::Vector2d other =
        renderer.lens().project(scene.patches[0].pose * Vector3<double>(-0.1, along + 1e-4, 0.0));
    const int row = static_cast<int>(std::lround(pixel.y()));
    const double slope = (other.x() - pixel.x()) / (other.y() - pixel.y());
    const double expected = pixel.x() + slope * (row - pixel.y());
    const int near = static_cast<int>(expected);
    EXPECT_NEAR(edge_of_row(picture.brightness, row, near - 6, near + 6), expected,
                kPixelTolerance);
  }
}

TEST(Render, TheCentroidOfASmallDiscIsAtItsMiddle) {
  const Renderer renderer(plain_camera());
  Scene scene;
  scene.light.lamp = 0.0;
  scene.background = 0.0;
  for (int i = 0; i < 20; ++i) {
    const Vector3<double> centre(0.11 + 0.00013 * i, -0.07 + 0.00029 * i, 0.8);
    scene.patches = {opposite(centre)};
    scene.patches[0].round = true;
    scene.patches[0].width = scene.patches[0].height = 0.003 + 0.0005 * i;  // from 2 to 9 pixels
    const Picture picture = renderer.render(scene, in_camera, 0);
    const Eigen::Vector2d expected = renderer.lens().project(centre);
    const Eigen::Vector2d found = centroid(picture.brightness, expected, 9, 0.0);
    EXPECT_NEAR((found - expected).norm(), 0.0, kPixelTolerance) << "disc " << i;
  }
}

TEST(Render, WhatIsSmallerThanAPixelIsNotLost) {
  const Renderer renderer(plain_camera());
  Scene scene;
  scene.background = 0.0;
  scene.light.lamp = 0.0;
  scene.patches = {opposite({0.0004, 0.0003, 1.0})};  // 0.2 of a pixel wide, between two centres
  scene.patches[0].width = scene.patches[0].height = 0.0008;
  const Picture picture = renderer.render(scene, in_camera, 0);
  double sum = 0.0;
  for (const float value : picture.brightness.pixels) sum += value;
  const double area = 0.0008 * 554.25 * 0.0008 * 554.25;
  constexpr double kShare = 0.1;  // of few rays
  EXPECT_NEAR(sum, 255.0 * 0.6 * 0.4 * area, kShare * 255.0 * 0.6 * 0.4 * area);
}

TEST(Render, DepthIsThatOfTheGeometry) {
  const Renderer renderer(plain_camera());
  Scene scene;
  scene.patches = {opposite({0.0, 0.0, 1.5}, {0.4, 0.3, 0.0})};
  scene.patches[0].width = scene.patches[0].height = std::numeric_limits<double>::infinity();
  const Picture picture = renderer.render(scene, in_camera, 0);
  const Pose<double>& pose = scene.patches[0].pose;
  for (const auto& [u, v] : {std::pair{3, 5}, {320, 240}, {600, 400}}) {
    const Vector3<double> ray = renderer.lens().ray(u, v);
    const double z = pose.rotation.col(2).dot(pose.translation) / pose.rotation.col(2).dot(ray);
    EXPECT_NEAR(picture.depth(u, v), z, 1e-5);
  }
}

TEST(Render, TheNearestPatchHidesOthersAndOneOnTopIsSeen) {
  const Renderer renderer(plain_camera());
  Scene scene;
  scene.light.lamp = 0.0;
  scene.patches = {opposite({0, 0, 1.0}), opposite({0, 0, 2.0}), opposite({0, 0, 1.0})};
  scene.patches[1].albedo = 1.0;
  scene.patches[2].albedo = 0.1;
  scene.patches[2].width = 0.05;
  const Picture picture = renderer.render(scene, in_camera, 0);
  EXPECT_NEAR(picture.brightness(320, 240), 255 * 0.1 * 0.4, 0.01);
  EXPECT_NEAR(picture.brightness(320 + 20, 240), 255 * 0.6 * 0.4, 0.01);
  EXPECT_FLOAT_EQ(picture.depth(320, 240), 1.0F);
}

TEST(Render, AnLedShinesWithItsCodeOnlyAndOnlyToItsFront) {
  const Renderer renderer(plain_camera());
  Scene scene;
  add_leds(scene, "", {{0.0, 0.0, 1.0}, {0.1, 0.0, 1.0}}, {0.0, 0.0, -1.0});
  const Eigen::Vector2d second = renderer.lens().project({0.1, 0.0, 1.0});
  const auto brightness = [&](int code) {
    return renderer.render(scene, in_camera, code)
        .brightness(static_cast<int>(std::lround(second.x())),
                    static_cast<int>(std::lround(second.y())));
  };
  EXPECT_GT(brightness(2), 255.0);
  EXPECT_LT(brightness(0), 150.0);
  EXPECT_EQ(brightness(1), brightness(0));
  scene.patches[1].pose = facing({0.1, 0.0, 1.0}, {0.0, 0.0, 1.0});
  EXPECT_EQ(brightness(2), brightness(0));
}

TEST(Render, TheCentreOfALedAndItsGlowIsItsMiddle) {
  const Renderer renderer(plain_camera());
  Scene scene;
  add_leds(scene, "", {{0.0531, -0.0312, 0.9}}, {0.0, 0.0, -1.0});
  const Picture on = renderer.render(scene, in_camera, 1),
                off = renderer.render(scene, in_camera, 0);
  Image<float> difference = on.brightness;
  for (std::size_t i = 0; i < difference.pixels.size(); ++i) {
    difference.pixels[i] -= off.brightness.pixels[i];
  }
  const Eigen::Vector2d expected = renderer.lens().project({0.0531, -0.0312, 0.9});
  EXPECT_NEAR((centroid(difference, expected, 12, 0.0) - expected).norm(), 0.0, kPixelTolerance);
}

TEST(Render, RefusesACameraWithoutSize) {
  SimulatedCamera camera;
  camera.info.width = 0;
  EXPECT_THROW(Renderer{camera}, std::invalid_argument);
}

/// A ball that stands before the camera.
Solid ball(const Vector3<double>& centre, double radius) {
  Solid solid;
  solid.low = centre.array() - radius;
  solid.high = centre.array() + radius;
  solid.cast = [=](const Vector3<double>& origin,
                   const Vector3<double>& direction) -> std::optional<SolidHit> {
    const Vector3<double> from = origin - centre;
    const double a = direction.squaredNorm(), b = from.dot(direction);
    const double inside = b * b - a * (from.squaredNorm() - radius * radius);
    if (inside < 0.0) return std::nullopt;
    const double at = (-b - std::sqrt(inside)) / a;
    return SolidHit{at, (from + at * direction) / radius};
  };
  return solid;
}

TEST(Render, ASolidHidesWhatIsBehindItAndNothingElse) {
  const SimulatedCamera camera = plain_camera();
  const Renderer renderer(camera);
  Scene scene;
  scene.patches = {opposite({0.0, 0.0, 2.0})};
  scene.patches.front().width = scene.patches.front().height = 10.0;
  scene.solids = {ball({0.1, 0.0, 1.0}, 0.2)};
  const Picture picture = renderer.render(scene, in_camera, 0);
  const Eigen::Vector2d middle = renderer.lens().project({0.1, 0.0, 1.0});
  const int u = static_cast<int>(std::lround(middle.x())), v = static_cast<int>(middle.y());
  const Vector3<double> ray = renderer.lens().ray(u, v);
  EXPECT_NEAR(picture.depth(u, v), scene.solids[0].cast(Vector3<double>::Zero(), ray)->distance,
              1e-6);
  EXPECT_EQ(picture.answer(u, v), 1);
  EXPECT_NEAR(picture.depth(10, v), 2.0, 1e-6);
  // A sphere is an ellipse in the image, whose right end is where a ray touches it.
  const double right = std::tan(std::atan(0.1) + std::asin(0.2 / std::hypot(0.1, 1.0)));
  const int end = static_cast<int>(renderer.lens().project({right, 0.0, 1.0}).x());
  EXPECT_LT(picture.depth(end - 1, v), 1.1);
  EXPECT_NEAR(picture.depth(end + 2, v), 2.0, 1e-6);
  EXPECT_EQ(picture.answer(end, v), 0) << "grazing";
}

TEST(Render, ASolidHidesALamp) {
  const Renderer renderer(plain_camera());
  Scene scene;
  add_leds(scene, "", {{0.0, 0.0, 2.0}}, {0.0, 0.0, -1.0});
  const auto brightest = [&] {
    const std::vector<float> pixels = renderer.render(scene, in_camera, 1).brightness.pixels;
    return *std::max_element(pixels.begin(), pixels.end());
  };
  EXPECT_GT(brightest(), 250.0F);
  scene.solids = {ball({0.0, 0.0, 1.0}, 0.1)};
  scene.light = {.ambient = 0.1, .lamp = 0.0};
  EXPECT_LT(brightest(), 100.0F);
}

}  // namespace
}  // namespace kinecal
