#include "kinecal/capture/finders/checkerboard_finder.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "support/board_images.hpp"
#include "support/repetitions.hpp"

namespace kinecal {
namespace {

using kinecal::test::camera_640;
using kinecal::test::Exposure;
using kinecal::test::facing;
using kinecal::test::mean_error;
using kinecal::test::pixel_of;
using kinecal::test::Print;
using kinecal::test::Target;
using kinecal::test::view_of;
using ::testing::HasSubstr;

constexpr double kSquare = 0.03;

Target board(int columns, int rows, const Vector3<double>& at, double tilt_x, double tilt_y,
             double roll, double square = kSquare) {
  return {
      kinecal::test::checkerboard(columns, rows, square),
      facing(at, tilt_x, tilt_y, roll, {(columns - 1) * square / 2, (rows - 1) * square / 2, 0.0})};
}

CheckerboardFinder finder_of(int columns, int rows, double square = kSquare) {
  return CheckerboardFinder({columns, rows, square, {}});
}

#ifdef KINECAL_HAVE_OPENCV

TEST(CheckerboardFinder, FindsCornersToATenthOfAPixelInAnyTurnOfABoardWhoseColoursTellIt) {
  const std::vector<double> rolls = {0.0, 3.14, -1.6, 0.8, 1.7, 2.6, -0.9, -2.4};
  for (int i = 0; i < test::repetitions(8, 3); ++i) {
    const double roll = rolls[static_cast<std::size_t>(i)];
    const Target target = board(5, 4, {0.02, -0.01, 0.6}, 0.3, -0.4, roll);
    const Found found = finder_of(5, 4).find(view_of({target}));
    EXPECT_LT(mean_error(found, target), 0.1) << "roll " << roll << ": " << found.refusal;
  }
}

TEST(CheckerboardFinder, ReturnsWhatTheCameraAndTheChainObserveWithIds) {
  const Target target = board(5, 4, {0, 0, 0.6}, 0, 0.2, 0);
  const Found found = finder_of(5, 4).find(view_of({target}));
  ASSERT_EQ(found.observations.size(), 2u) << found.refusal;
  const Observation &camera = found.observations[0], &chain = found.observations[1];
  EXPECT_EQ(camera.sensor, "camera");
  EXPECT_TRUE(camera.camera);
  EXPECT_EQ(chain.sensor, "arm");
  ASSERT_EQ(chain.features.size(), 20u);
  EXPECT_EQ(chain.features[7].frame, "checkerboard");
  EXPECT_EQ(chain.features[7].id, 7);
  EXPECT_EQ(camera.features[7].id, 7);
  EXPECT_EQ(camera.features[7].frame, "optical");
  EXPECT_TRUE(chain.features[7].point.isApprox(Vector3<double>(2 * kSquare, kSquare, 0.0)));
  EXPECT_EQ(found.marks.size(), 20u);
}

TEST(CheckerboardFinder, UnevenLightNoiseAndSomeBlurCostLittle) {
  Exposure how;
  how.shade = 0.6;
  how.noise = 5.0;
  how.blur = 1.2;
  const Target target = board(7, 6, {0, 0, 0.6}, 0.3, 0.3, 0.2);
  const Found found = finder_of(7, 6).find(view_of({target}, how));
  EXPECT_LT(mean_error(found, target), 0.15) << found.refusal;
}

TEST(CheckerboardFinder, EachOfSeveralFindersFindsItsOwnBoard) {
  const Target five = board(5, 4, {-0.13, 0, 0.6}, 0.2, 0.1, 0.1);
  const Target seven = board(7, 6, {0.13, 0, 0.6}, -0.2, 0.2, -0.2, 0.02);
  const View view = view_of({five, seven});
  EXPECT_LT(mean_error(finder_of(5, 4).find(view), five), 0.1);
  EXPECT_LT(mean_error(finder_of(7, 6, 0.02).find(view), seven), 0.1);
  EXPECT_FALSE(finder_of(6, 5).find(view));
}

TEST(CheckerboardFinder, TwoBoardsOfOneSizeAreRefused) {
  const View view = view_of(
      {board(5, 4, {-0.13, 0, 0.6}, 0.2, 0.1, 0.1), board(5, 4, {0.13, 0, 0.6}, -0.2, 0.2, -0.2)});
  EXPECT_THAT(finder_of(5, 4).find(view).refusal, HasSubstr("two checkerboard"));
}

TEST(CheckerboardFinder, BlurAndMotionAreRefusedWithTheWidthOfEdges) {
  Exposure blurred;
  blurred.blur = 4.0;
  const Target target = board(5, 4, {0, 0, 0.5}, 0.1, 0.1, 0.1);
  EXPECT_THAT(finder_of(5, 4).find(view_of({target}, blurred)).refusal, HasSubstr("blurred"));
  Exposure moving;
  moving.motion = 11;
  EXPECT_THAT(finder_of(5, 4).find(view_of({target}, moving)).refusal, HasSubstr("blurred"));
}

TEST(CheckerboardFinder, SmallSquaresAreRefused) {
  const Found found = finder_of(5, 4).find(view_of({board(5, 4, {0, 0, 2.6}, 0, 0, 0.1)}));
  EXPECT_THAT(found.refusal, HasSubstr("at least 8.0 are needed"));
}

TEST(CheckerboardFinder, GlareOnADarkSquareIsRefused) {
  const Target target = board(7, 6, {0, 0, 0.6}, 0.1, 0.1, 0.1);
  View view = view_of({target});
  const Eigen::Vector2d spot =
      pixel_of(camera_640(), target.camera_T_board, {2.5 * kSquare, 2.5 * kSquare, 0});
  for (int v = 0; v < 480; ++v) {
    for (int u = 0; u < 640; ++u) {
      const double light =
          500 * std::exp(-0.5 * (Eigen::Vector2d(u, v) - spot).squaredNorm() / 100);
      view.image(u, v) = static_cast<std::uint8_t>(std::min(255.0, view.image(u, v) + light));
    }
  }
  EXPECT_THAT(finder_of(7, 6).find(view).refusal, HasSubstr("glare"));
}

TEST(CheckerboardFinder, WhiteThatBleedsIntoDarkSquaresIsRefused) {
  View view = view_of({board(5, 4, {0, 0, 0.5}, 0.1, 0.1, 0.1)}, {.blur = 2.0});
  for (auto& p : view.image.pixels) {
    p = static_cast<std::uint8_t>(std::min(255.0, 8.0 * std::max(0.0, p - 28.0)));
  }
  EXPECT_THAT(finder_of(5, 4).find(view).refusal, HasSubstr("over-exposed"));
}

TEST(CheckerboardFinder, CornersAreReadFromTheCloudAndHolesAreFilled) {
  const Target target = board(5, 4, {0, 0, 0.6}, 0.3, -0.2, 0.1);
  View view = view_of({target});
  DepthImage depth(640, 480);
  const Pose<double> inverse = target.camera_T_board.inverse();
  for (int v = 0; v < 480; ++v) {
    for (int u = 0; u < 640; ++u) {
      const Vector3<double> way =
          inverse.rotation * Vector3<double>((u - 319.5) / 600.0, (v - 239.5) / 600.0, 1.0);
      depth(u, v) = static_cast<float>(-inverse.translation.z() / way.z());
      if ((u * 7 + v * 3) % 5 == 0) depth(u, v) = 0.0F;
    }
  }
  view.points = points_of(depth, *view.camera);
  CheckerboardSettings settings{5, 4, kSquare, {}};
  settings.target.corners = CornerKind::points;
  const Found found = CheckerboardFinder(settings).find(view);
  ASSERT_TRUE(found) << found.refusal;
  for (std::size_t i = 0; i < 20; ++i) {
    const Vector3<double> truth = target.camera_T_board * found.observations[1].features[i].point;
    EXPECT_LT((found.observations[0].features[i].point - truth).norm(), 3e-4);
  }
  view.points.pixels.assign(view.points.pixels.size(), no_point());
  EXPECT_EQ(CheckerboardFinder(settings).find(view).refusal,
            "depth is missing at 20 of 20 corners");
}

/// What a fisheye of 800 x 800 pixels sees of a board that is turned away from its axis.
struct BentView {
  View view;
  CameraInfo lens;
  Target target;

