// SPDX-License-Identifier: Apache-2.0
#include "kinecal/config/place_planes.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "kinecal/config/read_config.hpp"

namespace kinecal {
namespace {

using testing::IsEmpty;
using testing::SizeIs;

TEST(PlacePlanes, HaveAFeatureForEachPoint) {
  Diagnostics found;
  const Config config = parse_config(
      "base_link: base\nmodels:\n- {name: laser, type: chain3d, frame: laser}\n- {name: wall, "
      "type: "
      "chain6d, frame: wall}\nfree_params: [tilt]\nerror_blocks:\n- {name: on_wall, type: "
      "point_on_plane, "
      "model_a: laser, model_b: wall}\n",
      "c.yaml", found);
  ASSERT_THAT(found.errors, IsEmpty());
  const Feature point{"laser", Vector3<double>::Ones()};
  Feature plane{"other", Vector3<double>(0.0, 0.0, 0.5)};
  plane.rotation = Matrix3<double>::Identity();
  std::vector<Sample> samples(4);
  samples[0].observations = {{"laser", {point, point, point}, {}}};
  samples[1].observations = {{"laser", {point, point}, {}}};
  samples[2].observations = {{"laser", {point, point, point}, {}}, {"camera", {point}, {}}};
  samples[3].observations = {{"camera", {point}, {}}};
  const std::vector<Sample> given = samples;
  place_planes(config, samples);
  const auto wall = [&](std::size_t s) { return samples[s].observation("wall"); };
  ASSERT_NE(wall(0), nullptr);
  ASSERT_THAT(wall(0)->features, SizeIs(3));
  EXPECT_EQ(wall(0)->features[2].frame, "wall");
  EXPECT_TRUE(wall(0)->features[2].point.isZero());
  EXPECT_TRUE(wall(0)->features[2].rotation->isIdentity());
  EXPECT_EQ(wall(1), nullptr) << "two points may be tips";
  EXPECT_NE(wall(2), nullptr);
  EXPECT_EQ(wall(3), nullptr);

  samples = given;
  samples[1].observations.push_back({"wall", {plane}, {}});
  samples[2].observations.push_back({"wall", {plane, plane, plane}, {}});
  place_planes(config, samples);
  EXPECT_EQ(wall(0), nullptr) << "the samples say where the wall is";
  ASSERT_THAT(wall(1)->features, SizeIs(2));
  EXPECT_EQ(wall(1)->features[1].frame, "other");
  EXPECT_THAT(wall(2)->features, SizeIs(3));
}

}  // namespace
}  // namespace kinecal
