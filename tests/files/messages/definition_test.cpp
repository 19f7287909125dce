#include "kinecal/files/messages/definition.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "kinecal/files/messages/known_definitions.hpp"
#include "kinecal/files/messages/known_messages.ipp"
#include "support/thrown.hpp"

namespace kinecal {
namespace {

using namespace detail;

using testing::ElementsAre;
using testing::HasSubstr;

std::vector<std::string> field_names(const MessageType& type) {
  std::vector<std::string> names;
  for (const MessageField& field : type.fields) names.push_back(field.name);
  return names;
}

/// What is thrown for a text.
std::string refusal(const std::string& text) {
  return test::thrown<DefinitionError>([&] { (void)parse_definition("a/Type", text); }, "nothing");
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

TEST(Definition, MayHaveAHeaderOfItsPackageAndLackTheTimesOfRos2) {
  const MessageDefinition d = parse_definition("a/msg/Type",
                                               "Header header\nstd_msgs/Header other\n"
                                               "===\nMSG: a/Header\nint8 own\n===\n"
                                               "MSG: std_msgs/Header\n"
                                               "builtin_interfaces/Time stamp\n"
                                               "builtin_interfaces/msg/Duration since\n");
  ASSERT_EQ(d.size(), 5u);
  EXPECT_THAT(field_names(d[1]), ElementsAre("own"));
  EXPECT_THAT(field_names(d[2]), ElementsAre("stamp", "since"));
  EXPECT_THAT(field_names(d[3]), ElementsAre("sec", "nanosec"));
  EXPECT_THAT(field_names(d[4]), ElementsAre("sec", "nanosec"));
}

TEST(Definition, SaysWhatIsWrongWithIt) {
  EXPECT_THAT(refusal("float64 x\nOther other\n"), HasSubstr("'a/Other' is used but not defined"));
  EXPECT_THAT(refusal("float64\n"), HasSubstr("line 1: 'float64' has no name"));
  EXPECT_THAT(refusal("float64[x] y\n"), HasSubstr("line 1: '[x]' is not the size of a list"));
  EXPECT_THAT(refusal("float64[0] y\n"), HasSubstr("line 1: '[0]' is not the size of a list"));
  EXPECT_THAT(refusal("float64[3 y\n"), HasSubstr("is not the size of a list"));
  EXPECT_THAT(refusal("float64[99999999999] y\n"), HasSubstr("is not the size of a list"));
  EXPECT_THAT(refusal("\nwstring y\n"), HasSubstr("line 2: wide strings"));
  EXPECT_THAT(refusal("Type again\n"), HasSubstr("contains itself"));
  EXPECT_THAT(refusal("B b\n===\nMSG: a/B\nC c\n===\nMSG: a/C\nB b\n"),
              HasSubstr("contains itself"));
}

TEST(Definition, NeitherCommentsNorValuesAreNames) {
  EXPECT_THAT(refusal("float64 # comment\n"), HasSubstr("line 1: 'float64 # comment' has no name"));
  const MessageDefinition d = parse_definition("a/Type",
                                               "string HASH=a # is no comment = b\n"
                                               "string<=10 BOUNDED = \"x\"\n"
                                               "string first \"a = b # c\"\n"
                                               "float64[] second [1.0, 2.0]  # and so on\n"
                                               "string<=10[<=3] third#four\n"
                                               "string<=10[3]\tfourth\n"
                                               "byte fifth\n"
                                               "char[2] sixth\n");
  EXPECT_THAT(field_names(d[0]),
              ElementsAre("first", "second", "third", "fourth", "fifth", "sixth"));
  EXPECT_EQ(d[0].fields[2].type, FieldType::text);
  EXPECT_EQ(d[0].fields[2].count, MessageField::Count::any);
  EXPECT_EQ(d[0].fields[3].size, 3u);
}

TEST(Definition, TheFirstOfTwoCounts) {
  const MessageDefinition d = parse_definition(
      "a/Type", "B b\n===\nMSG: a/B\nint8 x\n===\nMSG: a/B\nint8 y\n===\nMSG: a/Type\nint8 z\n");
  EXPECT_THAT(field_names(d[0]), ElementsAre("b"));
  EXPECT_THAT(field_names(d[1]), ElementsAre("x"));
}

/// Each type has the one after it as two fields: 2^count of them in all.
std::string doubling(int count) {
  std::string text;
  for (int i = 0; i < count; ++i) {
    const std::string next = fmt::format("T{}", i + 1);
    text += fmt::format("{} one\n{} two\n===\nMSG: a/{}\n", next, next, next);
  }
  return text + "int8 x\n";
}

TEST(Definition, OfTypesThatDoubleEachTimeTakesNoLonger) {
  EXPECT_EQ(parse_definition("a/Type", doubling(31)).size(), 32u);
}

TEST(Definition, IsNotDeeperThanItsReaderMayGo) {
  EXPECT_THAT(refusal(doubling(32)), HasSubstr("'a/Type' is nested too deeply"));
  // Each type is read early on, within few others; together they would be as deep as they are many.
  std::string text, parts;
  for (int i = 200; i > 0; --i) text += fmt::format("T{} t{}\n", i, i);
  for (int i = 1; i < 200; ++i) parts += fmt::format("===\nMSG: a/T{}\nT{} t\n", i + 1, i);
  EXPECT_THAT(refusal(text + parts + "===\nMSG: a/T1\nint8 x\n"), HasSubstr("too deeply"));
  text.clear();
  for (int i = 1; i <= 200; ++i) text += fmt::format("T{} t{}\n", i, i);
  EXPECT_THAT(refusal(text + parts + "===\nMSG: a/T1\nint8 x\n"),
              HasSubstr("'a/T33' is nested too deeply"));
}

TEST(Definition, HasNoMoreTextThanIsPlausible) {
  EXPECT_THAT(refusal(std::string(kMostOfADefinition + 1, '\n')),
              HasSubstr("it has 1048577 bytes; at most 1048576 are read"));
}

TEST(Definition, OfAllKnownMessagesIsComplete) {
  for (const Encoding encoding : {Encoding::ros1, Encoding::cdr}) {
    for (const KnownMessage& known : kKnownMessages) {
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
