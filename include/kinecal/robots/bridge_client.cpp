// Definitions of bridge_client.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/robots/bridge_client.hpp"

#include <algorithm>
#include <iterator>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "kinecal/capture/robot_interface.hpp"
#include "kinecal/files/messages/decode.hpp"
#include "kinecal/files/messages/encode.hpp"
#include "kinecal/robots/bridge_state.ipp"
#include "kinecal/text/nearest_name.hpp"

namespace kinecal::detail {

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
  if (is_new) {
    ++state_->last_id;
    const BridgeSchema schema{"ros1", type.name, type.definition, "ros1msg"};
    state_->socket->send(true, advertise_frame(at->second, topic, schema));
  }
  const auto bytes = encode(message, parse_definition(type.name, type.definition), Encoding::ros1);
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
