#include "kinecal/io/messages/definition.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "kinecal/io/messages/known_definitions.hpp"

namespace kinecal {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

std::vector<std::string> field_names(const MessageType& type) {
  std::vector<std::string> names;
  for (const MessageField& field : type.fields) names.push_back(field.name);
  return names;
}

/// What is thrown for a text.
std::string refusal(const std::string& text) {
  try {
    (void)parse_definition("a/Type", text);
  } catch (const DefinitionError& e) {
    return e.what();
  }
  return "nothing";
}

TEST(Definition, HasFieldsListsAndOtherMessagesButNoConstantsAndComments) {
  const MessageDefinition d = parse_definition("a/Type",
                                               "# a comment\n"
                                               "uint8 RED = 1  # constant\n"
                                               "string NAME=\"x y\"\r\n"
                                               "bool flag # why\r\n"
                                               "float64[9] K\n"
                                               "int32[<=4] few\n"
                                               "string<=10 short\n"
                                               "int32 given 5\n"
                                               "Other[] others\n"
                                               "====================\n"
                                               "MSG: a/Other\n"
                                               "float32 x\n");
  ASSERT_EQ(d.size(), 2u);
  EXPECT_THAT(field_names(d[0]), ElementsAre("flag", "K", "few", "short", "given", "others"));
  EXPECT_EQ(d[0].fields[0].type, FieldType::boolean);
  EXPECT_EQ(d[0].fields[1].count, MessageField::Count::fixed);
  EXPECT_EQ(d[0].fields[1].size, 9u);
  EXPECT_EQ(d[0].fields[2].count, MessageField::Count::any);
  EXPECT_EQ(d[0].fields[3].type, FieldType::text);
  EXPECT_EQ(d[0].fields[5].message, 1u);
  EXPECT_THAT(field_names(d[1]), ElementsAre("x"));
}

TEST(Definition, FindsHeaderAndTimeOfRos1AndThePackagesOfRos2) {
  const MessageDefinition one = parse_definition("sensor_msgs/JointState",
                                                 "Header header\n===\nMSG: std_msgs/Header\n"
                                                 "uint32 seq\ntime stamp\nstring frame_id\n");
  EXPECT_THAT(field_names(one[1]), ElementsAre("seq", "stamp", "frame_id"));
  EXPECT_THAT(field_names(one[2]), ElementsAre("secs", "nsecs"));
  const MessageDefinition two =
      parse_definition("sensor_msgs/msg/JointState",
                       "std_msgs/Header header\n===\nMSG: std_msgs/msg/Header\n"
                       "builtin_interfaces/Time stamp\n===\nMSG: builtin_interfaces/Time\n"
                       "int32 sec\nuint32 nanosec\n");
  EXPECT_EQ(two[0].name, "sensor_msgs/JointState");
  EXPECT_THAT(field_names(two[2]), ElementsAre("sec", "nanosec"));
}

TEST(Definition, SaysWhatIsWrongWithIt) {
  EXPECT_THAT(refusal("float64 x\nOther other\n"), HasSubstr("'a/Other' is used and not defined"));
  EXPECT_THAT(refusal("float64\n"), HasSubstr("line 1: 'float64' has no name"));
  EXPECT_THAT(refusal("float64[x] y\n"), HasSubstr("line 1: '[x]' is no size"));
  EXPECT_THAT(refusal("float64[3 y\n"), HasSubstr("is no size"));
  EXPECT_THAT(refusal("float64[99999999999] y\n"), HasSubstr("is no size"));
  EXPECT_THAT(refusal("\nwstring y\n"), HasSubstr("line 2: wide strings"));
  EXPECT_THAT(refusal("Type again\n"), HasSubstr("contains itself"));
  EXPECT_THAT(refusal("B b\n===\nMSG: a/B\nC c\n===\nMSG: a/C\nB b\n"),
              HasSubstr("contains itself"));
}

TEST(Definition, OfAllKnownMessagesIsComplete) {
  for (const Encoding encoding : {Encoding::ros1, Encoding::cdr}) {
    for (const detail::KnownMessage& known : detail::kKnownMessages) {
      const std::string type(known.type);
      EXPECT_FALSE(parse_definition(type, known_definition(type, encoding))[0].fields.empty())
          << type;
    }
  }
  EXPECT_EQ(known_definition("std_msgs/Float64", Encoding::cdr), "");
  EXPECT_THAT(known_definition("sensor_msgs/CameraInfo", Encoding::ros1), HasSubstr("[12] P\n"));
}

}  // namespace
}  // namespace kinecal
