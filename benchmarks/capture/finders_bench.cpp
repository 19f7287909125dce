// The cost of finders in 640 x 480 pixels, on one thread.  Control: a plain sum over the same
// pixels.
// SPDX-License-Identifier: Apache-2.0
#include <benchmark/benchmark.h>

#include <cmath>
#include <string>

#include "capture/led_scene.hpp"
#include "capture/room_scene.hpp"
#include "kinecal/capture/finders/plane_finder.hpp"
#include "kinecal/capture/finders/robot_finder.hpp"

namespace kinecal {
namespace {

void BM_sum_of_pixels_control(benchmark::State& state) {
  LedScene scene;
  const GrayImage image = scene.image();
  for (auto _ : state) {
    long sum = 0;
    for (const std::uint8_t pixel : image.pixels) sum += pixel;
    benchmark::DoNotOptimize(sum);
  }
}
BENCHMARK(BM_sum_of_pixels_control);

/// One pulse: two switches.
void BM_led_update(benchmark::State& state) {
  LedScene scene;
  const GrayImage before = scene.image(), after = scene.image();
  (void)scene.light(1);
  const GrayImage lit = scene.image();
  LedDifference difference;
  for (int i = 0; i < 2; ++i) difference.add(before, lit, after);
  const LedSpot spot = difference.spot(500.0);
  if (!spot.problem.empty() || std::abs(spot.u - scene.pixel(0).x()) > 0.3) {
    state.SkipWithError("the LED was not found");
  }
  for (auto _ : state) {
    LedDifference one = {};
    state.PauseTiming();
    one.add(before, lit, after);
    state.ResumeTiming();
    one.add(before, lit, after);
    benchmark::DoNotOptimize(one);
  }
}
BENCHMARK(BM_led_update)->Iterations(300);

/// Centroid in the whole image and what speaks against it.
void BM_led_spot(benchmark::State& state) {
  LedScene scene;
  const GrayImage before = scene.image(), after = scene.image();
  (void)scene.light(1);
  const GrayImage lit = scene.image();
  LedDifference difference;
  for (int i = 0; i < 2; ++i) difference.add(before, lit, after);
  if (!difference.spot(500.0).problem.empty()) state.SkipWithError("the LED was not found");
  for (auto _ : state) {
    const LedSpot spot = difference.spot(500.0);
    benchmark::DoNotOptimize(spot.u);
  }
}
BENCHMARK(BM_led_spot);

void BM_image_motion(benchmark::State& state) {
  LedScene scene;
  const GrayImage before = scene.image(), after = scene.image();
  ImageMotion motion;
  for (auto _ : state) motion.add(before, after);
  if (motion.share({0, 0, 639, 479}) > 0.01) state.SkipWithError("noise is taken for motion");
}
BENCHMARK(BM_image_motion);

/// The ground; with `prior` as it is expected, or as what dominates the cloud.
void find_ground(benchmark::State& state, bool prior) {
  RoomScene scene;
  scene.arm = true;
  scene.clutter = 0.1;
  const View view = scene.view();
  PlaneFinder finder;
  finder.region = scene.region();
  if (prior) finder.search.normal = {0.0, 0.0, 1.0};
  const PlaneInView plane = finder.plane_in(view);
  if (std::abs(plane.found.plane.normal.z()) < 0.9999) {
    state.SkipWithError(("the ground was not found: " + plane.problem).c_str());
  }
  for (auto _ : state) {
    const Found found = finder.find(view);
    benchmark::DoNotOptimize(found.observations.data());
  }
}
void BM_plane_with_prior(benchmark::State& state) {
  find_ground(state, true);
}
void BM_plane_without_prior(benchmark::State& state) {
  find_ground(state, false);
}
BENCHMARK(BM_plane_with_prior)->Unit(benchmark::kMillisecond);
BENCHMARK(BM_plane_without_prior)->Unit(benchmark::kMillisecond);

/// The costliest answer: all random planes are tried, with and without the prior.
void BM_no_plane(benchmark::State& state) {
  RoomScene scene;
  scene.clutter = 1.0;
  const View view = scene.view();
  PlaneFinder finder;
  finder.region = scene.region();
  finder.search.normal = {0.0, 0.0, 1.0};
  if (finder.find(view)) state.SkipWithError("found a plane in noise");
  for (auto _ : state) {
    const Found found = finder.find(view);
    benchmark::DoNotOptimize(found.refusal.data());
  }
}
BENCHMARK(BM_no_plane)->Unit(benchmark::kMillisecond);

void BM_robot(benchmark::State& state) {
  RoomScene scene;
  scene.arm = true;
  const View view = scene.view();
  RobotFinder finder;
  finder.plane.region = scene.region();
  finder.plane.search.normal = {0.0, 0.0, 1.0};
  if (!finder.find(view)) state.SkipWithError("the robot was not found");
  for (auto _ : state) {
    const Found found = finder.find(view);
    benchmark::DoNotOptimize(found.observations.data());
  }
}
BENCHMARK(BM_robot)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace kinecal

BENCHMARK_MAIN();
