#include "kinecal/capture/finders/circle_grid_finder.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <stdexcept>

#include "kinecal/capture/boards/disc_centres.hpp"
#include "kinecal/capture/boards/homography.hpp"
#include "kinecal/study/seeded_random.hpp"
#include "support/board_images.hpp"
#include "support/disc_images.hpp"
#include "support/repetitions.hpp"

namespace kinecal {
namespace {

using kinecal::test::Exposure;
using kinecal::test::Target;
using ::testing::HasSubstr;

CircleGridSettings symmetric_grid(int columns, int rows) {
  CircleGridSettings settings;
  settings.points_x = columns;
  settings.points_y = rows;
  settings.size = 0.03;
  settings.asymmetric = false;
  return settings;
}

CircleGridSettings asymmetric_grid() {
  CircleGridSettings settings;
  settings.size = 0.02;
  return settings;
}

Target target_of(const CircleGridSettings& s, double radius, double distance, double tilt_x,
                 double tilt_y, double roll) {
  const Vector3<double> middle = 0.5 * test::disc_place(s, s.points_x - 1, s.points_y - 1);
  return {test::disc_print(s, radius),
          test::facing({0.01, 0.0, distance}, tilt_x, tilt_y, roll, middle)};
}

TEST(MiddleOfDisc, IsTheCentroidOfItsImageAndNotTheImageOfItsCentre) {
  Matrix3<double> h;
  h << 800, 20, 300, -10, 700, 200, 0.6, -0.4, 1.0;
  const PlaneImage image = [&](const Eigen::Vector2d& p) { return mapped(h, p); };
  const Eigen::Vector2d centre(0.1, 0.05);
  constexpr double kRadius = 0.08;
  // An ellipse is symmetric, so its centroid is midway between its outermost points.
  Eigen::Vector2d least(1e9, 1e9), most = -least;
  for (int i = 0; i < 100000; ++i) {
    const double angle = i * 2e-5 * std::numbers::pi;
    const Eigen::Vector2d p =
        image(centre + kRadius * Eigen::Vector2d(std::cos(angle), std::sin(angle)));
    least = least.cwiseMin(p);
    most = most.cwiseMax(p);
  }
  const Eigen::Vector2d middle = middle_of_disc(image, centre, kRadius);
  const double offset = (middle - image(centre)).norm();
  EXPECT_LT((middle - 0.5 * (least + most)).norm(), 0.003 * offset);
  EXPECT_GT(offset, 1.0) << "here the correction matters";
}

TEST(DiscCentres, OfTiltedDiscsAreCorrectedForPerspective) {
  const CircleGridSettings s = symmetric_grid(5, 4);
  constexpr double kRadius = 0.011;
  const Target target = target_of(s, kRadius, 0.25, 0.9, 0.0, 0.0);
  const View view = test::view_of({target}, Exposure{.blur = 0.7, .noise = 2.0});
  std::vector<Eigen::Vector2d> plane, about, truth;
  for (int i = 0; i < 20; ++i) {
    const Vector3<double> place = test::disc_place(s, i % 5, i / 5);
    plane.emplace_back(place.head<2>());
    truth.push_back(test::pixel_of(*view.camera, target.camera_T_board, place));
    about.emplace_back(truth.back() + Eigen::Vector2d(1.0, -0.7));
  }
  const auto found = disc_centres(view.image, plane, about, s.size, *view.camera);
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->radius, kRadius, 0.02 * kRadius);
  double uncorrected = 0.0;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    EXPECT_LT((found->pixels[i] - truth[i]).norm(), 0.12) << "disc " << i;
    const Eigen::Vector2d middle = middle_of_disc(found->image, plane[i], kRadius);
    uncorrected = std::max(uncorrected, (middle - truth[i]).norm());
  }
  EXPECT_GT(uncorrected, 0.5) << "the offset that was taken off, pixels";
}

