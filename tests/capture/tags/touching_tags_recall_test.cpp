// How many tags of Kalibr's grids are found, and how exactly, in random views: upright to tilted by 60 degrees,
// turned by any angle, sharp or blurred by up to a pixel.  KINECAL_REPETITIONS=500 takes two minutes in a release.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <numbers>
#include <vector>

#include "kinecal/capture/finders/april_tag_finder.hpp"
#include "kinecal/study/seeded_random.hpp"
#include "support/board_images.hpp"
#include "support/repetitions.hpp"

#ifdef KINECAL_HAVE_APRILTAG
#include "support/tag_images.hpp"

namespace kinecal {
namespace {

using kinecal::test::Exposure;
using kinecal::test::Target;

constexpr int kColumns = 6, kRows = 6;
constexpr double kPitch = test::kTagSize * (1.0 + test::kTagSpacing);

AprilTagSettings random_view_settings() {
  AprilTagSettings settings;
  settings.columns = kColumns;
  settings.rows = kRows;
  settings.size = test::kTagSize;
  settings.spacing = test::kTagSpacing;
  settings.border = 2;
  settings.min_side = 12.0;  // of tags tilted by 60 degrees
  return settings;
}

CameraInfo random_view_camera(int times) {
  CameraInfo camera = test::camera_640(900.0 * times);
  camera.width = 960 * times;
  camera.height = 720 * times;
  camera.p[2] = camera.k[2] = 480.0 * times - 0.5;
  camera.p[6] = camera.k[5] = 360.0 * times - 0.5;
  return camera;
}

struct RandomView {
  Pose<double> camera_T_board;
  Exposure how;
};

RandomView random_view(int seed) {
  SeededRandom random(static_cast<std::uint64_t>(1000 + seed));
  const double tilt = random.uniform(0.0, std::numbers::pi / 3.0),
               about = random.uniform(0.0, 2.0 * std::numbers::pi),
               roll = random.uniform(0.0, 2.0 * std::numbers::pi);
  RandomView view;
  view.how.blur = random.uniform(0.0, 1.0);
  view.how.noise = random.uniform(0.0, 6.0);
  view.how.shade = random.uniform(0.0, 0.5);
  view.how.black = random.uniform(10.0, 60.0);
  view.how.white = random.uniform(150.0, 240.0);
  view.how.background = random.uniform(0.0, 255.0);
  view.how.seed = static_cast<unsigned>(seed + 1);
  const Vector3<double> axis(std::cos(about), std::sin(about), 0.0),
      middle(0.5 * kColumns * kPitch, 0.5 * kRows * kPitch, 0.0),
      at(0.0, 0.0, random.uniform(0.55, 1.1));
  view.camera_T_board.rotation =
      (Eigen::AngleAxisd(tilt, axis) * Eigen::AngleAxisd(roll, Vector3<double>::UnitZ()) *
       Eigen::AngleAxisd(std::numbers::pi, Vector3<double>::UnitX()))
          .toRotationMatrix();
  view.camera_T_board.translation = at - view.camera_T_board.rotation * middle;
  return view;
}

/// Corners that are in the image with what surrounds them, four of a tag.
int visible_corners(const CameraInfo& camera, const Pose<double>& camera_T_board) {
  constexpr double kMargin = 8.0;  // pixels
  int count = 0;
  for (int tag = 0; tag < kColumns * kRows; ++tag) {
    bool is_inside = true;
    for (int k = 0; k < 4; ++k) {
      const Vector3<double> corner(
          tag % kColumns * kPitch + (k == 1 || k == 2 ? test::kTagSize : 0.0),
          tag / kColumns * kPitch + (k >= 2 ? test::kTagSize : 0.0), 0.0);
      const Eigen::Vector2d p = test::pixel_of(camera, camera_T_board, corner);
      is_inside = is_inside && p.x() >= kMargin && p.y() >= kMargin &&
                  p.x() <= camera.width - 1 - kMargin && p.y() <= camera.height - 1 - kMargin;
    }
    count += is_inside ? 4 : 0;
  }
  return count;
}

/// What was found in views.
struct Recall {
  int visible = 0;
  std::vector<double> errors = {};  ///< of the corners found, pixels

  void add(const RandomView& random, int times) {
    View view;
    view.frame = "optical";
    view.camera = random_view_camera(times);
    static const test::Print kPrint = test::kalibr_grid(kColumns, kRows);
    view.image = test::picture(*view.camera, {Target{kPrint, random.camera_T_board}}, random.how);
    visible += visible_corners(*view.camera, random.camera_T_board);
    const Found found = AprilTagFinder(random_view_settings()).find(view);
    if (!found) return;
    for (std::size_t i = 0; i < found.observations[0].features.size(); ++i) {
      const auto truth = test::pixel_of(*view.camera, random.camera_T_board,
                                        found.observations[1].features[i].point);
      errors.push_back((found.observations[0].features[i].point.head<2>() - truth).norm());
    }
  }
  void check() {
    std::sort(errors.begin(), errors.end());
    ASSERT_FALSE(errors.empty());
    const double median = errors[errors.size() / 2];
    std::cout << errors.size() << " corners found, " << visible << " visible; off by " << median
              << " px in the median, by " << errors.back() << " at most\n";
    EXPECT_GE(static_cast<double>(errors.size()), 0.95 * visible);
    EXPECT_LT(median, 0.1);
    EXPECT_LT(errors.back(), 1.0);
  }
};

TEST(TouchingTagsRecall, NearlyAllTagsAreFoundAndNoCornerIsAPixelOff) {
  Recall recall;
  const int views = test::repetitions_of_study(500, test::kIsSlow ? 4 : 40);
  for (int seed = 0; seed < views; ++seed) recall.add(random_view(seed), 1);
  recall.check();
}

TEST(TouchingTagsRecall, LargeBlurredImagesAreSearchedAtReducedSize) {
  Recall recall;
  for (int seed = 0; seed < test::repetitions(2, 1); ++seed) {
    RandomView random = random_view(seed);
    random.how.blur = 2.0;
    recall.add(random, 3);
  }
  recall.check();
}

}  // namespace
}  // namespace kinecal

#endif
