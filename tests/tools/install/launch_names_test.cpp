#include "kinecal/tools/install/launch_names.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "support/thrown.hpp"

namespace kinecal {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

std::string names_refusal(const std::vector<std::string>& given) {
  return test::thrown<InputError>([&] { (void)launch_names(given); }, "(not refused)");
}

TEST(LaunchNames, AreFetchsButForTheGivenOnes) {
  const LaunchNames names = launch_names({"z_scaling=s", "calibration_date=", "left_z_scaling=l"});
  EXPECT_EQ(names.at("z_scaling"), "s");
  EXPECT_EQ(names.at("calibration_date"), "");
  EXPECT_EQ(names.at("left_z_scaling"), "l");
  EXPECT_EQ(names.at("z_offset_mm"), "head_camera/driver/z_offset_mm");
  EXPECT_EQ(names.at("robot_description"), "robot_description");
}

TEST(LaunchNames, RefuseWrongKeys) {
  EXPECT_THAT(names_refusal({"z_scalin=s"}), HasSubstr("did you mean 'z_scaling'?"));
  EXPECT_THAT(names_refusal({"banana=s"}), AllOf(HasSubstr("'banana'"), Not(HasSubstr("did you"))));
  EXPECT_THAT(names_refusal({"z_scaling"}), HasSubstr("KEY=NAME"));
  EXPECT_THAT(names_refusal({"z_scaling=a", "z_scaling=b"}), HasSubstr("twice"));
}

}  // namespace
}  // namespace kinecal
