// Definitions of bridge_client.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/robots/bridge_client.hpp"

#include <algorithm>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <iterator>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "kinecal/capture/robot_interface.hpp"
#include "kinecal/files/messages/decode.hpp"
#include "kinecal/files/messages/encode.hpp"
#include "kinecal/files/messages/known_definitions.hpp"
#include "kinecal/robots/action_definitions.ipp"
#include "kinecal/robots/bridge_frames.hpp"
#include "kinecal/text/nearest_name.hpp"
#include "kinecal/text/printable.hpp"

namespace kinecal::detail {

// The definition of a bridge's messages.

/// The form of messages of a topic or service.
/// @param name       of the topic or service
/// @param encodings  of services, as announced by the bridge
/// @throws std::runtime_error  if kinecal cannot read the form, or the definition is invalid
[[nodiscard]] inline BridgeMessage message_form(const std::string& name, const BridgeSchema& schema,
                                                const std::vector<std::string>& encodings) {
  std::string encoding = schema.encoding;
  if (encoding.empty()) {  // of a service, in older bridges
    const auto has = [&](const char* e) {
      return std::find(encodings.begin(), encodings.end(), e) != encodings.end();
    };
    encoding = has("ros1") && !has("cdr") ? "ros1" : "cdr";
  }
  if (encoding != "ros1" && encoding != "cdr") {
    throw std::runtime_error("its messages are '" + printable(encoding) +
                             "'; expected ros1 or cdr, as bridges of ROS send");
  }
  BridgeMessage form;
  form.name = name;
  form.type = schema.type;
  form.encoding = encoding == "ros1" ? Encoding::ros1 : Encoding::cdr;
  const bool is_text = schema.definition_kind.empty() || schema.definition_kind == "ros1msg" ||
                       schema.definition_kind == "ros2msg";
  std::string text = is_text ? schema.definition : std::string();
  if (text.empty()) text = known_definition(schema.type, form.encoding);
  if (text.empty()) text = action_definition(schema.type);
  if (text.empty() && !is_text) {
    throw std::runtime_error("its definition is '" + printable(schema.definition_kind) +
                             "'; expected the text of a .msg file");
  }
  try {
    form.definition =
        std::make_shared<const MessageDefinition>(parse_definition(schema.type, text));
  } catch (const DefinitionError& error) {
    throw std::runtime_error("the definition of '" + printable(schema.type) +
                             "' cannot be read: " + error.what());
  }
  return form;
}

// What a bridge has announced and sent; shared by two threads (bridge_client.hpp).

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
  std::map<std::string, std::uint32_t> published;                ///< ids, by topic
  std::optional<std::map<std::string, std::string>> parameters;  ///< of the last answer
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
    } else if (frame.op == "parameterValues") {
      parameters = std::move(frame.parameters);
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

MessageFields BridgeMessage::fields() const {
  try {
    return decode(*definition, encoding, as_bytes(bytes));
  } catch (const BytesError& error) {
    throw PoseError("'" + printable(name) + "' sent something that is not a " + printable(type) +
                    ": " + error.what());
  }
}

BridgeClient::BridgeClient(const BridgeOptions& options)
    : state_(std::make_unique<State>(options)) {
  State& state = *state_;
  auto socket = std::make_unique<WebSocket>(
      options, [&state](bool is_text, Bytes bytes) { state.take_frame(is_text, bytes); },
      [&state](const std::string& why) { state.take_end(why); });
  std::unique_lock lock(state.mutex);
  state.socket = std::move(socket);
  try {
    if (state.wait(lock, deadline(), [&] { return state.introduced; })) return;
  } catch (const ConnectionError&) {
    lock.unlock();
    state.socket.reset();  // its thread uses the state
    throw;
  }
  lock.unlock();
  state.socket.reset();
  throw ConnectionError("bridge '" + options.url + "': it does not introduce itself (serverInfo)");
}

BridgeClient::~BridgeClient() {
  if (state_->socket != nullptr) {
    std::unique_ptr<WebSocket> socket;
    {
      const std::lock_guard lock(state_->mutex);
      socket.swap(state_->socket);
    }
  }
}

Deadline BridgeClient::deadline() const {
  return std::chrono::steady_clock::now() + state_->options.time_limit;
}

void BridgeClient::subscribe(const std::string& topic, std::vector<std::string> types,
                             std::size_t keep) {
  const std::lock_guard lock(state_->mutex);
  const auto [known, is_new] = state_->subscriptions.try_emplace(topic);
  Subscription& wanted = known->second;
  if (!is_new) {
    if (wanted.types == types || wanted.types.empty() || types.empty()) return;
    throw ConnectionError("topic '" + topic + "' is wanted as " + wanted.types.front() +
                          " and as " + types.front() + "; which topic is the other one?");
  }
  wanted.types = std::move(types);
  wanted.keep = keep;
  for (const auto& [id, channel] : state_->channels) state_->offer(channel);
}

std::vector<BridgeMessage> BridgeClient::take(const std::string& topic, Deadline deadline) {
  std::unique_lock lock(state_->mutex);
  Subscription& wanted = state_->subscriptions.at(topic);
  state_->wait(lock, deadline,
               [&] { return !wanted.messages.empty() || !wanted.obstacle.empty(); });
  if (wanted.messages.empty() && !wanted.obstacle.empty()) {
    throw ConnectionError("bridge '" + state_->options.url + "': " + wanted.obstacle);
  }
  std::vector<BridgeMessage> all(std::make_move_iterator(wanted.messages.begin()),
                                 std::make_move_iterator(wanted.messages.end()));
  wanted.messages.clear();
  return all;
}

std::optional<std::string> BridgeClient::topic_type(const std::string& topic, Deadline deadline) {
  std::unique_lock lock(state_->mutex);
  if (!state_->wait(lock, deadline, [&] { return state_->channel_of(topic) != nullptr; })) {
    return std::nullopt;
  }
  return state_->channel_of(topic)->schema.type;
}

bool BridgeClient::wait_for(const std::string& topic, const std::string& service,
                            Deadline deadline) {
  std::unique_lock lock(state_->mutex);
  return state_->wait(lock, deadline, [&] {
    return state_->channel_of(topic) != nullptr || state_->service_of(service) != nullptr;
  });
}

bool BridgeClient::has_service(const std::string& service) const {
  const std::lock_guard lock(state_->mutex);
  return state_->service_of(service) != nullptr;
}

std::string BridgeClient::why_silent(const std::string& topic) const {
  const std::lock_guard lock(state_->mutex);
  const std::string said =
      state_->complaint.empty() ? "" : "; the bridge said: " + state_->complaint;
  if (state_->channel_of(topic) != nullptr) {
    return "no message came on topic '" + topic + "'" + said;
  }
  std::vector<std::string> names;
  for (const auto& [id, channel] : state_->channels) names.push_back(printable(channel.topic));
  return "the bridge offers no topic '" + topic + "'" + did_you_mean(topic, names) + said;
}

std::optional<std::string> BridgeClient::parameter(const std::string& name, Deadline deadline) {
  std::unique_lock lock(state_->mutex);
  const auto& can = state_->capabilities;
  if (std::find(can.begin(), can.end(), "parameters") == can.end()) return std::nullopt;
  state_->parameters.reset();
  state_->socket->send(true, parameter_frame(name));
  if (!state_->wait(lock, deadline, [&] { return state_->parameters.has_value(); })) {
    return std::nullopt;
  }
  for (const auto& [own, value] : *state_->parameters) {
    if (plain_topic(own) == plain_topic(name)) return value;
  }
  return std::nullopt;
}

void BridgeClient::publish(const std::string& topic, const PublishedType& type,
                           const MessageFields& message) {
  const std::lock_guard lock(state_->mutex);
  const auto& can = state_->capabilities;
  if (std::find(can.begin(), can.end(), "clientPublish") == can.end()) {
    throw ConnectionError("bridge '" + state_->options.url +
                          "': clients may not publish, so nothing can move; start it with the "
                          "capability clientPublish");
  }
  const auto [at, is_new] = state_->published.try_emplace(topic, state_->last_id + 1);
  const auto& known = state_->encodings;
  const auto takes = [&](const char* encoding) {
    return std::find(known.begin(), known.end(), encoding) != known.end();
  };
  const bool is_ros2 = takes("cdr") && !takes("ros1");
  if (is_new) {
    ++state_->last_id;
    BridgeSchema schema{"ros1", type.name, type.definition, "ros1msg"};
    if (is_ros2) {
      std::string ros2_type = type.name;
      ros2_type.replace(ros2_type.find('/'), 1, "/msg/");
      schema = {"cdr", ros2_type, type.definition, "ros2msg"};
    }
    state_->socket->send(true, advertise_frame(at->second, topic, schema));
  }
  const auto bytes = encode(message, parse_definition(type.name, type.definition),
                            is_ros2 ? Encoding::cdr : Encoding::ros1);
  state_->socket->send(false, publish_frame(at->second, bytes));
}

std::uint32_t BridgeClient::call(const std::string& service, const MessageFields& request) {
  const std::lock_guard lock(state_->mutex);
  const BridgeService* called = state_->service_of(service);
  if (called == nullptr) throw PoseError("the bridge offers no service '" + service + "'");
  const std::uint32_t id = ++state_->last_id;
  try {
    const BridgeMessage form = message_form(service, called->request, state_->encodings);
    state_->calls[id].response = message_form(service, called->response, state_->encodings);
    const auto bytes = encode(request, *form.definition, form.encoding);
    const char* encoding = form.encoding == Encoding::ros1 ? "ros1" : "cdr";
    state_->socket->send(false, call_frame(called->id, id, encoding, bytes));
  } catch (const std::runtime_error& error) {
    state_->calls.erase(id);
    throw PoseError("service '" + service + "': " + error.what());
  }
  return id;
}

std::optional<BridgeMessage> BridgeClient::response(std::uint32_t call, Deadline deadline) {
  std::unique_lock lock(state_->mutex);
  PendingCall& pending = state_->calls.at(call);
  if (!state_->wait(lock, deadline, [&] { return pending.is_done; })) return std::nullopt;
  const PendingCall done = std::move(pending);
  state_->calls.erase(call);
  if (!done.failure.empty()) {
    throw PoseError("service '" + done.response.name + "' failed: " + done.failure);
  }
  return done.response;
}

}  // namespace kinecal::detail
