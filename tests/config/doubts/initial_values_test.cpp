// Where frames start.
#include "kinecal/config/doubts/initial_values.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/arm_scene.hpp"

namespace kinecal {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

class InitialValues : public test::ArmScene {
 protected:
  void start(const std::string& xyz, const std::string& rpy) {
    config_text = test::kArmConfig + "free_frames_initial_values:\n - {name: tracker_frame, " +
                  xyz + ", " + rpy + "}\n";
  }
};

TEST_F(InitialValues, InMetresAndRadiansAreRight) {
  start("x: 30.0, y: 0.0, z: 1.0", "roll: 0.0, pitch: 0.0, yaw: 6.2");
  EXPECT_THAT(found().errors, IsEmpty());
  EXPECT_THAT(found().doubts, IsEmpty());
}

TEST_F(InitialValues, InOtherUnitsAreADoubt) {
  start("x: 0.3, y: 0.0, z: 1.0", "roll: 0.0, pitch: 0.0, yaw: 90.0");
  EXPECT_THAT(found().doubts,
              ElementsAre(HasSubstr("'tracker_frame' starts at an angle of 90; is it "
                                    "in degrees?")));
  start("x: 420.0, y: 0.0, z: 1.0", "roll: 0.0, pitch: 0.0, yaw: 0.0");
  EXPECT_THAT(found().doubts, ElementsAre(HasSubstr("420.001 m away; is it in millimetres?")));
}

TEST_F(InitialValues, ThatCannotBeMeantAreAnError) {
  start("x: 1.0e+200, y: 0.0, z: 1.0", "roll: 0.0, pitch: 0.0, yaw: 0.0");
  EXPECT_THAT(found().errors, ElementsAre(HasSubstr("initial value of frame 'tracker_frame'")));
}

}  // namespace
}  // namespace kinecal
