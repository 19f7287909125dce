// Hard and soft iron of a magnetometer as an error block.
#include "kinecal/errors/magnetic_field.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

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

double residual(const Own& own, const Sample& sample) {
  const std::array<double, 3> m = {sample.conditions.at("mag_x"), sample.conditions.at("mag_y"),
                                   sample.conditions.at("mag_z")};
  return MagneticField{}(own, m)(0);
}

TEST(MagneticField, KeepsTheLaws) {
  EXPECT_EQ(check_block(MagneticField{}), kLawsHold);
}

TEST(MagneticField, IsZeroAtTheTruthOnly) {
  const test::SimulatedMagnetometer of = test::with_soft_iron(0.0);
  const Own truth = truth_of(of);
  for (const Sample& sample : of.samples(40, 1)) EXPECT_NEAR(residual(truth, sample), 0.0, 1e-12);
  for (std::size_t p = 0; p < truth.size(); ++p) {
    Own other = truth;
    other[p] += 0.01;
    double most = 0.0;
    for (const Sample& sample : of.samples(40, 1))
      most = std::max(most, std::abs(residual(other, sample)));
    EXPECT_GT(most, 1e-4) << MagneticField::kParameters[p].name;
  }
}

/// Of a turn about z, the bias along z changes all residuals as the field does: exactly, so nothing runs away.
TEST(MagneticField, ATurnDoesNotFeelTheBiasAlongItsAxis) {
  test::SimulatedMagnetometer of{.noise = 0.0};
  const Own own = {13.0, -7.5, 20.0, 0.1, 0.0, 0.0, 0.02, 0.0, 0.0, 48.0};
  Own other = own;
  other[2] += 11.0;
  const double z = of.samples(1, 1)[0].conditions.at("mag_z"), before = z - own[2],
               now = z - other[2];
  other[9] = std::sqrt(own[9] * own[9] + now * now - before * before);
  for (const Sample& sample : of.samples(10, 1))
    EXPECT_NEAR(residual(other, sample), residual(own, sample), 1e-11);
}

}  // namespace
}  // namespace kinecal
