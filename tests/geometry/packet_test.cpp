#include "kinecal/geometry/packet.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <limits>

#include "kinecal/geometry/pose.hpp"

namespace kinecal {
namespace {

static_assert(kLanes<double> == 1);
static_assert(kLanes<Packet> == static_cast<int>(Packet::size()));

/// A packet with another number in each lane.
Packet counting(double first) {
  Packet p(0.0);
  for (int i = 0; i < kLanes<Packet>; ++i) set_lane(p, i, first + i);
  return p;
}

TEST(Packet, LanesAreSetAndReadOneByOne) {
  Packet p = counting(3.0);
  for (int i = 0; i < kLanes<Packet>; ++i) EXPECT_EQ(lane(p, i), 3.0 + i);
  set_lane(p, kLanes<Packet> - 1, -1.0);
  for (int i = 0; i + 1 < kLanes<Packet>; ++i) EXPECT_EQ(lane(p, i), 3.0 + i);
  EXPECT_EQ(lane(p, kLanes<Packet> - 1), -1.0);
}

TEST(Packet, ADoubleIsAPacketOfOneLane) {
  double x = 2.0;
  set_lane(x, 0, 5.0);
  EXPECT_EQ(lane(x, 0), 5.0);
  EXPECT_EQ(sum_of_lanes(x), 5.0);
  EXPECT_EQ(select(x > 4.0, 1.0, 2.0), 1.0);
  EXPECT_EQ(select(x > 6.0, 1.0, 2.0), 2.0);
}

TEST(Packet, SumsItsLanes) {
  const double n = kLanes<Packet>;
  EXPECT_EQ(sum_of_lanes(counting(1.0)), n * (n + 1.0) / 2.0);
  EXPECT_EQ(sum_of_lanes(Packet(0.25)), 0.25 * n);
}

TEST(Packet, SelectsLaneByLane) {
  const Packet x = counting(0.0), a = counting(100.0), b = counting(-100.0);
  for (int limit = 0; limit <= kLanes<Packet>; ++limit) {
    const Packet chosen = select(x < Packet(limit), a, b);
    for (int i = 0; i < kLanes<Packet>; ++i) {
      EXPECT_EQ(lane(chosen, i), i < limit ? 100.0 + i : -100.0 + i);
    }
  }
}

TEST(Packet, AValueInARegisterIsTheSame) {
  EXPECT_EQ(in_register(2.5), 2.5);
  const Packet x = counting(-1.5), same = in_register(x);
  for (int i = 0; i < kLanes<Packet>; ++i) EXPECT_EQ(lane(same, i), lane(x, i));
}

/// What is not chosen may be anything.
TEST(Packet, SelectIsNotSpoiledByWhatIsNotChosen) {
  const Packet x = counting(-1.0);
  const Packet root = select(x > Packet(0.0), Packet(sqrt(x)), Packet(7.0));
  for (int i = 0; i < kLanes<Packet>; ++i) {
    EXPECT_EQ(lane(root, i), i < 2 ? 7.0 : std::sqrt(i - 1.0));
  }
}

TEST(Packet, FunctionsTakeEachLaneByItself) {
  const Packet x = counting(0.25), y = counting(-1.5);
  for (int i = 0; i < kLanes<Packet>; ++i) {
    const double a = lane(x, i), b = lane(y, i);
    EXPECT_EQ(lane(sin(x), i), std::sin(a));
    EXPECT_EQ(lane(cos(x), i), std::cos(a));
    EXPECT_EQ(lane(exp(x), i), std::exp(a));
    EXPECT_EQ(lane(log(x), i), std::log(a));
    EXPECT_EQ(lane(log1p(x), i), std::log1p(a));
    EXPECT_EQ(lane(sqrt(x), i), std::sqrt(a));
    EXPECT_EQ(lane(abs(y), i), std::abs(b));
    EXPECT_EQ(lane(atan2(y, x), i), std::atan2(b, a));
    EXPECT_EQ(lane(tan(x), i), std::tan(a));
    EXPECT_EQ(lane(atan(y), i), std::atan(b));
    EXPECT_EQ(lane(asin(x / 8.0), i), std::asin(a / 8.0));
    EXPECT_EQ(lane(acos(x / 8.0), i), std::acos(a / 8.0));
    EXPECT_EQ(lane(cbrt(y), i), std::cbrt(b));
    EXPECT_EQ(lane(pow(x, 2.5), i), std::pow(a, 2.5));
    EXPECT_DOUBLE_EQ(lane(hypot(x, y), i), std::hypot(a, b));
  }
}

TEST(Packet, ComparesAsDoublesDo) {
  const Packet x = counting(0.0), one(1.0), two(2.0);
  const Packet nan(std::numeric_limits<double>::quiet_NaN()), minus_zero(-0.0);
  EXPECT_EQ(lane(select(x < one, one, two), 0), 1.0);
  EXPECT_EQ(lane(select(x <= one, one, two), 1), 1.0);
  EXPECT_EQ(lane(select(x > one, one, two), 1), 2.0);
  EXPECT_EQ(lane(select(x >= one, one, two), 1), 1.0);
  EXPECT_EQ(lane(select(x == one, one, two), 1), 1.0);
  EXPECT_EQ(lane(select(x != one, one, two), 1), 2.0);
  EXPECT_EQ(lane(select(nan == nan, one, two), 0), 2.0);
  EXPECT_TRUE(std::signbit(lane(minus_zero, 0)));
}

/// Sums of three products, perhaps fused in one and not in the other.
TEST(Packet, CalculatesInMatricesAndPosesAsDoublesDo) {
  constexpr double kFused = 1e-15;
  Pose<double> constant{exp(Vector3<double>(0.1, -0.2, 0.3)), {1, 2, 3}};
  Pose<Packet> pose;
  Vector3<Packet> p;
  std::vector<Pose<double>> poses;
  std::vector<Vector3<double>> points;
  for (int i = 0; i < kLanes<Packet>; ++i) {
    poses.push_back({exp(Vector3<double>(0.3, 0.1 * i, -0.5)), {0.1 * i, -0.2, 0.3}});
    points.emplace_back(0.5, -0.1 * i, 0.2);
    for (int r = 0; r < 3; ++r) {
      for (int c = 0; c < 3; ++c) set_lane(pose.rotation(r, c), i, poses.back().rotation(r, c));
      set_lane(pose.translation(r), i, poses.back().translation(r));
      set_lane(p(r), i, points.back()(r));
    }
  }
  const Vector3<Packet> moved = (constant * pose) * p, back = pose.inverse() * p;
  const Vector3<Packet> cross = p.cross(moved), half = 0.5 * p + p * 0.25;
  for (int i = 0; i < kLanes<Packet>; ++i) {
    const auto n = static_cast<std::size_t>(i);
    const Vector3<double> expected = (constant * poses[n]) * points[n];
    const Vector3<double> expected_back = poses[n].inverse() * points[n];
    const Vector3<double> expected_cross = points[n].cross(expected);
    for (int k = 0; k < 3; ++k) {
      EXPECT_NEAR(lane(moved(k), i), expected(k), 4 * kFused);
      EXPECT_NEAR(lane(back(k), i), expected_back(k), 4 * kFused);
      EXPECT_NEAR(lane(cross(k), i), expected_cross(k), 4 * kFused);
      EXPECT_NEAR(lane(half(k), i), 0.75 * points[n](k), kFused);
    }
  }
}

}  // namespace
}  // namespace kinecal
