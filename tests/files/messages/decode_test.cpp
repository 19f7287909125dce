#include "kinecal/files/messages/decode.hpp"

#include <fastcdr/Cdr.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "kinecal/files/messages/encode.hpp"
#include "kinecal/files/messages/known_definitions.hpp"
#include "support/thrown.hpp"

namespace kinecal {
namespace {

using namespace detail;

const MessageDefinition kEverything = parse_definition("a/Everything",
                                                       "bool flag\n"
                                                       "int8 a\n"
                                                       "uint16 b\n"
                                                       "int64 c\n"
                                                       "string text\n"
                                                       "float32 d\n"
                                                       "float64 e\n"
                                                       "uint8[] bytes\n"
                                                       "float64[2] pair\n"
                                                       "string[] names\n"
                                                       "Point[] points\n"
                                                       "uint32 last\n"
                                                       "===\nMSG: a/Point\n"
                                                       "uint8 kind\n"
                                                       "float64 x\n");

double number(const MessageFields& fields, std::string_view name) {
  double result = -1.0;
  fields.find(name)->visit_number([&](auto x) { result = static_cast<double>(x); });
  return result;
}

void expect_everything(const MessageFields& value) {
  EXPECT_EQ(number(value, "flag"), 1.0);
  EXPECT_EQ(number(value, "a"), -3.0);
  EXPECT_EQ(number(value, "b"), 65000.0);
  EXPECT_EQ(*value.find("c")->as<std::int64_t>(), -9007199254740993);  // no double is this
  EXPECT_EQ(*value.find("text")->as<std::string_view>(), "seven c");
  EXPECT_EQ(number(value, "d"), 0.25);
  EXPECT_EQ(number(value, "e"), -1e300);
  const Bytes bytes = *value.find("bytes")->as<Bytes>();
  ASSERT_EQ(bytes.size(), 3u);
  EXPECT_EQ(std::to_integer<int>(bytes[2]), 255);
  EXPECT_EQ(*(*value.find("pair")->as<MessageValue::List>())[1].as<double>(), 2.5);
  const auto& names = *value.find("names")->as<MessageValue::List>();
  ASSERT_EQ(names.size(), 2u);
  EXPECT_EQ(*names[0].as<std::string_view>(), "");
  EXPECT_EQ(*names[1].as<std::string_view>(), "pan");
  const auto& points = *value.find("points")->as<MessageValue::List>();
  ASSERT_EQ(points.size(), 2u);
  EXPECT_EQ(number(*points[1].as<MessageFields>(), "kind"), 8.0);
  EXPECT_EQ(number(*points[1].as<MessageFields>(), "x"), 0.125);
  EXPECT_EQ(number(value, "last"), 4294967295.0);
}

/// The same message by another implementation of CDR.
std::vector<char> by_the_oracle(eprosima::fastcdr::Cdr::Endianness order) {
  eprosima::fastcdr::FastBuffer buffer;
  eprosima::fastcdr::Cdr cdr(buffer, order, eprosima::fastcdr::Cdr::DDS_CDR);
  cdr.serialize_encapsulation();
  cdr << true << std::int8_t{-3} << std::uint16_t{65000} << std::int64_t{-9007199254740993}
      << std::string("seven c") << 0.25f << -1e300 << std::vector<std::uint8_t>{1, 2, 255} << 1.5
      << 2.5 << std::vector<std::string>{"", "pan"} << std::uint32_t{2} << std::uint8_t{7} << 0.5
      << std::uint8_t{8} << 0.125 << std::uint32_t{4294967295};
  return {buffer.getBuffer(), buffer.getBuffer() + cdr.getSerializedDataLength()};
}

TEST(Decode, ReadsCdrOfBothOrdersOfBytesAsItWasWritten) {
  using eprosima::fastcdr::Cdr;
  for (const auto order : {Cdr::LITTLE_ENDIANNESS, Cdr::BIG_ENDIANNESS}) {
    const std::vector<char> bytes = by_the_oracle(order);
    expect_everything(decode(kEverything, Encoding::cdr, std::as_bytes(std::span(bytes))));
  }
}

TEST(Encode, WritesCdrThatTheOracleReads) {
  const auto oracle = by_the_oracle(eprosima::fastcdr::Cdr::LITTLE_ENDIANNESS);
  const MessageFields value = decode(kEverything, Encoding::cdr, std::as_bytes(std::span(oracle)));
  std::vector<std::byte> bytes = encode(value, kEverything, Encoding::cdr);
  ASSERT_EQ(bytes.size(), oracle.size());
  eprosima::fastcdr::FastBuffer buffer(reinterpret_cast<char*>(bytes.data()), bytes.size());
  eprosima::fastcdr::Cdr cdr(buffer, eprosima::fastcdr::Cdr::LITTLE_ENDIANNESS,
                             eprosima::fastcdr::Cdr::DDS_CDR);
  cdr.read_encapsulation();
  bool flag = false;
  std::int8_t a = 0;
  std::uint16_t b = 0;
  std::int64_t c = 0;
  std::string text;
  float d = 0;
  double e = 0, first = 0, second = 0, x = 0;
  std::vector<std::uint8_t> raw;
  std::vector<std::string> names;
  std::uint32_t points = 0, last = 0;
  std::uint8_t kind = 0;
  cdr >> flag >> a >> b >> c >> text >> d >> e >> raw >> first >> second >> names >> points;
  cdr >> kind >> x >> kind >> x >> last;
  EXPECT_TRUE(flag && a == -3 && b == 65000 && c == -9007199254740993 && text == "seven c");
  EXPECT_TRUE(d == 0.25f && e == -1e300 && first == 1.5 && second == 2.5);
  EXPECT_EQ(raw, (std::vector<std::uint8_t>{1, 2, 255}));
  EXPECT_EQ(names, (std::vector<std::string>{"", "pan"}));
  EXPECT_TRUE(points == 2 && kind == 8 && x == 0.125 && last == 4294967295);
}

TEST(Encode, IsReadAgainInBothEncodings) {
  const auto oracle = by_the_oracle(eprosima::fastcdr::Cdr::BIG_ENDIANNESS);
  const MessageFields value = decode(kEverything, Encoding::cdr, std::as_bytes(std::span(oracle)));
  for (const Encoding encoding : {Encoding::ros1, Encoding::cdr}) {
    const std::vector<std::byte> bytes = encode(value, kEverything, encoding);
    expect_everything(decode(kEverything, encoding, bytes));
  }
}

TEST(Encode, TakesFieldsByNameAndLeavesOthersEmpty) {
  const MessageDefinition ros1 = parse_definition(
      "sensor_msgs/CameraInfo", known_definition("sensor_msgs/CameraInfo", Encoding::ros1));
  const MessageDefinition ros2 = parse_definition(
      "sensor_msgs/CameraInfo", known_definition("sensor_msgs/CameraInfo", Encoding::cdr));
  MessageFields stamp, header, camera;
  stamp.fields = {{"secs", std::uint64_t{17}}, {"nsecs", std::uint64_t{5}}};
  header.fields = {{"seq", std::uint64_t{3}}, {"stamp", stamp}, {"frame_id", "optical"}};
  camera.fields = {{"header", header}, {"D", MessageValue::List{0.5, 0.25}}};
  const std::vector<std::byte> one = encode(camera, ros1, Encoding::ros1);
  const std::vector<std::byte> two = encode(decode(ros1, Encoding::ros1, one), ros2, Encoding::cdr);
  const MessageFields read = decode(ros2, Encoding::cdr, two);
  const MessageFields& head = *read.find("header")->as<MessageFields>();
  EXPECT_EQ(head.find("seq"), nullptr);
  EXPECT_EQ(number(*head.find("stamp")->as<MessageFields>(), "sec"), 17.0);
  EXPECT_EQ(*head.find("frame_id")->as<std::string_view>(), "optical");
  EXPECT_EQ(read.find("d")->as<MessageValue::List>()->size(), 2u);
  EXPECT_EQ(read.find("p")->as<MessageValue::List>()->size(), 12u);
  EXPECT_EQ(number(read, "height"), 0.0);
}

TEST(Decode, RefusesMessagesThatAreCutOffAtAnyByte) {
  const auto oracle = by_the_oracle(eprosima::fastcdr::Cdr::LITTLE_ENDIANNESS);
  const MessageFields value = decode(kEverything, Encoding::cdr, std::as_bytes(std::span(oracle)));
  for (const Encoding encoding : {Encoding::ros1, Encoding::cdr}) {
    const std::vector<std::byte> bytes = encode(value, kEverything, encoding);
    for (std::size_t size = 0; size < bytes.size(); ++size) {
      EXPECT_THROW((void)decode(kEverything, encoding, Bytes(bytes).first(size)), BytesError)
          << size;
    }
  }
}

TEST(Decode, RefusesLengthsBeyondTheBytesAndOtherCdr) {
  const MessageDefinition list = parse_definition("a/List", "float64[] x\n");
  const std::array<unsigned char, 8> huge = {0xff, 0xff, 0xff, 0xff, 0, 0, 0, 0};
  EXPECT_THROW((void)decode(list, Encoding::ros1, std::as_bytes(std::span(huge))), BytesError);
  const MessageDefinition fixed = parse_definition("a/Fixed", "float64[4000000000] x\n");
  EXPECT_THROW((void)decode(fixed, Encoding::ros1, std::as_bytes(std::span(huge))), BytesError);
  const std::array<unsigned char, 8> parameters = {0, 3, 0, 0, 0, 0, 0, 0};
  EXPECT_THROW((void)decode(list, Encoding::cdr, std::as_bytes(std::span(parameters))), BytesError);
}

TEST(Decode, SaysWhichCdrItCannotRead) {
  const MessageDefinition definition = parse_definition("a/B", "int8 x\n");
  const auto refusal = [&](unsigned char kind) -> std::string {
    const std::array<unsigned char, 8> bytes = {0, kind, 0, 0, 0, 0, 0, 0};
    return test::thrown<BytesError>(
        [&] { (void)decode(definition, Encoding::cdr, std::as_bytes(std::span(bytes))); }, "");
  };
  EXPECT_EQ(refusal(0), "");
  EXPECT_EQ(refusal(1), "");
  EXPECT_EQ(refusal(3),
            "byte 0: the message is PL_CDR (its first bytes are 0 3); only plain CDR can be "
            "read");
  EXPECT_THAT(refusal(7), testing::HasSubstr("is XCDR version 2"));
  EXPECT_THAT(refusal(0x28), testing::HasSubstr("is not CDR"));
}

TEST(Decode, TakesTextsOfRos2WithoutTheirNul) {
  const MessageDefinition definition = parse_definition("a/B", "string a\nstring b\nuint8 c\n");
  const std::array<unsigned char, 16> bytes = {0, 1, 0, 0, 0, 0, 0, 0, 2, 0, 0, 0, 'x', 'y', 5, 0};
  const MessageFields value = decode(definition, Encoding::cdr, std::as_bytes(std::span(bytes)));
  EXPECT_EQ(*value.find("a")->as<std::string_view>(), "");
  EXPECT_EQ(*value.find("b")->as<std::string_view>(), "xy");
  EXPECT_EQ(number(value, "c"), 5.0);
}

TEST(Decode, RefusesManyItemsThatTakeNoBytes) {
  const MessageDefinition nothings =
      parse_definition("a/List", "Nothing[] all\n===\nMSG: a/Nothing\nuint8 CONSTANT=1\n");
  std::vector<std::byte> bytes(4 + 1001);
  bytes[0] = std::byte{3};
  const MessageFields three = decode(nothings, Encoding::ros1, bytes);
  EXPECT_EQ(three.find("all")->as<MessageValue::List>()->size(), 3u);
  bytes[0] = std::byte{1001 % 256}, bytes[1] = std::byte{1001 / 256};
  EXPECT_THROW((void)decode(nothings, Encoding::ros1, bytes), BytesError);
  std::string text;  // 2^20 of them in no bytes at all
  for (int i = 0; i < 20; ++i) {
    const std::string next = "T" + std::to_string(i + 1);
    text += next + " one\n" + next + " two\n===\nMSG: a/" + next + "\n";
  }
  EXPECT_THROW((void)decode(parse_definition("a/T0", text), Encoding::ros1, {}), BytesError);
}

/// A value takes some 32 bytes of memory.
TEST(Decode, RefusesMoreValuesThanAMessageHas) {
  const MessageDefinition list = parse_definition("a/List", "bool[] all\n");
  constexpr std::uint32_t kMost = 1 << 20;
  std::vector<std::byte> bytes(4 + kMost + 1);
  std::memcpy(bytes.data(), &kMost, 4);
  EXPECT_EQ(decode(list, Encoding::ros1, bytes).find("all")->as<MessageValue::List>()->size(),
            kMost);
  const std::uint32_t more = kMost + 1;
  std::memcpy(bytes.data(), &more, 4);
  EXPECT_THROW((void)decode(list, Encoding::ros1, bytes), BytesError);
}

}  // namespace
}  // namespace kinecal
