#include "kinecal/files/natural_order.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace kinecal {
namespace {

/// Expects each name to come before all that follow it.
template <class Before>
void expect_sorted(const std::vector<std::string>& sorted, Before before) {
  for (std::size_t i = 0; i < sorted.size(); ++i) {
    for (std::size_t k = 0; k < sorted.size(); ++k) {
      EXPECT_EQ(before(sorted[i], sorted[k]), i < k) << sorted[i] << ", " << sorted[k];
    }
  }
}

TEST(NaturallyBefore, NumbersAreComparedByValue) {
  expect_sorted({"", "1", "2", "10", "a", "a2", "a10", "a10b", "a10c", "a100", "b1"},
                naturally_before);
}

TEST(NaturallyBefore, EveryNumberOfANameCounts) {
  expect_sorted({"cam1_2", "cam1_10", "cam2_1", "cam2_3_9", "cam2_3_11", "cam10_1"},
                naturally_before);
}

TEST(NaturallyBefore, LeadingZerosDoNotCountAndEqualNumbersAreInTheOrderOfTheirBytes) {
  expect_sorted({"a000", "a01", "a1", "a2", "a003", "a010", "a10", "a11"}, naturally_before);
  expect_sorted({"a02b1", "a2b1", "a02b2"}, naturally_before);
}

TEST(NaturallyBefore, NumbersMayBeLongerThanAnyInteger) {
  expect_sorted(
      {"9999999999999999999999998", "9999999999999999999999999", "10000000000000000000000000"},
      naturally_before);
}

TEST(NaturallyBefore, LettersAreComparedAsUnsignedBytes) {
  expect_sorted({"A1", "a1",
                 "\xC3\xA4"
                 "1"},
                naturally_before);
}

TEST(FileNaturallyBefore, EndingsDecideLast) {
  expect_sorted({"1.jpg", "1.png", "1 (1).png", "1 (2).png", "1-1.png", "2.jpg", "10.jpg"},
                file_naturally_before);
  expect_sorted({"view", "view.png", "view-1.png", "view-2.png"}, file_naturally_before);
}

}  // namespace
}  // namespace kinecal
