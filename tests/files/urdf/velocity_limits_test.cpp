#include "kinecal/files/urdf/velocity_limits.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace kinecal {
namespace {

using testing::HasSubstr;
using testing::Pair;
using testing::UnorderedElementsAre;

/// A URDF of three joints; the first one has this limit.
std::string urdf(const std::string& velocity) {
  return R"(<robot name="r">
  <joint name="pan" type="revolute"><limit velocity=")" +
         velocity + R"(" lower="0" upper="1"/></joint>
  <joint name="lift" type="prismatic"><limit lower="0" upper="1" velocity="0"/></joint>
  <joint name="flange" type="fixed"/>
  <transmission><joint name="pan"><limit velocity="9"/></joint></transmission>
</robot>)";
}

TEST(VelocityLimits, AreThoseOfTheJointsThatHaveOne) {
  EXPECT_THAT(velocity_limits(urdf("1.25"), "r.urdf"), UnorderedElementsAre(Pair("pan", 1.25)));
}

TEST(VelocityLimits, NamePlaceAndTextOfWhatIsNotANumber) {
  try {
    (void)velocity_limits(urdf("fast"), "r.urdf");
    FAIL() << "no error";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("r.urdf:2"));
    EXPECT_THAT(error.what(), HasSubstr("fast"));
  }
}

}  // namespace
}  // namespace kinecal