  BentView(int columns, int rows, double sees, double distance, double away)
      : lens(test::fisheye_camera(800, 800, sees, {0.01, -0.004, 0.001, -0.0001})),
        target(board(columns, rows, {0, 0, distance}, 0.25, -0.2, 0.15)) {
    const Eigen::AngleAxisd turn(away, Vector3<double>(0.8, -0.6, 0.0));
    target.camera_T_board.rotation = turn * target.camera_T_board.rotation;
    target.camera_T_board.translation = turn * target.camera_T_board.translation;
    view.frame = "optical";
    view.camera = test::unknown_lens(800, 800);
    view.image = test::picture(lens, {target}, {.blur = 0.7});
  }
};

TEST(CheckerboardFinder, AllCornersOfABoardThatAFisheyeBendsAreFoundBeforeItsLensIsKnown) {
  constexpr double kDegree = 0.017453292519943295;
  for (const auto& [sees, distance, away] : {std::array{120.0, 0.18, 0.0},
                                             {120.0, 0.25, 25.0},
                                             {150.0, 0.15, 20.0},
                                             {190.0, 0.1, 0.0},
                                             {190.0, 0.15, 40.0},
                                             {190.0, 0.2, 65.0}}) {
    const BentView bent(8, 6, sees * kDegree, distance, away * kDegree);
    const Found found = finder_of(8, 6).find(bent.view);
    ASSERT_TRUE(found) << sees << ' ' << away << ": " << found.refusal;
    EXPECT_GE(found.observations[0].features.size(), 47u) << sees << ' ' << away;
    for (std::size_t i = 0; i < found.observations[0].features.size(); ++i) {
      const Eigen::Vector2d at = found.observations[0].features[i].point.head<2>();
      const Vector3<double>& place = found.observations[1].features[i].point;
      const Vector3<double> last(7 * kSquare, 5 * kSquare,
                                 0.0);  // the board looks alike upside down
      const double off =
          std::min((pixel_of(bent.lens, bent.target.camera_T_board, place) - at).norm(),
                   (pixel_of(bent.lens, bent.target.camera_T_board, last - place) - at).norm());
      EXPECT_LT(off, 0.4) << sees << ' ' << away << ", corner " << i;
    }
  }
}

TEST(CheckerboardFinder, APartOfALargerBoardThatAFisheyeBendsIsRefused) {
  const BentView bent(9, 7, 2.6, 0.18, 0.3);
  for (const auto& [columns, rows] : {std::pair{8, 6}, {9, 6}, {8, 7}, {7, 5}}) {
    EXPECT_FALSE(finder_of(columns, rows).find(bent.view)) << columns << " x " << rows;
  }
}

TEST(CheckerboardFinder, OuterSquaresMayBeCutOnAGreyOrSaturatedBackground) {
  for (const double border : {0.4, 0.5, 0.8}) {
    for (const double background : {130.0, 255.0}) {
      Target target = board(6, 4, {0, 0, 0.5}, 0.3, -0.3, 0.2);
      const Print cut = test::checkerboard(6, 4, kSquare, border);
      target.print = [=](double x, double y) {  // with the paper, or without
        const double beyond = std::max({-x, -y, x - 5 * kSquare, y - 3 * kSquare});
        return background < 200.0 && beyond > border * kSquare ? -1.0 : cut(x, y);
      };
      const Exposure how{.white = 255.0, .background = background};
      const Found found = finder_of(6, 4).find(view_of({target}, how));
      ASSERT_TRUE(found) << border << ' ' << background << ": " << found.refusal;
      EXPECT_EQ(found.observations[0].features.size(), 24u);
    }
  }
}

TEST(CheckerboardFinder, ASmallBoardInALargeImageIsFound) {
  CameraInfo camera = test::unknown_lens(1920, 1200);
  const Target target = board(7, 5, {0.3, 0.1, 2.2}, 0.2, 0.1, 0.1, 0.012);  // 10 pixels a square
  View view;
  view.frame = "optical";
  view.camera = camera;
  view.image = test::picture(camera, {target});
  const Found found = finder_of(7, 5, 0.012).find(view);
  ASSERT_TRUE(found) << found.refusal;
  EXPECT_EQ(found.observations[0].features.size(), 35u);
}

TEST(CheckerboardFinder, ABoardThatIsNotThereIsRefused) {
  EXPECT_THAT(finder_of(5, 4).find(view_of({})).refusal,
              HasSubstr("there is no checkerboard of 5 x 4 corners"));
}

TEST(CheckerboardFinder, ABoardThatReachesTheBorderIsRefused) {
  EXPECT_FALSE(finder_of(5, 4).find(view_of({board(5, 4, {0.27, 0, 0.6}, 0, 0, 0)})));
}

#else

TEST(CheckerboardFinder, WithoutOpenCvItNamesThePackage) {
  EXPECT_THAT(finder_of(5, 4).find(view_of({})).refusal, HasSubstr("libopencv-dev"));
}

#endif

TEST(CheckerboardFinder, ImpossibleBoardsAreRefused) {
  EXPECT_THROW(finder_of(2, 4), std::invalid_argument);
  EXPECT_THROW(finder_of(5, 4, 0.0), std::invalid_argument);
  CheckerboardSettings same;
  same.target.chain_sensor = same.target.camera_sensor;
  EXPECT_THROW(CheckerboardFinder{same}, std::invalid_argument);
}

TEST(CheckerboardFinder, ViewsWithoutImageOrCameraInfoAreRefused) {
#ifdef KINECAL_HAVE_OPENCV
  View view;
  EXPECT_EQ(finder_of(5, 4).find(view).refusal, "the view has no image");
  view.image = GrayImage(8, 8);
  EXPECT_EQ(finder_of(5, 4).find(view).refusal, "the view has no camera_info");
  view.camera = camera_640();
  EXPECT_EQ(finder_of(5, 4).find(view).refusal,
            "camera_info is of 640 x 480 pixels, the image has 8 x 8");
  view.camera->width = view.camera->height = 8;
  EXPECT_EQ(finder_of(5, 4).find(view).refusal,
            "an image of 8 x 8 pixels is too small for a checkerboard of 5 x 4 corners");
#endif
}

}  // namespace
}  // namespace kinecal
