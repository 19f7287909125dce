// Hard and soft iron of a magnetometer as an error block.
#include "kinecal/errors/magnetic_field.hpp"

#include <gtest/gtest.h>

#include "kinecal/testing.hpp"
#include "support/magnetometer.hpp"

namespace kinecal {
namespace {

static_assert(ErrorBlock<MagneticField> && kSensors<MagneticField> == 0);

using Own = std::array<double, 10>;

Own truth_of(const test::SimulatedMagnetometer& of) {
  return {of.bias.x(),         of.bias.y(),         of.bias.z(),   of.soft(0, 0) - 1.0,
          of.soft(1, 1) - 1.0, of.soft(2, 2) - 1.0, of.soft(0, 1), of.soft(0, 2),
          of.soft(1, 2),       of.earth.norm()};
}

test::SimulatedMagnetometer iron() {
  test::SimulatedMagnetometer of{.noise = 0.0, .all_ways = true};
  of.soft << 1.08, 0.03, -0.02, 0.03, 0.95, 0.01, -0.02, 0.01, 1.0;
  return of;
}

double residual(const Own& own, const Sample& sample) {
  const std::array<double, 3> m = {sample.conditions.at("mag_x"), sample.conditions.at("mag_y"),
                                   sample.conditions.at("mag_z")};
  return MagneticField{}(own, m)(0);
}

TEST(MagneticField, KeepsTheLaws) {
  EXPECT_EQ(check_block(MagneticField{}), kLawsHold);
}

TEST(MagneticField, IsZeroAtTheTruthOnly) {
  const test::SimulatedMagnetometer of = iron();
  const Own truth = truth_of(of);
  for (const Sample& sample : of.samples(40, 1)) EXPECT_NEAR(residual(truth, sample), 0.0, 1e-14);
  for (std::size_t p = 0; p < truth.size(); ++p) {
    Own other = truth;
    other[p] += 0.01;
    double most = 0.0;
    for (const Sample& sample : of.samples(40, 1))
      most = std::max(most, std::abs(residual(other, sample)));
    EXPECT_GT(most, 1e-4) << MagneticField::kParameters[p].name;
  }
}

/// So that least squares cannot make everything small.
TEST(MagneticField, DoesNotFeelItsGauge) {
  const test::SimulatedMagnetometer of = iron();
  Own own = truth_of(of), half = own;
  own[0] += 1.0;
  half[0] += 1.0;
  for (const std::size_t diagonal : {3u, 4u, 5u})
    half[diagonal] = 0.5 * (1.0 + own[diagonal]) - 1.0;
  for (const std::size_t beside : {6u, 7u, 8u}) half[beside] = 0.5 * own[beside];
  half[9] = 0.5 * own[9];
  for (const Sample& sample : of.samples(10, 1))
    EXPECT_NEAR(residual(half, sample), residual(own, sample), 1e-14);
}

}  // namespace
}  // namespace kinecal