TEST(DiscCentres, AreNotFoundWhereNothingIs) {
  const std::vector<Eigen::Vector2d> plane = {{0, 0}, {0.03, 0}, {0.03, 0.03}, {0, 0.03}},
                                     about = {{50, 50}, {90, 50}, {90, 90}, {50, 90}};
  EXPECT_FALSE(disc_centres(GrayImage(200, 200, 180), plane, about, 0.03, test::camera_640()));
}

TEST(CircleGridFinder, ImpossibleGridsAreRefused) {
  CircleGridSettings s = symmetric_grid(1, 4);
  EXPECT_THROW(CircleGridFinder{s}, std::invalid_argument);
  s = symmetric_grid(5, 4);
  s.size = 0.0;
  EXPECT_THROW(CircleGridFinder{s}, std::invalid_argument);
  s = symmetric_grid(5, 4);
  s.target.corners = CornerKind::pose;
  EXPECT_THROW(CircleGridFinder{s}, std::invalid_argument);
  s = asymmetric_grid();
  s.target.corners = CornerKind::pose;
  EXPECT_NO_THROW(CircleGridFinder{s});
}

#ifdef KINECAL_HAVE_OPENCV

TEST(CircleGridFinder, SymmetricGridsAreFoundToATenthOfAPixel) {
  const CircleGridSettings s = symmetric_grid(7, 5);
  const std::vector<double> rolls = {0.0, 0.6, -1.2,
                                     1.4};  // of more, its other side would be the first
  for (int i = 0; i < test::repetitions(4, 3); ++i) {
    const double roll = rolls[static_cast<std::size_t>(i)];
    const Target target = target_of(s, 0.009, 0.4, 0.4, -0.3, roll);
    const Found found = CircleGridFinder(s).find(test::view_of({target}));
    ASSERT_TRUE(found) << found.refusal;
    EXPECT_EQ(found.observations[0].features.size(), 35u);
    EXPECT_LT(test::mean_error(found, target), 0.1) << roll;
  }
}

TEST(CircleGridFinder, AsymmetricGridsAreFoundAtAnyAngleWithTheRightFirstDisc) {
  const CircleGridSettings s = asymmetric_grid();
  for (int i = 0; i < test::repetitions(12, 6); ++i) {
    const double roll = i * std::numbers::pi / 6.0;
    const Target target = target_of(s, 0.0075, 0.45, i % 2 == 0 ? 0.5 : -0.2, 0.3, roll);
    const Found found = CircleGridFinder(s).find(test::view_of({target}));
    ASSERT_TRUE(found) << found.refusal << " at " << roll;
    EXPECT_EQ(found.observations[0].features.size(), 44u);
    EXPECT_LT(test::mean_error(found, target), 0.1) << roll;
  }
}

TEST(CircleGridFinder, WhiteDiscsOnBlackAreFoundAsBlackOnesOnWhite) {
  for (const CircleGridSettings& s : {asymmetric_grid(), symmetric_grid(7, 5)}) {
    const Target black = target_of(s, 0.375 * s.size, 0.45, 0.4, -0.3, 0.2);
    const Target white{test::negative(black.print), black.camera_T_board};
    const Found found = CircleGridFinder(s).find(test::view_of({white}));
    ASSERT_TRUE(found) << found.refusal;
    EXPECT_EQ(static_cast<int>(found.observations[0].features.size()), s.points_x * s.points_y);
    EXPECT_LT(test::mean_error(found, white), 0.1);
  }
}

