#include "kinecal/geometry/traced.hpp"

#include <gtest/gtest.h>

#include "kinecal/geometry/jet.hpp"

namespace kinecal {
namespace {

using J = Jet<Traced, 2>;

const J kX(Traced(0.7, true), 0), kY(Traced(-1.3, true), 1);

/// That the derivatives of a function are constants, and which.
void expect_constant(const J& f, double by_x, double by_y) {
  EXPECT_FALSE(f.v(0).varies);
  EXPECT_FALSE(f.v(1).varies);
  EXPECT_DOUBLE_EQ(f.v(0).value, by_x);
  EXPECT_DOUBLE_EQ(f.v(1).value, by_y);
}

TEST(Traced, DerivativesOfLinearFunctionsAreConstants) {
  expect_constant(kX, 1, 0);
  expect_constant(kX - kY, 1, -1);
  expect_constant(-kX, -1, 0);
  expect_constant(2.0 * kX + kY / 4.0 - 3.0, 2, 0.25);
  expect_constant(J(Traced(5.0)) * kX, 5, 0);
  expect_constant(J(Traced(5.0)), 0, 0);
}

TEST(Traced, DerivativesOfOtherFunctionsVary) {
  EXPECT_TRUE((kX * kX).v(0).varies);
  EXPECT_FALSE((kX * kX).v(1).varies);  // nothing there
  EXPECT_TRUE((kX * kY).v(0).varies);
  EXPECT_TRUE((kX / kY).v(1).varies);
  for (const J& f : {sqrt(kX), sin(kX), cos(kX), exp(kX), log(kX), atan2(kX, kY)}) {
    EXPECT_TRUE(f.v(0).varies);
  }
}

/// On this side, each piece is linear.
TEST(Traced, DerivativesOfFunctionsInPiecesVary) {
  EXPECT_TRUE(abs(kX).v(0).varies);
  EXPECT_TRUE(select(kX < J(Traced(100.0)), kX, -kX).v(0).varies);
  EXPECT_TRUE(select(kX >= kY, kX, kY).v(0).varies);
  EXPECT_TRUE(select(kX == kY, kX, kY).v(0).varies);
}

TEST(Traced, AChoiceBetweenConstantsIsOne) {
  const J one(Traced(1.0)), two(Traced(2.0));
  expect_constant(select(one < two, kX, kY), 1, 0);
  expect_constant(select(one > two, kX, kY), 0, 1);
}

TEST(Traced, ValuesAreThoseOfNumbers) {
  const double x = 0.7, y = -1.3;
  EXPECT_EQ((kX * kY - kX / kY).a.value, x * y - x * (1.0 / y));
  EXPECT_EQ(sqrt(kX).a.value, std::sqrt(x));
  EXPECT_EQ(atan2(kX, kY).a.value, std::atan2(x, y));
  EXPECT_EQ(sqrt(kX).v(0).value, 0.5 / std::sqrt(x));
}

}  // namespace
}  // namespace kinecal
