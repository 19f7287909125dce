#include "kinecal/robots/bridge_frames.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "support/error_of.hpp"

namespace kinecal::detail {
namespace {

using test::error_of;
using testing::HasSubstr;

TEST(BridgeFrames, ReadsTopicsInTheSpellingOfEitherRos) {
  const TextFrame frame = parse_text_frame(R"({"op": "advertise", "channels": [
      {"id": 3, "topic": "/j", "encoding": "cdr", "schemaName": "sensor_msgs/msg/JointState",
       "schema": "string[] name", "schemaEncoding": "ros2msg"},
      {"id": 4, "topic": "/k", "encoding": "ros1", "schemaName": "sensor_msgs/Image",
       "schema": ""}]})");
  ASSERT_EQ(frame.channels.size(), 2u);
  EXPECT_EQ(frame.channels[0].id, 3u);
  EXPECT_EQ(frame.channels[0].schema.type, "sensor_msgs/JointState");
  EXPECT_EQ(frame.channels[0].schema.definition_kind, "ros2msg");
  EXPECT_EQ(frame.channels[1].schema.type, "sensor_msgs/Image");
  EXPECT_EQ(frame.channels[1].schema.definition_kind, "");
}

TEST(BridgeFrames, ReadsServicesOfOldAndNewBridges) {
  const TextFrame frame = parse_text_frame(R"({"op": "advertiseServices", "services": [
      {"id": 1, "name": "/a", "type": "p/srv/T", "requestSchema": "bool x", "responseSchema": ""},
      {"id": 2, "name": "/b", "type": "p/action/T_SendGoal",
       "request": {"encoding": "cdr", "schemaName": "p/action/T_SendGoal_Request",
                   "schemaEncoding": "ros2msg", "schema": "bool y"}}]})");
  ASSERT_EQ(frame.services.size(), 2u);
  EXPECT_EQ(frame.services[0].request.type, "p/T_Request");
  EXPECT_EQ(frame.services[0].request.definition, "bool x");
  EXPECT_EQ(frame.services[1].request.type, "p/T_SendGoal_Request");
  EXPECT_EQ(frame.services[1].request.encoding, "cdr");
  EXPECT_EQ(frame.services[1].response.type, "p/T_SendGoal_Response");
}

TEST(BridgeFrames, AWrongFieldIsNamedWithItsPlace) {
  const auto error = [](const char* text) {
    return error_of([&] { (void)parse_text_frame(text); });
  };
  EXPECT_THAT(error(R"({"op": 3})"), HasSubstr("field 'op' is 3; expected a text"));
  EXPECT_THAT(error(R"({"op": "advertise", "channels": [{"id": 1.5}]})"),
              HasSubstr("field 'channels[0].id' is 1.5; expected a whole number"));
  EXPECT_THAT(error(R"({"op": "advertise", "channels": [{"id": 4294967296}]})"),
              HasSubstr("expected a number from 0 to 2^32 - 1"));
  EXPECT_THAT(error(R"({"op": "advertise"})"), HasSubstr("it has no field 'channels'"));
  EXPECT_THAT(error(R"({"op": "unadvertise", "channelIds": ["a"]})"),
              HasSubstr("field 'channelIds[0]' is string; expected a number"));
  EXPECT_THAT(error(R"({"op": "adv)"), HasSubstr("is not JSON"));
}

TEST(BridgeFrames, DeepNestingIsNoDanger) {
  const std::string deep(200000, '[');
  EXPECT_THAT(error_of([&] { (void)parse_text_frame(deep); }), HasSubstr("is not JSON"));
  const std::string closed = deep + std::string(deep.size(), ']');
  EXPECT_THAT(error_of([&] { (void)parse_text_frame(closed); }), HasSubstr("no field 'op'"));
}

TEST(BridgeFrames, ReadsMessagesAndResponses) {
  const std::string message("\x01\x02\0\0\0\0\0\0\0\0\0\0\0xy", 15);
  const BinaryFrame one = parse_binary_frame(as_bytes(message));
  EXPECT_EQ(one.kind, BinaryFrame::Kind::message);
  EXPECT_EQ(one.id, 2u);
  EXPECT_EQ(one.payload.size(), 2u);
  const std::string response("\x03\x07\0\0\0\x05\0\0\0\x03\0\0\0cdrz", 17);
  const BinaryFrame two = parse_binary_frame(as_bytes(response));
  EXPECT_EQ(two.kind, BinaryFrame::Kind::response);
  EXPECT_EQ(two.id, 5u);
  EXPECT_EQ(two.payload.size(), 1u);
}

TEST(BridgeFrames, EveryCutBinaryFrameIsRefused) {
  const std::string message(13, '\x01');
  const std::string response("\x03\x07\0\0\0\x05\0\0\0\x03\0\0\0cdr", 16);
  for (const std::string& whole : {message, response}) {
    EXPECT_NO_THROW((void)parse_binary_frame(as_bytes(whole)));
    for (std::size_t n = 0; n < whole.size(); ++n) {
      EXPECT_THROW((void)parse_binary_frame(as_bytes(whole).first(n)), FrameError) << n;
    }
  }
}

TEST(BridgeFrames, WritesWhatTheProtocolAsks) {
  EXPECT_EQ(subscribe_frame(3, 8),
            R"({"op":"subscribe","subscriptions":[{"id":3,"channelId":8}]})");
  EXPECT_EQ(advertise_frame(1, "/a\"b", {"ros1", "p/T", "int8 x\n", "ros1msg"}),
            R"({"op":"advertise","channels":[{"id":1,"topic":"/a\"b","encoding":"ros1",)"
            R"("schemaName":"p/T","schema":"int8 x\n","schemaEncoding":"ros1msg"}]})");
  EXPECT_EQ(publish_frame(258, as_bytes("x")), std::string("\x01\x02\x01\0\0x", 6));
  EXPECT_EQ(call_frame(1, 2, "cdr", as_bytes("x")),
            std::string("\x02\x01\0\0\0\x02\0\0\0\x03\0\0\0cdrx", 17));
}

}  // namespace
}  // namespace kinecal::detail
