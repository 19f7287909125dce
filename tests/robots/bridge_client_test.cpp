// A bridge that misbehaves: the session ends with a sentence.
#include "kinecal/robots/bridge_client.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <string>
#include <vector>

#include "kinecal/files/messages/make.hpp"
#include "kinecal/files/messages/message_fields.hpp"
#include "support/bridge_server.hpp"
#include "support/error_of.hpp"

namespace kinecal::detail {
namespace {

using test::error_of;
using testing::AllOf;
using testing::HasSubstr;

BridgeOptions options_for(const test::BridgeServer& server) {
  BridgeOptions options;
  options.url = server.url();
  options.time_limit = std::chrono::seconds(30);  // nobody waits for it where the bridge speaks
  return options;
}

/// What a client throws after a fault of the bridge.
std::string error_after(const std::string& fault) {
  test::BridgeServer server;
  BridgeClient client(options_for(server));
  client.subscribe("/camera/image", {}, 1);
  if (client.take("/camera/image", client.deadline()).empty()) return "no images";
  server.make(fault);
  return error_of([&] {
    for (int i = 0; i < 100; ++i) (void)client.take("/camera/image", client.deadline());
  });
}

TEST(BridgeClient, GarbageEndsTheSessionWithASentence) {
  KINECAL_NEEDS_BRIDGE_SERVER();
  const auto is_error = [](const char* what) {
    return AllOf(HasSubstr("connection: bridge 'ws://127.0.0.1:"), HasSubstr(what));
  };
  EXPECT_THAT(error_after(R"({"fault": "text", "text": "%\u0007%"})"),
              is_error("a text frame cannot be read: '%\\x07%' is not JSON"));
  EXPECT_THAT(error_after(R"({"fault": "text", "text": "[1]"})"), is_error("has no field 'op'"));
  EXPECT_THAT(error_after(R"({"fault": "text", "text": "{\"op\": \"unadvertise\"}"})"),
              is_error("it has no field 'channelIds'"));
  EXPECT_THAT(error_after(R"({"fault": "binary", "bytes": [1, 0, 0]})"),
              is_error("a binary frame of 3 bytes cannot be read"));
  EXPECT_THAT(error_after(R"({"fault": "binary", "bytes": []})"),
              is_error("a binary frame of 0 bytes cannot be read"));
  EXPECT_THAT(error_after(R"({"fault": "raw", "bytes": [255, 255, 255, 255]})"),
              is_error("the connection ended"));
}

TEST(BridgeClient, AFrameOfTwoGigabytesIsRefusedBeforeItIsSent) {
  KINECAL_NEEDS_BRIDGE_SERVER();
  EXPECT_THAT(error_after(R"({"fault": "big"})"),
              HasSubstr("it sent a frame of more than 256 MiB, the limit"));
}

TEST(BridgeClient, WhatItDoesNotNeedIsIgnored) {
  KINECAL_NEEDS_BRIDGE_SERVER();
  test::BridgeServer server;
  BridgeClient client(options_for(server));
  client.subscribe("/camera/image", {"sensor_msgs/Image"}, 2);
  for (const char* const fault :
       {R"({"fault": "binary", "bytes": [2, 0, 0, 0, 0, 0, 0, 0, 0]})",
        R"({"fault": "binary", "bytes": [77]})",
        R"({"fault": "text", "text": "{\"op\": \"new\"}"})",
        R"({"fault": "binary", "bytes": [1, 255, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 5]})",
        R"({"fault": "binary", "bytes": [3, 1, 0, 0, 0, 9, 0, 0, 0, 0, 0, 0, 0, 5]})"}) {
    server.make(fault);
  }
  for (int i = 0; i < 10; ++i) {
    EXPECT_FALSE(client.take("/camera/image", client.deadline()).empty());
  }
}

TEST(BridgeClient, KeepsTheNewestMessages) {
  KINECAL_NEEDS_BRIDGE_SERVER();
  test::BridgeServer server;
  BridgeClient client(options_for(server));
  client.subscribe("/camera/image", {"sensor_msgs/Image"}, 2);
  client.subscribe("/camera/camera_info", {}, 1000);
  std::vector<Stamp> looks;  // of each one the bridge sends the image first, then the camera_info
  while (looks.size() < 5) {
    for (const BridgeMessage& info : client.take("/camera/camera_info", client.deadline())) {
      looks.push_back(header_stamp(info.fields()));
    }
  }
  const auto images = client.take("/camera/image", client.deadline());
  ASSERT_EQ(images.size(), 2u);
  EXPECT_GE(header_stamp(images[0].fields()), looks[looks.size() - 2]);
  EXPECT_GE(header_stamp(images[1].fields()), looks.back());
  EXPECT_LE(images[0].arrival, images[1].arrival);
  EXPECT_EQ(images[1].type, "sensor_msgs/Image");
}

TEST(BridgeClient, WhatTheBridgeComplainsOfIsReported) {
  KINECAL_NEEDS_BRIDGE_SERVER();
  test::BridgeServer server;
  BridgeClient client(options_for(server));
  server.make(R"({"fault": "status", "message": "the robot is on fire"})");
  client.subscribe("/none", {}, 1);
  EXPECT_TRUE(
      client.take("/none", std::chrono::steady_clock::now() + std::chrono::milliseconds(300))
          .empty());
  EXPECT_THAT(client.why_silent("/none"),
              AllOf(HasSubstr("offers no topic '/none'"), HasSubstr("the robot is on fire")));
}

TEST(BridgeClient, ABridgeThatDoesNotIntroduceItselfIsNamed) {
  KINECAL_NEEDS_BRIDGE_SERVER();
  const test::BridgeServer server(R"({"mute": true})");
  BridgeOptions options = options_for(server);
  options.time_limit = std::chrono::milliseconds(300);
  EXPECT_THAT(error_of([&] { BridgeClient client(options); }),
              HasSubstr("it does not introduce itself"));
}

TEST(BridgeClient, ABridgeThatTakesNoMessagesIsNamedWithWhatToDo) {
  KINECAL_NEEDS_BRIDGE_SERVER();
  test::BridgeServer server(R"({"capabilities": []})");
  BridgeClient client(options_for(server));
  EXPECT_THAT(error_of([&] {
                client.publish("/a", {"std_msgs/String", "string data\n"},
                               fields("data", std::string_view("x")));
              }),
              AllOf(HasSubstr("connection: "), HasSubstr("clientPublish")));
}

TEST(BridgeClient, AServiceThatFailsOrIsMissingSkipsThePose) {
  KINECAL_NEEDS_BRIDGE_SERVER();
  test::BridgeServer server(R"({"encoding": "cdr"})");
  BridgeClient client(options_for(server));
  EXPECT_THAT(error_of([&] { (void)client.call("/none", {}); }),
              HasSubstr("pose: the bridge offers no service '/none'"));
  const std::string service = "/arm_controller/follow_joint_trajectory/_action/send_goal";
  ASSERT_TRUE(client.wait_for("", service, client.deadline()));
  const std::uint32_t call = client.call(service, {});  // a goal without points
  EXPECT_THAT(error_of([&] { (void)client.response(call, client.deadline()); }),
              AllOf(HasSubstr("pose: service '" + service + "' failed: "), HasSubstr("TypeError")));
}

}  // namespace
}  // namespace kinecal::detail