TEST(CircleGridFinder, GridsThatAFisheyeBendsAreFoundWithoutKnowingItsLens) {
  // Before its calibration: camera_info is that of a pinhole.
  const CameraInfo fisheye = test::fisheye_camera(800, 600, 2.6);
  const std::vector<Eigen::Vector2d> away = {{0.0, 0.0}, {0.5, 0.1}, {-0.4, -0.2}, {-0.6, 0.2}};
  int missed = 0;
  for (int i = 0; i < test::repetitions(8, 4); ++i) {
    const CircleGridSettings s = i % 2 == 0 ? asymmetric_grid() : symmetric_grid(7, 5);
    Target target = target_of(s, 0.375 * s.size, 10.0 * s.size, 0.3, -0.2, 0.3);
    const Eigen::Vector2d way = away[static_cast<std::size_t>(i / 2)];
    const Eigen::AngleAxisd turn(way.norm(), Vector3<double>(-way.y(), way.x(), 0.0).normalized());
    if (way.norm() > 0.0) {
      target.camera_T_board.rotation = turn * target.camera_T_board.rotation;
      target.camera_T_board.translation = turn * target.camera_T_board.translation;
    }
    View view;
    view.frame = "optical";
    view.camera = test::unknown_lens(800, 600);
    view.image = test::picture(fisheye, {target});
    const Found found = CircleGridFinder(s).find(view);
    ASSERT_TRUE(found) << i << ": " << found.refusal;
    for (std::size_t k = 0; k < found.observations[0].features.size(); ++k) {
      const auto truth =
          test::pixel_of(fisheye, target.camera_T_board, found.observations[1].features[k].point);
      const double off = (found.observations[0].features[k].point.head<2>() - truth).norm();
      EXPECT_LT(off, 0.1) << "disc " << k << " of view " << i;
    }
    missed += s.points_x * s.points_y - static_cast<int>(found.observations[0].features.size());
  }
  EXPECT_EQ(missed, 0);
}

TEST(CircleGridFinder, MostRandomViewsAreFoundAndNoneIsWrong) {
  const int count = test::repetitions_of_study(200, test::kIsSlow ? 10 : 40);
  int there = 0;
  for (int i = 0; i < count; ++i) {
    SeededRandom random(static_cast<std::uint64_t>(i));
    const CircleGridSettings s = i % 2 == 0 ? asymmetric_grid() : symmetric_grid(7, 5);
    const double tilt_x = random.uniform(-0.7, 0.7), tilt_y = random.uniform(-0.7, 0.7),
                 roll = s.asymmetric ? random.uniform(0.0, 6.28) : random.uniform(-1.2, 1.2);
    const Target target =
        target_of(s, 0.375 * s.size, random.uniform(0.45, 0.8), tilt_x, tilt_y, roll);
    const Exposure how{.blur = random.uniform(0.0, 1.2), .noise = random.uniform(0.0, 5.0)};
    const Found found = CircleGridFinder(s).find(test::view_of({target}, how));
    if (!found) continue;
    ++there;
    EXPECT_LT(test::mean_error(found, target), 0.15) << i;
  }
  EXPECT_GE(there, count * 9 / 10);
}

TEST(CircleGridFinder, AViewWithoutTheWholeGridIsRefusedAndABlurredOneToo) {
  const CircleGridSettings s = asymmetric_grid();
  Target target = target_of(s, 0.0075, 0.4, 0.2, 0.2, 0.0);
  EXPECT_THAT(CircleGridFinder(s).find(test::view_of({target}, Exposure{.motion = 11})).refusal,
              HasSubstr("blurred"));
  target.camera_T_board.translation.x() += 0.2;
  EXPECT_THAT(CircleGridFinder(s).find(test::view_of({target})).refusal,
              HasSubstr("there is no grid of 4 x 11 discs"));
}

TEST(CircleGridFinder, TheCentreOfADarkMarkIsNotTakenForADisc) {
  const Target board{test::checkerboard(5, 4, 0.03),
                     test::facing({0, 0, 0.4}, 0.1, 0.1, 0.0, {0.06, 0.045, 0})};
  EXPECT_FALSE(CircleGridFinder(symmetric_grid(5, 4)).find(test::view_of({board})));
}

#endif

}  // namespace
}  // namespace kinecal
