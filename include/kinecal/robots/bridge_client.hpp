// A client of a Foxglove bridge: topics and services by name.
//
// A bridge serves the topics and services of ROS 1 and ROS 2 over a WebSocket.  A thread keeps the
// newest messages of each subscribed topic, so a caller after a minute does not get old ones.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "kinecal/files/bags/bag.hpp"
#include "kinecal/files/messages/definition.hpp"
#include "kinecal/files/messages/value.hpp"
#include "kinecal/robots/socket/web_socket.hpp"

namespace kinecal::detail {

/// Latest time for an event.
using Deadline = std::chrono::steady_clock::time_point;

/// A message or a service's response, as bytes.
struct BridgeMessage {
  std::string name;                                     ///< of the topic or service
  std::string type;                                     ///< "sensor_msgs/JointState"
  std::shared_ptr<const MessageDefinition> definition;  ///< of the type
  Encoding encoding = Encoding::ros1;
  std::string bytes;
  Deadline arrival;  ///< time of arrival

  /// Its fields: views of this message.
  /// @throws PoseError  naming the topic, if the bytes are not such a message
  [[nodiscard]] MessageFields fields() const;
};

/// A type that a client publishes, with its definition.
struct PublishedType {
  std::string name;        ///< "control_msgs/FollowJointTrajectoryActionGoal"
  std::string definition;  ///< .msg text: of ROS 1, or the same in both
};

/// A connection to a bridge.  Not thread-safe.  All functions throw ConnectionError with the reason
/// once the connection has ended.
class BridgeClient {
 public:
  /// @throws ConnectionError        like WebSocket, or if the bridge does not introduce itself
  /// @throws std::invalid_argument  like parse_address()
  explicit BridgeClient(const BridgeOptions& options);
  BridgeClient(const BridgeClient&) = delete;
  BridgeClient& operator=(const BridgeClient&) = delete;
  ~BridgeClient();

  /// The deadline for an event, from now.
  [[nodiscard]] Deadline deadline() const;

  /// Keeps the newest messages of a topic from now on, even if it appears later or again.
  /// @param types  accepted types, such as sensor_msgs/JointState; empty: any
  /// @param keep   number of messages
  void subscribe(const std::string& topic, std::vector<std::string> types, std::size_t keep);

  /// The messages of a subscribed topic since the last call, oldest first; waits for at least one.
  /// @return  empty if none comes in time
  /// @throws ConnectionError  if the topic's type is not accepted, or kinecal cannot read the
  ///                          encoding of its messages
  [[nodiscard]] std::vector<BridgeMessage> take(const std::string& topic, Deadline deadline);

  /// The type of a topic, once it appears; nullopt if it does not in time.
  [[nodiscard]] std::optional<std::string> topic_type(const std::string& topic, Deadline deadline);
  /// True if a topic or a service appears in time.
  [[nodiscard]] bool wait_for(const std::string& topic, const std::string& service,
                              Deadline deadline);
  [[nodiscard]] bool has_service(const std::string& service) const;

  /// Why a topic is silent: "the bridge offers no topic '/jonit_states'; did you mean
  /// '/joint_states'?"
  [[nodiscard]] std::string why_silent(const std::string& topic) const;

  /// A parameter of ROS that is a text; nullopt if the bridge has none of this name, or does not tell in time.
  [[nodiscard]] std::optional<std::string> parameter(const std::string& name, Deadline deadline);

  /// Publishes a message, in ROS 2 if the bridge takes only that.
  /// @throws ConnectionError  if the bridge does not accept messages from clients
  void publish(const std::string& topic, const PublishedType& type, const MessageFields& message);

  /// Calls a service, without waiting.  Skips fields that its request does not have.
  /// @return  number of the call
  /// @throws PoseError  if the bridge does not offer it, or its definition cannot be read
  [[nodiscard]] std::uint32_t call(const std::string& service, const MessageFields& request);

  /// The response to a call; nullopt if none comes in time.
  /// @throws PoseError  if the service failed
  [[nodiscard]] std::optional<BridgeMessage> response(std::uint32_t call, Deadline deadline);

 private:
  class State;
  std::unique_ptr<State> state_;
};

}  // namespace kinecal::detail
