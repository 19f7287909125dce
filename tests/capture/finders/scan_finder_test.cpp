#include "kinecal/capture/finders/scan_finder.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace kinecal {
namespace {

using testing::HasSubstr;

View scan() {
  View view;
  view.frame = "laser_link";
  view.points = PointCloud(5, 1, no_point());
  view.points(0, 0) = {1.0F, 0.5F, 0.0F};
  view.points(2, 0) = {1.5F, -0.5F, 0.0F};
  view.points(3, 0) = {2.5F, 0.0F, 0.0F};
  view.points(4, 0) = {0.0F, 0.0F, 0.0F};
  return view;
}

TEST(ScanFinder, RepeatsThePointsOfTheBoxUpwards) {
  ScanFinder finder;
  finder.z_repeats = 3;
  const Found found = finder.find(scan());
  ASSERT_EQ(found.observations.size(), 1u) << found.refusal;
  const Observation& laser = found.observations[0];
  EXPECT_EQ(laser.sensor, "laser");
  ASSERT_EQ(laser.features.size(), 6u);
  EXPECT_EQ(laser.features[0].frame, "laser_link");
  EXPECT_EQ(laser.features[2].point, Vector3<double>(1.0, 0.5, 0.2));
  EXPECT_EQ(laser.features[3].point, Vector3<double>(1.5, -0.5, 0.0));
}

TEST(ScanFinder, GivesPointsInAFrameOfTheRobot) {
  ScanFinder finder;
  finder.z_repeats = 2;
  finder.frame = "base_link";
  finder.frame_T_scanner = [](const View&) {
    Pose<double> upside_down;
    upside_down.rotation.diagonal() << 1, -1, -1;
    upside_down.translation = {0.2, 0.0, 0.3};
    return upside_down;
  };
  const Found found = finder.find(scan());
  ASSERT_TRUE(found);
  EXPECT_EQ(found.observations[0].features[1].frame, "base_link");
  EXPECT_TRUE(found.observations[0].features[1].point.isApprox(Vector3<double>(1.2, -0.5, 0.2)));
}

TEST(ScanFinder, RefusesWhatIsNoScan) {
  const ScanFinder finder;
  EXPECT_THAT(finder.find(View{}).refusal, HasSubstr("no point cloud"));
  View view = scan();
  view.points = PointCloud(5, 1, no_point());
  EXPECT_THAT(finder.find(view).refusal, HasSubstr("no point in the box"));
  view.points = PointCloud(4, 4, {1.0F, 0.0F, 0.0F});
  EXPECT_THAT(finder.find(view).refusal, HasSubstr("a scan has one row of points"));
  ScanFinder wrong = finder;
  wrong.z_repeats = 0;
  EXPECT_THAT(wrong.find(scan()).refusal, HasSubstr("z_repeats must be at least 1"));
  wrong = finder;
  wrong.frame = "base_link";
  EXPECT_THAT(wrong.find(scan()).refusal, HasSubstr("pose of 'laser_link' in 'base_link'"));
}

}  // namespace
}  // namespace kinecal
