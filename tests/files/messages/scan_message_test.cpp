// SPDX-License-Identifier: Apache-2.0
#include "kinecal/files/messages/scan_message.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "kinecal/files/messages/make.hpp"
#include "support/error_of.hpp"

namespace kinecal::detail {
namespace {

using test::error_of;
using testing::HasSubstr;

constexpr double kInf = std::numeric_limits<double>::infinity();
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

MessageFields scan(const std::vector<double>& ranges, double step = -0.5, double most = 10.0,
                   double time_step = 1e-3) {
  return fields("angle_min", 1.0, "angle_increment", step, "time_increment", time_step, "range_min",
                0.5, "range_max", most, "ranges", numbers(ranges));
}

TEST(ScanMessage, BeamsWithoutARangeThatCountsAreNoPoints) {
  View view;
  read_points(scan({2.0, kNaN, 3.0, kInf, -kInf, 0.4, 11.0, 0.0}), view);
  ASSERT_EQ(view.points.width, 8);
  EXPECT_EQ(view.points.height, 1);
  EXPECT_EQ(view.point_time, 1e-3);
  const auto at = [](double range, double angle) -> Vector3<float> {
    return Vector3<double>(range * std::cos(angle), range * std::sin(angle), 0.0).cast<float>();
  };
  EXPECT_EQ(view.points(0, 0), at(2.0, 1.0));
  EXPECT_EQ(view.points(2, 0), at(3.0, 0.0)) << "a scanner that turns clockwise";
  for (const int i : {1, 3, 4, 5, 6, 7}) EXPECT_TRUE(std::isnan(view.points(i, 0).x())) << i;
}

TEST(ScanMessage, AnAbsurdTimeBetweenBeamsIsUnknown) {
  for (const double absurd : {kInf, kNaN, -1.0, 1e300}) {
    EXPECT_EQ(scan_of(scan({1.0, 2.0}, -0.5, 10.0, absurd)).time_step, 0.0) << absurd;
  }
}

TEST(ScanMessage, WhatCannotBeAScanIsRefused) {
  EXPECT_THAT(error_of([] { (void)scan_of(scan({})); }), HasSubstr("the scan has no ranges"));
  EXPECT_THAT(error_of([] {
                (void)scan_of(scan({1.0, 1.0}, 0.0));
              }),
              HasSubstr("2 ranges from angle_min 1 in steps of angle_increment 0"));
  EXPECT_THAT(error_of([] {
                (void)scan_of(scan({1.0, 1.0}, 0.1, 0.0));
              }),
              HasSubstr("its range_max, 0 m, is not above its range_min, 0.5 m"));
}

}  // namespace
}  // namespace kinecal::detail
