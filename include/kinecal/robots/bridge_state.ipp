// What a bridge has announced and sent; shared by two threads (bridge_client.hpp).
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "kinecal/capture/robot_interface.hpp"
#include "kinecal/robots/bridge_client.hpp"
#include "kinecal/robots/bridge_frames.hpp"
#include "kinecal/robots/schema_definition.ipp"

namespace kinecal::detail {

/// A wanted topic and its messages.
struct Subscription {
  std::vector<std::string> types;
  std::size_t keep = 1;
  std::optional<std::uint32_t> channel;  ///< subscribed channel
  std::string obstacle;                  ///< why its messages cannot be read; empty if they can
  BridgeMessage form;                    ///< of each message, without bytes
  std::deque<BridgeMessage> messages;    ///< the newest
};

/// A service that was called.
struct PendingCall {
  BridgeMessage response;
  bool is_done = false;
  std::string failure;  ///< empty if it succeeded
};

class BridgeClient::State {
 public:
  explicit State(const BridgeOptions& bridge) : options(bridge) {}

  BridgeOptions options;
  mutable std::mutex mutex;
  std::condition_variable changed;
  bool introduced = false;
  std::string end;        ///< why the connection ended; empty while it is open
  std::string complaint;  ///< the bridge's last error status
  std::vector<std::string> capabilities, encodings;
  std::map<std::uint32_t, BridgeChannel> channels;
  std::map<std::uint32_t, BridgeService> services;
  std::map<std::string, Subscription> subscriptions;  ///< by topic
  std::map<std::uint32_t, std::string> subscribed;    ///< topics, by id of the subscription
  std::map<std::uint32_t, PendingCall> calls;
  std::map<std::string, std::uint32_t> published;  ///< ids, by topic
  std::uint32_t last_id = 0;
  std::unique_ptr<WebSocket> socket;

  /// Waits until `is_true` holds; false if it does not in time.
  template <class F>
  bool wait(std::unique_lock<std::mutex>& lock, Deadline deadline, F&& is_true) {
    changed.wait_until(lock, deadline, [&] { return !end.empty() || is_true(); });
    if (!end.empty()) throw ConnectionError(end);
    return is_true();
  }

  void take_frame(bool is_text, Bytes bytes) {
    const std::lock_guard lock(mutex);
    if (!end.empty()) return;
    try {
      if (is_text) {
        text({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
      } else {
        binary(bytes);
      }
    } catch (const std::exception& error) {
      end = "bridge '" + options.url + "': " + error.what();
    }
    changed.notify_all();
  }

  void take_end(const std::string& why) {
    const std::lock_guard lock(mutex);
    if (end.empty()) end = why + (complaint.empty() ? "" : "; it said: " + complaint);
    changed.notify_all();
  }

  [[nodiscard]] const BridgeChannel* channel_of(const std::string& topic) const {
    for (const auto& [id, channel] : channels) {
      if (plain_topic(channel.topic) == plain_topic(topic)) return &channel;
    }
    return nullptr;
  }

  [[nodiscard]] const BridgeService* service_of(const std::string& name) const {
    for (const auto& [id, service] : services) {
      if (plain_topic(service.name) == plain_topic(name)) return &service;
    }
    return nullptr;
  }

  /// Subscribes to a channel if it is a wanted one.
  void offer(const BridgeChannel& channel) {
    for (auto& [topic, wanted] : subscriptions) {
      if (wanted.channel || plain_topic(topic) != plain_topic(channel.topic)) continue;
      wanted.obstacle = obstacle(wanted, channel);
      if (!wanted.obstacle.empty()) continue;
      wanted.channel = channel.id;
      subscribed[++last_id] = topic;
      socket->send(true, subscribe_frame(last_id, channel.id));
    }
  }

 private:
  void text(std::string_view bytes) {
    TextFrame frame = parse_text_frame(bytes);
    if (frame.op == "serverInfo") {
      introduced = true;
      capabilities = std::move(frame.capabilities);
      encodings = std::move(frame.encodings);
    } else if (frame.op == "advertise") {
      for (BridgeChannel& channel : frame.channels) {
        BridgeChannel& here = channels[channel.id] = std::move(channel);
        if (socket != nullptr) offer(here);
      }
    } else if (frame.op == "advertiseServices") {
      for (BridgeService& service : frame.services) services[service.id] = std::move(service);
    } else if (frame.op == "unadvertise") {
      for (const std::uint32_t id : frame.gone) forget(id);
    } else if (frame.op == "unadvertiseServices") {
      for (const std::uint32_t id : frame.gone) services.erase(id);
    } else if (frame.op == "status" && frame.level >= 2) {
      complaint = frame.message;
    } else if (frame.op == "serviceCallFailure") {
      fail_call(frame);
    }
  }

  void forget(std::uint32_t channel) {
    channels.erase(channel);
    for (auto& [topic, wanted] : subscriptions) {
      if (wanted.channel == channel) wanted.channel.reset();
    }
  }

  void fail_call(const TextFrame& frame) {
    const auto call = calls.find(frame.call);
    if (call == calls.end()) return;
    call->second.is_done = true;
    call->second.failure = frame.message.empty() ? "it gave no reason" : frame.message;
  }

  void binary(Bytes bytes) {
    const BinaryFrame frame = parse_binary_frame(bytes);
    const std::string payload(reinterpret_cast<const char*>(frame.payload.data()),
                              frame.payload.size());
    if (frame.kind == BinaryFrame::Kind::message) {
      const auto topic = subscribed.find(frame.id);
      if (topic == subscribed.end()) return;
      Subscription& wanted = subscriptions[topic->second];
      BridgeMessage message = wanted.form;
      message.bytes = payload;
      message.arrival = std::chrono::steady_clock::now();
      wanted.messages.push_back(std::move(message));
      if (wanted.messages.size() > wanted.keep) wanted.messages.pop_front();
    } else if (frame.kind == BinaryFrame::Kind::response) {
      const auto call = calls.find(frame.id);
      if (call == calls.end()) return;
      call->second.response.bytes = payload;
      call->second.is_done = true;
    }
  }

  /// Why messages of a channel cannot be read; if they can, sets their form in `wanted`.
  [[nodiscard]] std::string obstacle(Subscription& wanted, const BridgeChannel& channel) const {
    const std::string topic = "topic '" + printable(channel.topic) + "'";
    const std::string& type = channel.schema.type;
    const auto& types = wanted.types;
    if (!types.empty() && std::find(types.begin(), types.end(), type) == types.end()) {
      std::string expected = types.front();
      for (std::size_t i = 1; i < types.size(); ++i) expected += " or " + types[i];
      return topic + " has messages of type '" + printable(type) + "'; expected " + expected;
    }
    try {
      wanted.form = message_form(channel.topic, channel.schema, encodings);
      return {};
    } catch (const std::runtime_error& error) {
      return topic + ": " + error.what();
    }
  }
};

}  // namespace kinecal::detail
