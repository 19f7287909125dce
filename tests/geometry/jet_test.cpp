#include "kinecal/geometry/jet.hpp"

#include <ceres/jet.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "kinecal/geometry/rotation.hpp"

namespace kinecal {
namespace {

constexpr double kRoundingOfJets = 1e-14;  // a few dozen operations on numbers of size one

/// A formula with everything that a jet can do, its arguments positive.
template <class T>
T everything(const T& x, const T& y, const T& z) {
  using std::abs, std::acos, std::asin, std::atan, std::atan2, std::cbrt, std::cos, std::exp,
      std::hypot, std::log, std::log1p, std::pow, std::sin, std::sqrt, std::tan;
  T sum = x * y - z / x + 2.0 * y - z * 0.5 + T(1.0) / z + y / 4.0;
  sum += sin(x * z) * cos(y) + exp(-x) * log(y + 1.0);
  sum -= sqrt(x * x + y * y + 0.5) * atan2(z - 1.0, x + y);
  sum += tan(x * 0.3) * asin(z * 0.35) + acos(x * 0.4) * atan(y) + cbrt(y) * hypot(x, z);
  sum += log1p(x) * pow(y, 2.5) + pow(z - 1.0, 3.0) - pow(x + 1.0, -1.0);
  sum *= abs(x - y) + abs(y - x) + 1.0;
  sum /= z + 3.0 - x * 0.1;
  return 1.0 - (-sum) + 2.0;
}

const std::vector<std::array<double, 3>> kArguments = {
    {0.7, 1.3, 0.4}, {1.9, 0.2, 2.5}, {0.1, 0.9, 1.1}, {1.2, 1.1, 0.3}, {0.5, 2.0, 0.8}};

TEST(Jet, AgreesWithThatOfCeres) {
  for (const auto& [x, y, z] : kArguments) {
    using J = Jet<double, 3>;
    using Reference = ceres::Jet<double, 3>;
    const J found = everything(J(x, 0), J(y, 1), J(z, 2));
    const Reference expected = everything(Reference(x, 0), Reference(y, 1), Reference(z, 2));
    EXPECT_NEAR(found.a, expected.a, kRoundingOfJets * (1 + std::abs(expected.a)));
    EXPECT_LE((found.v - expected.v).norm(), kRoundingOfJets * (1 + expected.v.norm()));
    EXPECT_NEAR(found.a, everything(x, y, z), kRoundingOfJets * (1 + std::abs(expected.a)));
  }
}

TEST(Jet, AgreesWithCentralDifferences) {
  constexpr double kStep = 1e-5, kDifferences = 1e-8;  // step^2 times a third derivative
  for (const auto& at : kArguments) {
    using J = Jet<double, 3>;
    const J found = everything(J(at[0], 0), J(at[1], 1), J(at[2], 2));
    for (std::size_t k = 0; k < 3; ++k) {
      auto up = at, down = at;
      up[k] += kStep;
      down[k] -= kStep;
      const double numeric =
          (everything(up[0], up[1], up[2]) - everything(down[0], down[1], down[2])) / (2 * kStep);
      EXPECT_NEAR(found.v(static_cast<int>(k)), numeric, kDifferences * (1 + std::abs(numeric)));
    }
  }
}

TEST(Jet, OfPacketsIsOneJetOfDoublesInEachLane) {
  using J = Jet<Packet, 3>;
  std::array<Packet, 3> at = {Packet(0.0), Packet(0.0), Packet(0.0)};
  for (int i = 0; i < kLanes<Packet>; ++i) {
    const auto& arguments = kArguments[static_cast<std::size_t>(i) % kArguments.size()];
    for (std::size_t k = 0; k < 3; ++k) set_lane(at[k], i, arguments[k]);
  }
  const J found = everything(J(at[0], 0), J(at[1], 1), J(at[2], 2));
  for (int i = 0; i < kLanes<Packet>; ++i) {
    const auto& [x, y, z] = kArguments[static_cast<std::size_t>(i) % kArguments.size()];
    using One = Jet<double, 3>;
    const One expected = everything(One(x, 0), One(y, 1), One(z, 2));
    EXPECT_NEAR(lane(found.a, i), expected.a, kRoundingOfJets * (1 + std::abs(expected.a)));
    for (int k = 0; k < 3; ++k) {
      EXPECT_NEAR(lane(found.v(k), i), expected.v(k),
                  kRoundingOfJets * (1 + std::abs(expected.v(k))));
    }
  }
}

TEST(Jet, OfPacketsIsSelectedLaneByLaneWithItsDerivatives) {
  using J = Jet<Packet, 2>;
  Packet x(0.0);
  for (int i = 0; i < kLanes<Packet>; ++i) set_lane(x, i, i % 2 == 0 ? 2.0 + i : -2.0 - i);
  const J variable(x, 0);
  const J size = abs(variable);
  const J chosen = select(variable > J(Packet(0.0)), variable * variable, J(x, 1));
  for (int i = 0; i < kLanes<Packet>; ++i) {
    const double value = lane(x, i);
    EXPECT_EQ(lane(size.a, i), std::abs(value));
    EXPECT_EQ(lane(size.v(0), i), value > 0 ? 1.0 : -1.0);
    EXPECT_EQ(lane(chosen.a, i), value > 0 ? value * value : value);
    EXPECT_EQ(lane(chosen.v(0), i), value > 0 ? 2.0 * value : 0.0);
    EXPECT_EQ(lane(chosen.v(1), i), value > 0 ? 0.0 : 1.0);
  }
}

template <class J>
concept Mixes = requires(J j) {
  j + 1.0;
  1.0 + j;
  j - 1.0;
  1.0 - j;
  j * 2.0;
  2.0 * j;
  j / 2.0;
};
template <class J>
concept DividesNumbers = requires(J j) {
  1.0 / j;
};
template <class J>
concept ComparesWithNumbers = requires(J j) {
  j < 0.0;
  0.0 < j;
  j >= 1.0;
};
template <class J>
concept SelectsNumbers = requires(J j) {
  select(j < j, j, 0.0);
};

/// A block that takes one takes the other: it is checked with jets of doubles alone.
TEST(Jet, OfPacketsMixesWithNumbersAsThatOfDoublesDoes) {
  using OfDoubles = Jet<double, 3>;
  using OfPackets = Jet<Packet, 3>;
  EXPECT_TRUE(Mixes<OfDoubles>);
  EXPECT_TRUE(Mixes<OfPackets>);
  EXPECT_EQ(DividesNumbers<OfPackets>, DividesNumbers<OfDoubles>) << "1.0 / x";
  EXPECT_EQ(ComparesWithNumbers<OfPackets>, ComparesWithNumbers<OfDoubles>) << "x < 0.0";
  EXPECT_EQ(SelectsNumbers<OfPackets>, SelectsNumbers<OfDoubles>) << "select(x < y, x, 0.0)";
}

/// As an error block writes it: a point minus a constant one.
template <class J>
J distance_to(const Vector3<J>& p, const Vector3<double>& center) {
  return sqrt((2.0 * (p - center) + center).squaredNorm());
}

TEST(Jet, OfPacketsMixesWithVectorsOfNumbers) {
  const Vector3<double> p(1.0, 2.0, 3.0), center(0.3, -0.4, 0.5);
  using OfDoubles = Jet<double, 3>;
  using OfPackets = Jet<Packet, 3>;
  const OfDoubles one = distance_to(point_jets<OfDoubles>(p, 0), center);
  const OfPackets all =
      distance_to(point_jets<OfPackets>(Vector3<Packet>(p.cast<Packet>()), 0), center);
  const Packet packet = distance_to(Vector3<Packet>(p.cast<Packet>()), center);
  EXPECT_NEAR(lane(packet, 0), one.a, kRoundingOfJets);
  EXPECT_NEAR(lane(all.a, 0), one.a, kRoundingOfJets);
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(lane(all.v(k), 0), one.v(k), kRoundingOfJets);
}

TEST(Jet, ANumberHasNoDerivatives) {
  using J = Jet<double, 2>;
  const J number = 3.5, integer = 2;
  EXPECT_EQ(number.a, 3.5);
  EXPECT_EQ(integer.a, 2.0);
  EXPECT_TRUE(number.v.isZero(0.0) && integer.v.isZero(0.0) && J().v.isZero(0.0));
  EXPECT_EQ(J().a, 0.0);
}

TEST(Jet, IsComparedByItsValue) {
  using J = Jet<double, 1>;
  const J one(1.0, 0), same(1.0), two(2.0);
  EXPECT_TRUE(one == same && one < two && two > one && one <= same && two >= one);
  EXPECT_FALSE(one < same || one > same || one == two);
}

TEST(Jet, VariablesValuesAndDerivativesAreFoundAgain) {
  using J = Jet<double, 6>;
  const Vector3<double> p(1, 2, 3), q(4, 5, 6);
  const auto a = point_jets<J>(p, 0), b = point_jets<J>(q, 3);
  const Eigen::Matrix<J, 3, 1> cross(a.y() * b.z() - a.z() * b.y(), a.z() * b.x() - a.x() * b.z(),
                                     a.x() * b.y() - a.y() * b.x());
  EXPECT_EQ(values_of(cross), p.cross(q));
  EXPECT_EQ(derivatives_by<3>(cross, 0), Matrix3<double>(-cross_matrix(q)));
  EXPECT_EQ(derivatives_by<3>(cross, 3), cross_matrix(p));
  EXPECT_EQ(value_of(a.x()), 1.0);
  EXPECT_EQ(value_of(7.0), 7.0);
}

}  // namespace
}  // namespace kinecal
