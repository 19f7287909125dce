// Changes of parameters, as judged.
#include "kinecal/trust/judge_values.hpp"

#include <gtest/gtest.h>

#include "kinecal/errors/base_motion.hpp"

namespace kinecal {
namespace {

/// Scales of a base are factors that begin at 1; gains of a camera are v of 1 + v.
TEST(JudgeValues, AChangeIsRelativeToWhereTheScaleBegins) {
  const ParameterInfo scale = GyroToPose::kParameters[0];
  Parameter of_base{"imu_scale", "1", scale.initial, 2.0, scale.lower, scale.upper};
  EXPECT_DOUBLE_EQ(detail::change_of(of_base), 1.0);
  of_base.initial = 2.0;
  EXPECT_DOUBLE_EQ(detail::change_of(of_base), 0.0);
  EXPECT_DOUBLE_EQ(detail::change_of({"camera_fx", "1", 0.0, 0.2}), 0.2);
  EXPECT_DOUBLE_EQ(detail::change_of({"camera_fx", "1", 1.0, 0.5}), -0.25);
}

}  // namespace
}  // namespace kinecal
