#include "kinecal/capture/boards/target.hpp"

#include <gtest/gtest.h>

#include <stdexcept>

namespace kinecal {
namespace {

View small_view() {
  View view;
  view.frame = "optical";
  view.image = GrayImage(20, 20, 100);
  view.camera = CameraInfo{};
  view.camera->width = view.camera->height = 20;
  return view;
}

TEST(Target, AViewMustHaveWhatItsCornersNeed) {
  View view = small_view();
  EXPECT_EQ(view_fault(view, CornerKind::pixels), "");
  EXPECT_EQ(view_fault(view, CornerKind::points),
            "the view has no cloud, and 3-D corners are wanted");
  view.points = PointCloud(10, 10, no_point());
  EXPECT_EQ(view_fault(view, CornerKind::points),
            "the cloud has 10 x 10 points, the image 20 x 20 pixels: each pixel needs its point");
  view.camera.reset();
  EXPECT_EQ(view_fault(view, CornerKind::pixels), "the view has no camera_info");
}

TEST(Target, CornersWithoutDepthAreLeftOutOfBothSensorsUntilTheyAreTooMany) {
  View view = small_view();
  view.points = PointCloud(20, 20, {0.0F, 0.0F, 1.0F});
  for (int v = 12; v < 20; ++v) {
    for (int u = 12; u < 20; ++u) view.points(u, v) = no_point();
  }
  TargetSettings settings;
  settings.corners = CornerKind::points;
  settings.max_without_depth = 0.3;
  std::vector<TargetCorner> corners = {{9, {5, 5}, {1, 0, 0}},
                                       {2, {5, 10}, {2, 0, 0}},
                                       {4, {10, 5}, {3, 0, 0}},
                                       {7, {17, 17}, {4, 0, 0}}};
  const Found found = observed(view, settings, corners);
  ASSERT_TRUE(found) << found.refusal;
  for (const Observation& o : found.observations) {
    ASSERT_EQ(o.features.size(), 3u);
    EXPECT_EQ(o.features[0].id, 2);
    EXPECT_EQ(o.features[2].id, 9);
  }
  EXPECT_EQ(found.observations[1].features[2].point.x(), 1.0);
  settings.max_without_depth = 0.2;
  EXPECT_EQ(observed(view, settings, corners).refusal, "depth is missing at 1 of 4 corners");
}

TEST(Target, TwoCornersOfOneIdAreRefused) {
  EXPECT_THROW((void)observed(small_view(), {}, {{1, {5, 5}, {}}, {1, {6, 6}, {}}}),
               std::invalid_argument);
}

TEST(Target, ImpossibleSettingsAreRefused) {
  TargetSettings settings;
  EXPECT_NO_THROW(check_target(settings));
  settings.frame.clear();
  EXPECT_THROW(check_target(settings), std::invalid_argument);
  settings = {};
  settings.quality.min_square = -1.0;
  EXPECT_THROW(check_target(settings), std::invalid_argument);
  settings = {};
  settings.max_without_depth = 1.5;
  EXPECT_THROW(check_target(settings), std::invalid_argument);
}

}  // namespace
}  // namespace kinecal
