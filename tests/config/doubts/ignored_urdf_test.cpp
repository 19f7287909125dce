// What urdfdom takes and no chain can use is a warning.
#include "kinecal/config/doubts/ignored_urdf.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "kinecal/files/urdf/read_urdf.hpp"

namespace kinecal {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

/// The warnings about a robot whose second joint has these elements.
std::vector<std::string> warnings_about(const std::string& elements) {
  const std::string text =
      "<robot name='r'><link name='a'/><link name='b'/><link name='c'/>"
      "<joint name='first' type='continuous'><parent link='a'/><child link='b'/></joint>\n"
      "<joint name='second' type='continuous'><parent link='b'/><child link='c'/>" +
      elements + "</joint></robot>";
  Diagnostics found;
  detail::check_ignored_urdf(parse_urdf(text, "r.urdf"), text, "r.urdf", found);
  EXPECT_TRUE(found.errors.empty());
  return found.warnings;
}

TEST(IgnoredUrdf, NothingOfARobotWithoutFaults) {
  EXPECT_THAT(warnings_about("<mimic joint='first'/>"), testing::IsEmpty());
}

TEST(IgnoredUrdf, AMimicOfAMissingJoint) {
  EXPECT_THAT(
      warnings_about("<mimic joint='frist'/>"),
      ElementsAre(AllOf(HasSubstr("r.urdf:2: joint 'second' mimics 'frist', which does not"),
                        HasSubstr("did you mean 'first'?"))));
}

TEST(IgnoredUrdf, AMimicOfItself) {
  EXPECT_THAT(warnings_about("<mimic joint='second'/>"),
              ElementsAre(HasSubstr("mimics 'second', which mimics it")));
}

TEST(IgnoredUrdf, AnAxisOfLengthZero) {
  EXPECT_THAT(warnings_about("<axis xyz='0 0 0'/>"),
              ElementsAre(HasSubstr("joint 'second' has an axis of length zero")));
}

}  // namespace
}  // namespace kinecal
