// The first place, and how many more.
#include "kinecal/config/doubts/occurrences.hpp"

#include <gtest/gtest.h>

namespace kinecal::detail {
namespace {

TEST(Occurrences, NameTheFirstAndCountTheOthers) {
  Occurrences found;
  EXPECT_EQ(found.others(), "");
  EXPECT_TRUE(found.add(4));
  EXPECT_EQ(found.others(), "");
  EXPECT_TRUE(found.add(3));
  EXPECT_EQ(found.first, 3u);
  EXPECT_EQ(found.others(), " (and in 1 more sample)");
  EXPECT_FALSE(found.add(6));
  EXPECT_EQ(found.others(), " (and in 2 more samples)");
}

TEST(Occurrences, ASampleThatWasNotReadFromAFileHasItsNumber) {
  std::vector<Sample> samples(2);
  samples[0].source = "s.yaml:7";
  EXPECT_EQ(place_of(samples, 0).str(), "s.yaml:7");
  EXPECT_EQ(place_of(samples, 1).str(), "sample 1");
}

TEST(Occurrences, ResidualsHaveTheirUnit) {
  EXPECT_EQ(residual_text(0.00011, "m"), "0.11 mm");
  EXPECT_EQ(residual_text(0.3, "px"), "0.3 px");
  EXPECT_EQ(residual_text(2.5, "1"), "2.5");
}

}  // namespace
}  // namespace kinecal::detail
