// The frames of the Foxglove WebSocket protocol that a client needs.
//
// Text frames are JSON objects with a field "op"; binary frames begin with one byte of that name.
// Numbers in binary frames are little endian.
// Source: foxglove/ws-protocol, docs/spec.md.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "kinecal/files/bags/bytes.hpp"

namespace kinecal::detail {

/// An invalid frame, with the reason.
struct FrameError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Encoding, type and definition of messages.
struct BridgeSchema {
  std::string encoding;         ///< of messages: "ros1", "cdr", ...
  std::string type;             ///< "sensor_msgs/JointState", also for the spelling of ROS 2
  std::string definition = {};  ///< text; empty if the bridge does not know it
  std::string definition_kind =
      {};  ///< "ros1msg", "ros2msg", ...; empty if it follows the encoding
};

/// A topic that the bridge offers.
struct BridgeChannel {
  std::uint32_t id = 0;
  std::string topic;
  BridgeSchema schema;
};

/// A service that the bridge offers.
struct BridgeService {
  std::uint32_t id = 0;
  std::string name;
  BridgeSchema request;
  BridgeSchema response;
};

/// A text frame.  `op` decides which fields are filled; frames of other kinds have only `op`.
struct TextFrame {
  std::string op;
  std::vector<std::string> capabilities;  ///< serverInfo
  std::vector<std::string> encodings;     ///< serverInfo
  std::vector<BridgeChannel> channels;    ///< advertise
  std::vector<BridgeService> services;    ///< advertiseServices
  std::vector<std::uint32_t> gone;        ///< unadvertise, unadvertiseServices: ids
  int level = 0;                          ///< status: 0 information, 1 warning, 2 error
  std::string message;                    ///< status, serviceCallFailure
  std::uint32_t call = 0;                 ///< serviceCallFailure
  /// parameterValues: those that are texts, by name
  std::map<std::string, std::string> parameters = {};
};

/// A binary frame: a message of a topic, or the response of a service.
struct BinaryFrame {
  enum class Kind : std::uint8_t { message, response, other };

  Kind kind = Kind::other;
  std::uint32_t id = 0;  ///< of the subscription, or of the call
  Bytes payload;         ///< a view of the frame
};

/// @throws FrameError  if it is not JSON, or a field is missing or has the wrong type; also if this
///                     build lacks a JSON library
[[nodiscard]] TextFrame parse_text_frame(std::string_view text);

/// @throws FrameError  if it is too short
[[nodiscard]] BinaryFrame parse_binary_frame(Bytes bytes);

/// Subscribes to a channel.
[[nodiscard]] std::string subscribe_frame(std::uint32_t subscription, std::uint32_t channel);

/// Announces a topic on which the client publishes.
[[nodiscard]] std::string advertise_frame(std::uint32_t id, const std::string& topic,
                                          const BridgeSchema& schema);

/// Asks for the value of a parameter of ROS.
[[nodiscard]] std::string parameter_frame(const std::string& name);

/// A message on such a topic (binary).
[[nodiscard]] std::string publish_frame(std::uint32_t id, Bytes message);

/// Calls a service (binary).
[[nodiscard]] std::string call_frame(std::uint32_t service, std::uint32_t call,
                                     std::string_view encoding, Bytes request);

}  // namespace kinecal::detail
