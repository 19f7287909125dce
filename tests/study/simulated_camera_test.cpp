#include "kinecal/study/simulated_camera.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <set>
#include <vector>

#include "kinecal/sensors/depth/depth_camera.hpp"

namespace kinecal {
namespace {

Picture flat_picture(float brightness, float depth) {
  return {Image<float>(640, 480, brightness), DepthImage(640, 480, depth),
          Image<std::uint8_t>(640, 480, 1)};
}

struct Moments {
  double mean = 0.0, deviation = 0.0;
};
Moments moments(const std::vector<double>& values) {
  double sum = 0.0, squares = 0.0;
  for (const double value : values) sum += value;
  const double mean = sum / static_cast<double>(values.size());
  for (const double value : values) squares += (value - mean) * (value - mean);
  return {mean, std::sqrt(squares / static_cast<double>(values.size()))};
}

std::vector<double> depths(const View& view) {
  std::vector<double> all;
  for (const Vector3<float>& point : view.points.pixels) {
    if (!std::isnan(point.z())) all.push_back(point.z());
  }
  return all;
}

TEST(SimulatedCamera, DepthNoiseGrowsWithTheSquare) {
  SimulatedCamera camera;
  SeededRandom random(1);
  const SimulatedLens lens(camera);
  for (const double z : {0.5, 1.0, 3.0}) {
    const Moments seen =
        moments(depths(photograph(camera, lens, flat_picture(100, float(z)), random)));
    EXPECT_NEAR(seen.mean, z, 1e-4 * z * z);
    EXPECT_NEAR(seen.deviation, 0.001 * z * z, 2e-5 * z * z);
  }
}

TEST(SimulatedCamera, BrightnessHasItsNoiseAndEndsAt255) {
  SimulatedCamera camera;
  camera.noise = 3.0;
  SeededRandom random(2);
  const SimulatedLens lens(camera);
  const View view = photograph(camera, lens, flat_picture(100, 1), random);
  std::vector<double> values(view.image.pixels.begin(), view.image.pixels.end());
  EXPECT_NEAR(moments(values).mean, 100.0, 0.1);
  EXPECT_NEAR(moments(values).deviation, 3.0, 0.1);
  for (const std::uint8_t value :
       photograph(camera, lens, flat_picture(900, 1), random).image.pixels) {
    EXPECT_EQ(value, 255);
  }
  camera.exposure = 0.5;
  EXPECT_NEAR(photograph(camera, lens, flat_picture(100, 1), random).image(5, 5), 50, 15);
}

TEST(SimulatedCamera, ItsPointsAreThoseThatDepthCameraCorrects) {
  SimulatedCamera camera;
  camera.depth_noise = 0.0;
  camera.errors = {0.01, -0.02, 0.015, 0.012, 0.005, -0.01, 0.02, 0.03, -0.02, 0.04, -0.03, 0.02};
  SeededRandom random(3);
  const SimulatedLens lens(camera);
  const View view = photograph(camera, lens, flat_picture(100, 1.2F), random);
  const Vector3<double> truth = lens.ray(500, 100) * 1.2;
  const Observation seen{
      "camera", {{camera.frame, view.points(500, 100).cast<double>()}}, view.camera};
  const DepthCamera sensor;
  const auto settings = sensor.settings(seen);
  Measurement<DepthCamera, double> measured{.settings = settings};
  measured.point = sensor.measurement(seen.features[0].point, settings);
  const Vector3<double> corrected = sensor.place(measured, camera.errors);
  EXPECT_NEAR((corrected - truth).norm(), 0.0, 1e-6);
  EXPECT_GT((seen.features[0].point - truth).norm(), 0.01);
}

TEST(SimulatedCamera, StructuredLightMeasuresInSteps) {
  SimulatedCamera camera;
  camera.depth_noise = 0.0;
  camera.disparity_step = 0.125;
  SeededRandom random(4);
  Picture picture = flat_picture(100, 2.0F);
  for (int u = 0; u < 640; ++u) {
    for (int v = 0; v < 480; ++v) picture.depth(u, v) = 2.0F + 1e-5F * static_cast<float>(u);
  }
  const std::vector<double> seen =
      depths(photograph(camera, SimulatedLens(camera), picture, random));
  const std::set<double> steps(seen.begin(), seen.end());
  EXPECT_LE(steps.size(), 2U);
  const double step = 2.0 * 2.0 * 0.125 / (554.25 * 0.075);  // dz = z^2 / (f b) dd
  for (const double z : steps) EXPECT_NEAR(z, 2.0, step);
}

TEST(SimulatedCamera, HasNoDepthAtEdgesAndWhereNothingAnswers) {
  SimulatedCamera camera;
  SeededRandom random(5);
  Picture picture = flat_picture(100, 1.0F);
  for (int v = 0; v < 480; ++v) {
    for (int u = 320; u < 640; ++u) picture.depth(u, v) = 1.5F;
  }
  picture.answer(100, 100) = 0;
  View view = photograph(camera, SimulatedLens(camera), picture, random);
  EXPECT_TRUE(std::isnan(view.points(319, 50).z()));
  EXPECT_TRUE(std::isnan(view.points(320, 50).z()));
  EXPECT_FALSE(std::isnan(view.points(318, 50).z()));
  EXPECT_TRUE(std::isnan(view.points(100, 100).z()));
  camera.nearest = 1.2;
  view = photograph(camera, SimulatedLens(camera), picture, random);
  EXPECT_TRUE(std::isnan(view.points(50, 50).z()));
  EXPECT_FALSE(std::isnan(view.points(400, 50).z()));
  camera.has_depth = false;
  EXPECT_TRUE(photograph(camera, SimulatedLens(camera), picture, random).points.empty());
}

TEST(SimulatedCamera, BlurKeepsTheLight) {
  SimulatedCamera camera;
  camera.noise = 0.0;
  camera.blur = 1.5;
  SeededRandom random(6);
  Picture picture = flat_picture(0, 1);
  picture.brightness(200, 100) = 2000.0F;
  const View view = photograph(camera, SimulatedLens(camera), picture, random);
  double sum = 0.0;
  for (const std::uint8_t value : view.image.pixels) sum += value;
  EXPECT_NEAR(sum, 2000.0, 40.0);  // rounded to whole numbers
  EXPECT_NEAR(view.image(200, 100), 2000.0 / (2.0 * std::numbers::pi * 1.5 * 1.5), 2.0);
}

TEST(SimulatedLens, IsThatOfAPinhole) {
  SimulatedCamera camera;
  camera.info.distortion_model = "equidistant";
  camera.info.d = {0.1, 0.0, 0.0, 0.0};
  EXPECT_THROW((void)SimulatedLens(camera), SettingsError);
}

}  // namespace
}  // namespace kinecal
