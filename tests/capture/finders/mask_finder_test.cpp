#include "kinecal/capture/finders/mask_finder.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace kinecal {
namespace {

using testing::HasSubstr;

/// A robot from column 30 to 59 and row 20 to the lower border.
GrayImage example_mask() {
  GrayImage mask(100, 80, 0);
  for (int v = 20; v < 80; ++v) {
    for (int u = 30; u < 60; ++u) mask(u, v) = 255;
  }
  return mask;
}

View view_with(GrayImage mask) {
  View view;
  view.frame = "eye";
  view.image = std::move(mask);
  return view;
}

TEST(MaskEdges, HaveOutwardNormalsAndNoneAtTheBorder) {
  const GrayImage mask = example_mask();
  const std::vector<MaskEdge> edges = mask_edges(mask);
  EXPECT_EQ(edges.size(), 30U + 2U * (80U - 20U - kMaskBorder));
  for (const MaskEdge& edge : edges) {
    const auto at = [&](const Eigen::Vector2d& p) {
      return mask(static_cast<int>(std::lround(p.x())), static_cast<int>(std::lround(p.y())));
    };
    EXPECT_NEAR(edge.normal.norm(), 1.0, 1e-12);
    EXPECT_EQ(at(edge.pixel - 2.0 * edge.normal), 255);
    EXPECT_EQ(at(edge.pixel + 2.0 * edge.normal), 0);
  }
}

TEST(MaskFinder, FindsEdgesWithTheirNormals) {
  const Found found = MaskFinder{"left"}.find(view_with(example_mask()));
  ASSERT_EQ(found.observations.size(), 1U);
  EXPECT_EQ(found.observations[0].sensor, "left");
  ASSERT_EQ(found.observations[0].features.size(), mask_edges(example_mask()).size());
  for (const Feature& feature : found.observations[0].features) {
    EXPECT_EQ(feature.frame, "eye");
    EXPECT_FALSE(feature.id);
    EXPECT_NEAR(std::hypot(feature.conditions.at("nu"), feature.conditions.at("nv")), 1.0, 1e-12);
  }
}

TEST(MaskFinder, RefusesWhatIsNoMask) {
  const auto refusal = [](View view) { return MaskFinder{}.find(view).refusal; };
  EXPECT_EQ(refusal(View{}), "the view has no image");
  EXPECT_THAT(refusal(view_with(GrayImage(100, 80, 0))), HasSubstr("the mask has 0 edges"));
  GrayImage inverted = example_mask();
  for (std::uint8_t& pixel : inverted.pixels) pixel = static_cast<std::uint8_t>(255 - pixel);
  EXPECT_THAT(refusal(view_with(inverted)), HasSubstr("is it inverted?"));
  GrayImage photograph(100, 80, 0);
  for (std::size_t i = 0; i < photograph.pixels.size(); ++i) {
    photograph.pixels[i] = static_cast<std::uint8_t>(i * 37 % 256);
  }
  EXPECT_THAT(refusal(view_with(photograph)), HasSubstr("this is no mask"));
  View other = view_with(example_mask());
  other.camera.emplace();
  other.camera->width = 200;
  other.camera->height = 80;
  EXPECT_EQ(refusal(other), "the mask has 100 x 80 pixels, the camera 200 x 80");
}

}  // namespace
}  // namespace kinecal
