// Finding targets in 640 x 480 pixels, one thread.  Control: the library that searches, alone.
// SPDX-License-Identifier: Apache-2.0
#include <benchmark/benchmark.h>

#include <numbers>
#include <stdexcept>
#include <string>

#include "kinecal/capture/finders/april_tag_finder.hpp"
#include "kinecal/capture/finders/checkerboard_finder.hpp"
#include "support/board_images.hpp"

#ifdef KINECAL_HAVE_OPENCV
#include <opencv2/calib3d.hpp>
#endif
#ifdef KINECAL_HAVE_APRILTAG
#include "support/tag_images.hpp"
#endif

namespace kinecal {
namespace {

using test::facing;

constexpr test::Exposure kOrdinary{.blur = 0.8, .noise = 3.0, .shade = 0.4};

void check_found(const Found& found, std::size_t corners) {
  if (found && found.observations[0].features.size() == corners) return;
  throw std::runtime_error("expected " + std::to_string(corners) + " corners: " + found.refusal);
}

#ifdef KINECAL_HAVE_OPENCV

View checkerboard_view() {
  return test::view_of(
      {{test::checkerboard(7, 6, 0.03), facing({0, 0, 0.6}, 0.3, 0.3, 0.2, {0.09, 0.075, 0})}},
      kOrdinary);
}

void BM_checkerboard_control(benchmark::State& state) {
  View view = checkerboard_view();
  cv::setNumThreads(1);
  const cv::Mat image(480, 640, CV_8UC1, view.image.pixels.data());
  for (auto _ : state) {
    std::vector<cv::Point2f> corners;
    benchmark::DoNotOptimize(cv::findChessboardCornersSB(image, {7, 6}, corners));
  }
}
BENCHMARK(BM_checkerboard_control)->Unit(benchmark::kMillisecond);

void BM_checkerboard(benchmark::State& state) {
  const View view = checkerboard_view();
  cv::setNumThreads(1);
  const CheckerboardFinder finder({7, 6, 0.03, {}});
  check_found(finder.find(view), 42);
  for (auto _ : state) benchmark::DoNotOptimize(finder.find(view));
}
BENCHMARK(BM_checkerboard)->Unit(benchmark::kMillisecond);

#endif

#ifdef KINECAL_HAVE_APRILTAG

View tags_view() {
  return test::view_of({{test::tag_grid(6, 6),
                         facing({0, 0, 0.55}, std::numbers::pi + 0.2, 0.2, 0.1, {0.19, 0.19, 0})}},
                       kOrdinary);
}

void BM_april_tags_control(benchmark::State& state) {
  View view = tags_view();
  apriltag_family_t* family = tag36h11_create();
  apriltag_detector_t* detector = apriltag_detector_create();
  apriltag_detector_add_family_bits(detector, family, 1);
  detector->quad_decimate = static_cast<float>(state.range(0));
  image_u8_t image = {640, 480, 640, view.image.pixels.data()};
  for (auto _ : state) apriltag_detections_destroy(apriltag_detector_detect(detector, &image));
  apriltag_detector_destroy(detector);
  tag36h11_destroy(family);
}
BENCHMARK(BM_april_tags_control)->Arg(1)->Arg(2)->Unit(benchmark::kMillisecond);

/// The argument is how much smaller the searched image is.
void BM_april_tags(benchmark::State& state) {
  const View view = tags_view();
  AprilTagSettings settings;
  settings.columns = settings.rows = 6;
  settings.size = test::kTagSize;
  settings.decimate = static_cast<double>(state.range(0));
  const AprilTagFinder finder(settings);
  check_found(finder.find(view), 144);
  for (auto _ : state) benchmark::DoNotOptimize(finder.find(view));
}
BENCHMARK(BM_april_tags)->Arg(1)->Arg(2)->Unit(benchmark::kMillisecond);

#endif

}  // namespace
}  // namespace kinecal

BENCHMARK_MAIN();
