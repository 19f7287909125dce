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

/// What is found about a robot whose second joint has these elements.
Diagnostics found_about(const std::string& elements, const std::vector<std::string>& errors = {}) {
  const std::string text =
      "<robot name='r'><link name='a'/><link name='b'/><link name='c'/>"
      "<joint name='first' type='continuous'><parent link='a'/><child link='b'/></joint>\n"
      "<joint name='second' type='continuous'><parent link='b'/><child link='c'/>" +
      elements + "</joint></robot>";
  Diagnostics found;
  found.errors = errors;
  detail::check_ignored_urdf(parse_urdf(text, "r.urdf"), text, "r.urdf", found);
  return found;
}
std::vector<std::string> warnings_about(const std::string& elements) {
  const Diagnostics found = found_about(elements);
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

TEST(IgnoredUrdf, AMimicOfAMissingJointIsTheCauseOfItsMissingPosition) {
  const std::string missing = "s.yaml:1: joint 'second' is not in the sample";
  const Diagnostics found = found_about("<mimic joint='frist'/>", {missing});
  EXPECT_THAT(found.errors, ElementsAre(missing, AllOf(HasSubstr("mimics 'frist'"),
                                                       HasSubstr("correct <mimic>"))));
  EXPECT_THAT(found.warnings, testing::IsEmpty());
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
