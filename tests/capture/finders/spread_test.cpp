#include "kinecal/capture/finders/spread.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

namespace kinecal {
namespace {

TEST(Spread, ThinnedTakesOneOfEachPiece) {
  const auto some = thinned(640 * 480, 2048);
  ASSERT_EQ(some.size(), 2048u);
  std::set<std::size_t> columns;
  for (std::size_t i = 0; i < some.size(); ++i) {
    EXPECT_EQ(some[i] / 150, i);
    columns.insert(some[i] % 640);
  }
  EXPECT_GT(columns.size(), 400u) << "of the image";
  EXPECT_EQ(thinned(3, 10), (std::vector<std::size_t>{0, 1, 2}));
  EXPECT_TRUE(thinned(0, 10).empty());
  EXPECT_TRUE(thinned(10, 0).empty());
}

TEST(Spread, IsEvenInSpaceWhereThePointsAreNot) {
  std::vector<Vector3<double>> line;  // ever denser towards 0
  for (int i = 1; i <= 5000; ++i) line.emplace_back(1.0 / i, 0.0, 0.0);
  const auto chosen = spread(line, 9);
  ASSERT_EQ(chosen.size(), 9u);
  EXPECT_TRUE(std::is_sorted(chosen.begin(), chosen.end()));
  EXPECT_GT((line[chosen[0]] - line[chosen[1]]).norm(), 0.05);
  EXPECT_LT(line[chosen[3]].x(), 0.5);
}

TEST(Spread, TakesAnyNumber) {
  const std::vector<Vector3<double>> same(100, Vector3<double>::Ones());
  EXPECT_EQ(spread(same, 10).size(), 1u) << "points at one place count once";
  EXPECT_EQ(spread(same, 100).size(), 100u);
  EXPECT_TRUE(spread(same, 0).empty());
  EXPECT_TRUE(spread({}, 5).empty());
}

}  // namespace
}  // namespace kinecal
