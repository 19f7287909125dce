// Offsets against limits.
#include "kinecal/config/doubts/check_offsets.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>

#include "kinecal/files/samples/read_samples.hpp"
#include "support/arm_scene.hpp"
#include "support/data.hpp"

namespace kinecal {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

/// Positions are anywhere within the limits; 'lift' may travel from -1.2 to 1.4.
class CheckOffsets : public test::ArmScene {
 protected:
  bool is_initial = false;  ///< the offset is the initial value

  [[nodiscard]] Diagnostics with_offset(const std::string& joint, double offset) const {
    const Config read = config();
    const Robot robot = parse_urdf(urdf, "arm.urdf");
    const std::string name = "arm.urdf";
    Diagnostics diagnostics;
    const Calibration calibration = assemble(read, robot, samples, diagnostics);
    ParameterTable table = calibration.table;
    table[table.index(joint)].value = offset;
    if (is_initial) table[table.index(joint)].initial = offset;
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
  EXPECT_THAT(with_offset("lift", 2.7).errors, IsEmpty());
  EXPECT_THAT(with_offset("lift", 2.7).doubts, ElementsAre(HasSubstr("154.7 deg")));
}

TEST_F(CheckOffsets, OfHalfATurnLookLikeAWrongSignUnlessTheyAreKnown) {
  while (urdf.find("revolute") != std::string::npos) replace(urdf, "revolute", "continuous");
  EXPECT_THAT(with_offset("elbow", 3.1).errors,
              ElementsAre(HasSubstr("the offset of 'elbow' is 177.6 deg, half a turn")));
  is_initial = true;
  EXPECT_THAT(with_offset("elbow", 3.1).errors, IsEmpty());
  EXPECT_THAT(with_offset("elbow", 3.1).doubts, IsEmpty());
}

/// The mirror image of the robot fits as well as the robot: only its offsets show it.
TEST(CheckRealOffsets, AFirstJointWithTheWrongSignIsFoundByTheOffsetsItCosts) {
  KINECAL_NEEDS_DATA("ur5_tracker");
  const auto folder = test::data_folder() / "ur5_tracker";
  const std::string name = (folder / "ur5.urdf").string(), text = read_urdf_text(name);
  const Robot robot = parse_urdf(text, name);
  Diagnostics diagnostics;
  const Config read = read_config((folder / "offsets.yaml").string(), diagnostics);
  auto samples = read_samples((folder / "grid.yaml").string(), diagnostics);
  for (Sample& sample : samples) sample.joint_positions[0] *= -1.0;  // shoulder_pan_joint
  const Calibration calibration = assemble(read, robot, samples, diagnostics);
  const CalibrationResult result = calibrate(calibration);
  ASSERT_TRUE(result.converged);
  EXPECT_LT(result.blocks[0].after.median, 1e-3) << "it does not fit, which is easier to see";
  check_offsets({read, robot, text, name, samples, calibration}, result.table, diagnostics);
  EXPECT_THAT(diagnostics.errors,
              ElementsAre(HasSubstr("'shoulder_lift_joint' is -179.9 deg, half a turn")));
}

}  // namespace
}  // namespace kinecal
