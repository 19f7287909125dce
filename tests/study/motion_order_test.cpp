#include "kinecal/study/motion_order.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <stdexcept>

#include "kinecal/study/seeded_random.hpp"

namespace kinecal::test {
namespace {

struct RandomWay {
  JointPlaces places;
  std::vector<int> poses;
  std::vector<double> speeds = {1.0, 0.5, 2.0};

  RandomWay(int count, std::uint64_t seed) : poses(static_cast<std::size_t>(count)) {
    SeededRandom random(seed);
    for (int i = 0; i < count; ++i) {
      places.push_back({random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)});
    }
    std::iota(poses.begin(), poses.end(), 0);
  }
};

TEST(MotionOrder, AMoveTakesAsLongAsItsSlowestJoint) {
  const JointPlaces places = {{0.0, 0.0}, {1.0, 1.0}};
  EXPECT_DOUBLE_EQ(motion_time(places, {0, 1}, {2.0, 4.0}), 0.5);
  EXPECT_DOUBLE_EQ(motion_time(places, {1}, {2.0, 4.0}), 0.0);
}

TEST(MotionOrder, IsOfTheSamePosesAndNeverLonger) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const RandomWay way(30, seed);
    std::vector<int> order = motion_order(way.places, way.poses, way.speeds);
    EXPECT_EQ(order.front(), 0);
    EXPECT_LT(motion_time(way.places, order, way.speeds),
              0.6 * motion_time(way.places, way.poses, way.speeds));
    std::sort(order.begin(), order.end());
    EXPECT_EQ(order, way.poses);
  }
}

TEST(MotionOrder, OfFewPosesIsNearlyTheShortest) {
  double ours = 0.0, shortest = 0.0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    RandomWay way(7, seed);
    ours += motion_time(way.places, motion_order(way.places, way.poses, way.speeds), way.speeds);
    double least = 1e9;
    do {
      least = std::min(least, motion_time(way.places, way.poses, way.speeds));
    } while (std::next_permutation(way.poses.begin() + 1, way.poses.end()));
    shortest += least;
  }
  EXPECT_LT(ours, 1.05 * shortest);
}

TEST(MotionOrder, RefusesPosesOfOtherJointsAndJointsThatStandStill) {
  EXPECT_THROW((void)motion_order({{0.0}, {1.0, 2.0}}, {0, 1}, {1.0}), std::invalid_argument);
  EXPECT_THROW((void)motion_order({{0.0}, {1.0}}, {0, 1}, {0.0}), std::invalid_argument);
  EXPECT_TRUE(motion_order({}, {}, {1.0}).empty());
}

}  // namespace
}  // namespace kinecal::test
