#include "kinecal/text/nearest_name.hpp"

#include <gtest/gtest.h>

namespace kinecal {
namespace {

TEST(NearestName, CountsInsertionsDeletionsReplacementsAndSwaps) {
  EXPECT_EQ(edit_distance("elbow", "elbow"), 0u);
  EXPECT_EQ(edit_distance("elbow", "Elbow"), 0u);
  EXPECT_EQ(edit_distance("elbwo", "elbow"), 1u);
  EXPECT_EQ(edit_distance("elow", "elbow"), 1u);
  EXPECT_EQ(edit_distance("elboww", "elbow"), 1u);
  EXPECT_EQ(edit_distance("alb0w", "elbow"), 2u);
  EXPECT_EQ(edit_distance("", "abc"), 3u);
}

static_assert(edit_distance("Elbow", "elbwo") == 1);  // known while compiling

TEST(NearestName, TakesTheNearestAndNothingFarAway) {
  const std::vector<std::string> names = {"head_pan_joint", "head_tilt_joint", "elbow"};
  EXPECT_EQ(nearest_name("head_pn_joint", names), "head_pan_joint");
  EXPECT_EQ(nearest_name("lbow", names), "elbow");
  EXPECT_EQ(nearest_name("checkerboard", names), std::nullopt);
  EXPECT_EQ(did_you_mean("elbwo", names), "; did you mean 'elbow'?");
  EXPECT_EQ(did_you_mean("x", names), "");
}

}  // namespace
}  // namespace kinecal
