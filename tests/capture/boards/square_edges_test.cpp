#include "kinecal/capture/boards/square_edges.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace kinecal {
namespace {

/// An edge at u = 20.3 that a Gaussian of `blur` pixels has blurred; the right side is bright.
GrayImage edge_image(double blur, double dark = 40.0, double bright = 200.0) {
  GrayImage image(41, 41);
  for (int v = 0; v < 41; ++v) {
    for (int u = 0; u < 41; ++u) {
      const double share = 0.5 * std::erfc((20.3 - u) / (blur * std::sqrt(2.0)));
      image(u, v) = static_cast<std::uint8_t>(std::lround(dark + share * (bright - dark)));
    }
  }
  return image;
}

TEST(SquareEdges, WidthIsTwoAndAHalfTimesTheBlur) {
  for (const double blur : {1.0, 2.0, 3.0}) {
    const auto edge = measure_edge(edge_image(blur), {20.3, 5}, {20.3, 35}, 12.0);
    ASSERT_TRUE(edge);
    EXPECT_NEAR(edge->width, 2.507 * blur, 0.35);  // pixels add to the blur
    EXPECT_NEAR(edge->contrast, 160.0, 2.0);
    EXPECT_NEAR(edge->bleed, 0.0, 0.05);
  }
}

TEST(SquareEdges, ItDoesNotMatterFromWhichEndAnEdgeIsRead) {
  const auto edge = measure_edge(edge_image(1.0), {21.0, 35}, {21.0, 5}, 8.0);
  ASSERT_TRUE(edge);
  EXPECT_NEAR(edge->bleed, 0.7, 0.05);  // white begins at 20.3
  EXPECT_NEAR(edge->dark, 40.0, 1.0);
}

TEST(SquareEdges, ThereIsNoEdgeWithoutContrast) {
  EXPECT_FALSE(measure_edge(GrayImage(41, 41, 90), {20, 5}, {20, 35}, 8.0));
}

TEST(SquareEdges, LongEdgesMayBeWider) {
  const EdgeMeasure wide{9.0, 150.0, 20.0, 1.66, 310.0}, shorter{9.0, 150.0, 20.0, 1.66, 290.0};
  EXPECT_EQ(edge_fault({{wide}, {wide}}, {}), "");
  EXPECT_THAT(edge_fault({{shorter}, {shorter}}, {}), ::testing::HasSubstr("at most 8.7 are"));
}

TEST(SquareEdges, FaultsNameTheirFigures) {
  const EdgeMeasure sharp{2.0, 150.0, 20.0, 0.0}, wide{9.04, 150.0, 20.0, 0.0},
      bleeding{2.0, 150.0, 20.0, 1.66};
  EXPECT_EQ(edge_fault({{sharp}, {sharp}}, {}), "");
  EXPECT_EQ(
      edge_fault({{sharp, sharp}, {wide, wide, sharp}}, {}),
      "blurred: edges are 9.0 pixels wide, at most 6.0 are allowed; is the robot still moving?");
  EXPECT_THAT(edge_fault({{bleeding}, {sharp}}, {}), ::testing::HasSubstr("bleeds 1.7 pixels"));
  EXPECT_THAT(edge_fault({{}, {sharp}}, {}), ::testing::HasSubstr("no contrast"));
}

}  // namespace
}  // namespace kinecal
