#include "kinecal/capture/tags/touching_tags.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "kinecal/capture/boards/saddle_corner.hpp"
#include "kinecal/capture/boards/shrunk_black.hpp"
#include "kinecal/capture/finders/april_tag_finder.hpp"
#include "support/board_images.hpp"
#include "support/repetitions.hpp"

#ifdef KINECAL_HAVE_APRILTAG
#include "support/tag_images.hpp"
#endif

namespace kinecal {
namespace {

using kinecal::test::Exposure;
using kinecal::test::Target;

TEST(SaddleCorner, IsFoundToAFewHundredthsOfAPixelAndNotAtTheCornerOfOneSquare) {
  const Vector3<double> corner(0.0213, -0.0107, 0.5);
  const Eigen::Vector2d truth = test::pixel_of(test::camera_640(), {}, corner);
  const Eigen::Vector2d along(std::cos(0.3), std::sin(0.3)), across(-along.y(), along.x());
  const auto view = [&](bool both) {
    // Turned: rays are a quarter of a pixel apart, so upright edges would be an eighth off.
    const test::Print print = [&, both](double x, double y) {
      const Eigen::Vector2d off(x - corner.x(), y - corner.y());
      const bool right = along.dot(off) > 0.0, up = across.dot(off) > 0.0;
      return right && up ? 0.0 : !right && !up && both ? 0.0 : 1.0;
    };
    Pose<double> far;
    far.translation.z() = corner.z();
    return test::view_of({Target{print, far}}, Exposure{.blur = 1.0, .noise = 4.0}).image;
  };
  const detail::CornerAxes axes{9.0 * along, 9.0 * across};
  const Eigen::Vector2d about = truth + Eigen::Vector2d(3.0, -2.0);
  const auto found = detail::find_saddle(view(true), about, axes, 1.0);
  ASSERT_TRUE(found);
  EXPECT_LT((*found - truth).norm(), 0.06);
  EXPECT_FALSE(detail::find_saddle(view(false), about, axes, 1.0));
}

TEST(ShrunkBlack, WhiteGrowsByAPixelAlongRowsAndColumns) {
  GrayImage image(9, 9, 255);
  for (int v = 3; v < 6; ++v) {
    for (int u = 3; u < 6; ++u) image(u, v) = 0;
  }
  const GrayImage smaller = detail::shrunk_black(image, 1.0);
  EXPECT_EQ(std::count(smaller.pixels.begin(), smaller.pixels.end(), 0), 1);
  EXPECT_EQ(smaller(4, 4), 0);
}

TEST(ShrunkBlack, PlacesAtAnotherSizeAreThoseOfTheOriginal) {
  GrayImage image(60, 60, 255);
  for (int v = 20; v < 40; ++v) {
    for (int u = 10; u < 50; ++u) image(u, v) = 0;
  }
  for (const double scale : {0.4, 0.5, 1.5}) {
    const GrayImage other = detail::shrunk_black(image, scale);
    ASSERT_EQ(other.width, static_cast<int>(60 * scale));
    Eigen::Vector2d sum = Eigen::Vector2d::Zero();
    double dark = 0.0;
    for (int v = 0; v < other.height; ++v) {
      for (int u = 0; u < other.width; ++u) {
        sum += (255 - other(u, v)) * Eigen::Vector2d(u, v);
        dark += 255 - other(u, v);
      }
    }
    const Eigen::Vector2d middle = detail::at_full_size(sum / dark, scale);
    EXPECT_NEAR(middle.x(), 29.5, 0.1) << scale;
    EXPECT_NEAR(middle.y(), 29.5, 0.1) << scale;
  }
}

TEST(ShrunkBlack, LargeImagesAreSearchedAtReducedSizeFirst) {
  const std::vector<double> small = detail::search_scales(GrayImage(1280, 1024));
  ASSERT_EQ(small.size(), 2u);
  EXPECT_EQ(small[0], 1.0);
  EXPECT_EQ(small[1], 1.5);
  const std::vector<double> large = detail::search_scales(GrayImage(4000, 3000));
  EXPECT_NEAR(large.front() * large.front() * 12e6, 1.5e6, 1.0);
  EXPECT_NEAR(large.back(), 0.795, 0.001) << "larger ones take seconds";
}

#ifdef KINECAL_HAVE_APRILTAG

AprilTagSettings kalibr_settings(int columns, int rows, int border = 2) {
  AprilTagSettings settings;
  settings.columns = columns;
  settings.rows = rows;
  settings.size = test::kTagSize;
  settings.spacing = test::kTagSpacing;
  settings.border = border;
  settings.min_side = 12.0;  // of tags tilted by 60 degrees
  return settings;
}

/// A grid in front of the camera, tilted about an axis in its plane, then turned, radians.
Target kalibr_target(const test::Print& print, int columns, int rows, double distance, double tilt,
                     double about, double roll) {
  const double pitch = test::kTagSize * (1.0 + test::kTagSpacing);
  const Vector3<double> middle(0.5 * columns * pitch, 0.5 * rows * pitch, 0.0);
  Target target{print, {}};
  const Vector3<double> axis(std::cos(about), std::sin(about), 0.0);
  target.camera_T_board.rotation =
      (Eigen::AngleAxisd(tilt, axis) * Eigen::AngleAxisd(roll, Vector3<double>::UnitZ()) *
       Eigen::AngleAxisd(std::numbers::pi, Vector3<double>::UnitX()))
          .toRotationMatrix();
  target.camera_T_board.translation =
      Vector3<double>(0, 0, distance) - target.camera_T_board.rotation * middle;
  return target;
}

/// Distances of corners from where they are, pixels, ascending.
std::vector<double> errors_of(const Found& found, const Target& target) {
  std::vector<double> errors;
  if (!found) return errors;
  for (std::size_t i = 0; i < found.observations[0].features.size(); ++i) {
    const auto truth = test::pixel_of(test::camera_640(), target.camera_T_board,
                                      found.observations[1].features[i].point);
    errors.push_back((found.observations[0].features[i].point.head<2>() - truth).norm());
  }
  std::sort(errors.begin(), errors.end());
  return errors;
}

struct KalibrView {
  double distance, tilt, about, roll;  ///< metres, radians
  Exposure how;
  int border = 2;
};

TEST(TouchingTags, AllTagsOfKalibrsGridAreFoundTurnedTiltedBlurredAndNoisy) {
  const std::vector<KalibrView> views = {
      {0.55, 0.00, 0.0, 0.00, {.blur = 0.5, .noise = 2.0}},
      {0.55, 1.05, 0.3, 0.00, {.blur = 0.5, .noise = 4.0}},  // 60 degrees
      {0.60, 0.30, 2.0, 0.785, {.blur = 1.0, .noise = 6.0}},
      {0.60, 0.60, 1.0, 1.57, {.blur = 1.0, .noise = 8.0}},
      {0.60, 0.80, 4.0, 3.60, {.blur = 0.7, .noise = 4.0, .shade = 0.5}},
      {0.60, 0.40, 5.0, 2.50, {.blur = 0.7, .noise = 4.0}, 1}};
  for (int i = 0; i < test::repetitions(6, 3); ++i) {
    const KalibrView& how = views[static_cast<std::size_t>(i)];
    const Target target = kalibr_target(test::kalibr_grid(5, 4, how.border), 5, 4, how.distance,
                                        how.tilt, how.about, how.roll);
    const Found found =
        AprilTagFinder(kalibr_settings(5, 4, how.border)).find(test::view_of({target}, how.how));
    const std::vector<double> errors = errors_of(found, target);
    ASSERT_EQ(errors.size(), 80u) << "view " << i << ": " << found.refusal;
    EXPECT_LT(errors[40], 0.1) << "the median in view " << i;
    EXPECT_LT(errors.back(), 0.5) << "the worst in view " << i;
  }
}

TEST(TouchingTags, PartOfAGridIsFoundWithoutFalseCorners) {
  Target target = kalibr_target(test::kalibr_grid(5, 4), 5, 4, 0.5, 0.4, 1.0, 0.5);
  target.camera_T_board.translation.x() += 0.2;
  const Found found = AprilTagFinder(kalibr_settings(5, 4)).find(test::view_of({target}));
  const std::vector<double> errors = errors_of(found, target);
  EXPECT_GE(errors.size(), 24u) << found.refusal;
  EXPECT_LT(errors.size(), 80u);
  ASSERT_FALSE(errors.empty());
  EXPECT_LT(errors.back(), 0.5);
}

TEST(TouchingTags, TagsWithoutSquaresStayAsTheyWereFound) {
  const Target target = kalibr_target(test::tag_grid(4, 3), 4, 3, 0.5, 0.4, 1.0, 0.5);
  const GrayImage image = test::view_of({target}).image;
  const detail::TagReader reader("tag36h11", 1, 1, 2.0);
  const std::vector<detail::SeenTag> alone = reader.read(image);
  ASSERT_EQ(alone.size(), 12u);
  detail::TouchingGrid grid;
  for (int id = 0; id < 12; ++id) grid.ids.push_back(id);
  const std::vector<detail::SeenTag> with = detail::with_touching_tags(reader, image, grid, alone);
  ASSERT_EQ(with.size(), alone.size());
  for (std::size_t i = 0; i < alone.size(); ++i) EXPECT_EQ(with[i].corners, alone[i].corners);
}

#endif

}  // namespace
}  // namespace kinecal
