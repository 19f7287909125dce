#include "kinecal/trust/f_distribution.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace kinecal {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

TEST(FDistribution, HasClosedFormsForTwoDegreesOfFreedom) {
  // P(F > f) = (1 + 2 f / b)^(-b/2), and for chi-square of two exp(-f).
  for (const double f : {0.01, 0.5, 1.0, 3.0, 20.0}) {
    EXPECT_NEAR(f_tail(f, 2.0, 6.0), std::pow(1.0 + f / 3.0, -3.0), 1e-13);
    EXPECT_NEAR(f_tail(f, 2.0, kInfinity), std::exp(-f), 1e-12 * std::exp(-f));
  }
}

TEST(FDistribution, AgreesWithTables) {
  EXPECT_NEAR(f_tail(3.3258, 5.0, 10.0), 0.05, 1e-5);
  EXPECT_NEAR(f_tail(2.0921, 12.0, 30.0), 0.05, 2e-5);
  EXPECT_NEAR(f_tail(18.307 / 10.0, 10.0, kInfinity), 0.05, 1e-5);
  EXPECT_NEAR(f_tail(124.342 / 100.0, 100.0, kInfinity), 0.05, 1e-5);
}

TEST(FDistribution, EndsAtZeroAndOne) {
  EXPECT_EQ(f_tail(0.0, 3.0, 5.0), 1.0);
  EXPECT_EQ(f_tail(kInfinity, 3.0, 5.0), 0.0);
  EXPECT_LT(f_tail(1e6, 60.0, 500.0), 1e-300);
  EXPECT_GE(f_tail(1e6, 60.0, kInfinity), 0.0);
}

TEST(FDistribution, OfManyDegreesOfFreedomIsChiSquare) {
  EXPECT_NEAR(f_tail(1.3, 60.0, 1e12), f_tail(1.3, 60.0, kInfinity), 1e-9);
}

TEST(FDistribution, IsNaNWhereItIsNotDefinedAndDoesNotThrow) {
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(std::isnan(f_tail(1.0, kNaN, 5.0)));
  EXPECT_TRUE(std::isnan(f_tail(1.0, 3.0, kNaN)));
  EXPECT_TRUE(std::isnan(f_tail(1.0, 3.0, -1.0)));
  EXPECT_EQ(f_tail(kNaN, 3.0, 5.0), 1.0);
  EXPECT_TRUE(std::isnan(chi_square_exceeded(0.0, 0.5)));
}

TEST(ChiSquare, IsExceededWithTheProbabilityAsked) {
  for (const double probability : {1e-9, 0.025, 0.5, 0.975}) {
    const double sum = chi_square_exceeded(9.0, probability);
    EXPECT_NEAR(f_tail(sum / 9.0, 9.0, kInfinity), probability, 1e-10 * probability);
  }
}

}  // namespace
}  // namespace kinecal
