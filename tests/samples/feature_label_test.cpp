#include <gtest/gtest.h>

#include "kinecal/samples/sample.hpp"

namespace kinecal {
namespace {

TEST(FeatureLabel, IsItsIdOrElseItsPlaceFromOne) {
  EXPECT_EQ(FeatureLabel{2}.text(), "feature 3");
  EXPECT_EQ((FeatureLabel{2, 17}.text()), "the feature with id 17");
}

}  // namespace
}  // namespace kinecal
