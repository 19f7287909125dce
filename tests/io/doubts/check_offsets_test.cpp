// Offsets against limits.
#include "kinecal/io/doubts/check_offsets.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>

#include "support/arm_scene.hpp"

namespace kinecal {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

/// Positions are anywhere within the limits; 'lift' may travel from -1.2 to 1.4.
class CheckOffsets : public test::ArmScene {
 protected:
  [[nodiscard]] Diagnostics with_offset(const std::string& joint, double offset) const {
    const Config read = config();
    const Robot robot = parse_urdf(urdf, "arm.urdf");
    const std::string name = "arm.urdf";
    Diagnostics diagnostics;
    const Calibration calibration = assemble(read, robot, samples, diagnostics);
    ParameterTable table = calibration.table;
    table[table.index(joint)].value = offset;
    check_offsets({read, robot, urdf, name, samples, calibration}, table, diagnostics);
    return diagnostics;
  }
};

TEST_F(CheckOffsets, OfSomeDegreesAreRight) {
  EXPECT_THAT(with_offset("lift", 0.2).errors, IsEmpty());
  EXPECT_THAT(with_offset("lift", 0.2).doubts, IsEmpty());
  EXPECT_THAT(with_offset("lift", -0.2).errors, IsEmpty());
}

TEST_F(CheckOffsets, AWholeTurnIsNone) {
  const Diagnostics diagnostics = with_offset("lift", -2 * std::numbers::pi + 0.02);
  EXPECT_THAT(diagnostics.errors, IsEmpty());
  EXPECT_THAT(diagnostics.doubts, IsEmpty());
}

TEST_F(CheckOffsets, BeyondTheTravelOfTheJointAreAnError) {
  EXPECT_THAT(with_offset("lift", 2.8).errors,
              ElementsAre("arm.urdf:11: the offset of 'lift' is 160.4 deg, but the joint can only "
                          "travel 149.0 deg; the result cannot be right"));
}

TEST_F(CheckOffsets, ThatMoveRecordedPositionsFarBeyondTheLimitsAreAnError) {
  EXPECT_THAT(with_offset("lift", 1.0).errors,
              ElementsAre(HasSubstr("with it, the joint was at 2.")));
}

TEST_F(CheckOffsets, ThatAreLargeAreADoubt) {
  for (Sample& sample : samples) position(sample, "lift") *= 0.1;
  const Diagnostics diagnostics = with_offset("lift", 1.0);
  EXPECT_THAT(diagnostics.errors, IsEmpty());
  EXPECT_THAT(diagnostics.doubts, ElementsAre(HasSubstr("the offset of 'lift' is 57.3 deg")));
}

TEST_F(CheckOffsets, AreNotBlamedForPositionsThatWereOutsideBefore) {
  for (Sample& sample : samples) position(sample, "lift") = -2.4;
  EXPECT_THAT(with_offset("lift", 0.1).errors, IsEmpty());
}

TEST_F(CheckOffsets, OfAJointWithoutLimitsCanOnlyBeLarge) {
  replace(urdf, "name=\"lift\" type=\"revolute\"", "name=\"lift\" type=\"continuous\"");
  EXPECT_THAT(with_offset("lift", 2.8).errors, IsEmpty());
  EXPECT_THAT(with_offset("lift", 2.8).doubts, ElementsAre(HasSubstr("160.4 deg")));
}

}  // namespace
}  // namespace kinecal
