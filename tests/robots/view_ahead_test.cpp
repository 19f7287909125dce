#include "kinecal/robots/view_ahead.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <string_view>
#include <vector>

#include "kinecal/files/messages/make.hpp"

namespace kinecal::detail {
namespace {

using testing::HasSubstr;

constexpr double kPi = std::numbers::pi;
constexpr double kInf = std::numeric_limits<double>::infinity();

/// A scan of a full turn by a degree: two metres everywhere, but for one beam.
struct FullTurn {
  double first = 0.0;  ///< radians
  std::vector<double> ranges = std::vector<double>(360, 2.0);

  [[nodiscard]] ScanRanges view() const { return {ranges, first, kPi / 180.0, 0.1, 10.0}; }
};

Matrix3<double> yaw(double angle) {
  return exp(Vector3<double>(0.0, 0.0, angle));
}

TEST(NearestAhead, LooksToBothSidesOfAnglesThatAreNotWrapped) {
  FullTurn scan;
  scan.ranges[345] = 0.3;  // 15 degrees to the right, as 345
  EXPECT_EQ(nearest_ahead(scan.view(), yaw(0.0)), 0.3);
  scan.first = -kPi;
  EXPECT_EQ(nearest_ahead(scan.view(), yaw(0.0)), 2.0) << "it is behind, on the left";
}

TEST(NearestAhead, LooksWhereTheBaseGoes) {
  FullTurn scan;
  scan.ranges[90] = 0.3;  // to the left of the scanner
  EXPECT_EQ(nearest_ahead(scan.view(), yaw(0.0)), 2.0);
  EXPECT_EQ(nearest_ahead(scan.view(), yaw(-0.5 * kPi)), 0.3) << "which looks to the right";
  const Matrix3<double> upside_down = exp(Vector3<double>(kPi, 0.0, 0.0));
  EXPECT_EQ(nearest_ahead(scan.view(), yaw(0.5 * kPi) * upside_down), 0.3);
  const std::vector<double> front(91, 2.0);  // 45 degrees to either side
  const ScanRanges half{front, -0.25 * kPi, kPi / 180.0, 0.1, 10.0};
  EXPECT_EQ(nearest_ahead(half, yaw(0.0)), 2.0);
  EXPECT_FALSE(nearest_ahead(half, yaw(kPi))) << "it looks back";
  EXPECT_FALSE(nearest_ahead(half, yaw(0.25 * kPi + 0.1))) << "it shows the left side only";
  EXPECT_FALSE(nearest_ahead(scan.view(), exp(Vector3<double>(0.5 * kPi, 0.0, 0.0))))
      << "it scans upright";
}

TEST(NearestAhead, WhatIsTooNearToMeasureIsNotFree) {
  for (const double near : {-kInf, 0.05}) {
    FullTurn scan;
    scan.ranges[3] = near;
    EXPECT_EQ(nearest_ahead(scan.view(), yaw(0.0)), 0.0) << near;
  }
  FullTurn nothing;
  nothing.ranges.assign(360, kInf);
  EXPECT_EQ(nearest_ahead(nothing.view(), yaw(0.0)), kInf);
}

MessageFields scan_message(std::string_view frame, double range) {
  return fields("header", fields("frame_id", frame), "angle_min", -1.0, "angle_increment", 0.1,
                "time_increment", 0.0, "range_min", 0.1, "range_max", 10.0, "ranges",
                numbers(std::vector<double>(21, range)));
}

MessageFields mount_message(std::string_view scanner, double angle) {
  MessageValue::List all;
  all.emplace_back(fields(
      "header", fields("frame_id", std::string_view("base_link")), "child_frame_id", scanner,
      "transform",
      fields("translation", fields("x", 0.2, "y", 0.0, "z", 0.3), "rotation",
             fields("x", 0.0, "y", 0.0, "z", std::sin(0.5 * angle), "w", std::cos(0.5 * angle)))));
  return fields("transforms", std::move(all));
}

TEST(ViewAhead, IsTheNearestOfScannersThatLookAhead) {
  const std::chrono::steady_clock::time_point early{}, late = early + std::chrono::seconds(1);
  ViewAhead view;
  EXPECT_EQ(view.why_none("base_link"), "there is no scan that shows what is ahead");
  view.take_scan("/scan", scan_message("laser", 1.5), early);
  EXPECT_FALSE(view.ahead("base_link"));
  EXPECT_THAT(view.why_none("base_link"),
              HasSubstr("how 'laser', the frame of /scan, is mounted on 'base_link'"));
  view.take_frames(mount_message("laser", 0.0));
  ASSERT_TRUE(view.ahead("base_link"));
  EXPECT_EQ(view.ahead("base_link")->nearest, 1.5);
  EXPECT_FALSE(view.ahead("other"));
  view.take_frames(mount_message("back", kPi));
  view.take_scan("/back", scan_message("back", 0.2), late);
  EXPECT_EQ(view.ahead("base_link")->nearest, 1.5) << "what is behind is not ahead";
  view.take_frames(mount_message("low", 0.0));
  view.take_scan("/low", scan_message("low", 3.0), late);
  EXPECT_EQ(view.ahead("base_link")->nearest, 1.5) << "a later scan of another does not replace it";
  EXPECT_EQ(view.ahead("base_link")->arrival, early) << "one of them is silent";
}

}  // namespace
}  // namespace kinecal::detail
