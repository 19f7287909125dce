// Definitions of bridge_frames.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/robots/bridge_frames.hpp"

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "kinecal/files/bags/bag.hpp"
#include "kinecal/files/json/json_text.hpp"
#include "kinecal/files/json/json_value.hpp"
#include "kinecal/text/printable.hpp"

namespace kinecal::detail {

/// "control_msgs/action/X" of ROS 2 becomes "control_msgs/X".
[[nodiscard]] inline std::string without_kind(const std::string& type) {
  const std::size_t first = type.find('/');
  const std::size_t last = type.rfind('/');
  return first == last ? type : type.substr(0, first) + type.substr(last);
}

[[nodiscard]] inline BridgeChannel channel_of(const JsonValue& json) {
  BridgeChannel channel;
  channel.id = json.id("id");
  channel.topic = json.text("topic");
  channel.schema = {json.text("encoding"), without_kind(json.text("schemaName")),
                    json.text("schema"), json.text_or("schemaEncoding", {})};
  return channel;
}

/// Older bridges send only the texts of the definitions.
[[nodiscard]] inline BridgeSchema service_schema(const JsonValue& json, const std::string& field,
                                                 const std::string& type) {
  if (const auto part = json.find(field)) {
    return {part->text_or("encoding", {}), without_kind(part->text_or("schemaName", type)),
            part->text_or("schema", {}), part->text_or("schemaEncoding", {})};
  }
  return {{}, type, json.text_or(field + "Schema", {}), {}};
}

[[nodiscard]] inline BridgeService service_of(const JsonValue& json) {
  const std::string type = without_kind(json.text("type"));
  return {json.id("id"), json.text("name"), service_schema(json, "request", type + "_Request"),
          service_schema(json, "response", type + "_Response")};
}

[[nodiscard]] inline std::vector<std::uint32_t> ids_of(const JsonValue& json,
                                                       const std::string& field) {
  std::vector<std::uint32_t> ids;
  for (const JsonValue& id : json.list(field)) ids.push_back(id.as_id());
  return ids;
}

TextFrame parse_text_frame(std::string_view text) {
  try {
    const JsonValue json = JsonValue::parse(text);
    TextFrame frame;
    frame.op = json.text("op");
    if (frame.op == "serverInfo") {
      if (json.find("capabilities")) frame.capabilities = json.texts("capabilities");
      if (json.find("supportedEncodings")) frame.encodings = json.texts("supportedEncodings");
    } else if (frame.op == "advertise") {
      for (const JsonValue& c : json.list("channels")) frame.channels.push_back(channel_of(c));
    } else if (frame.op == "advertiseServices") {
      for (const JsonValue& s : json.list("services")) frame.services.push_back(service_of(s));
    } else if (frame.op == "unadvertise") {
      frame.gone = ids_of(json, "channelIds");
    } else if (frame.op == "unadvertiseServices") {
      frame.gone = ids_of(json, "serviceIds");
    } else if (frame.op == "status") {
      frame.level = static_cast<int>(json.number("level"));
      frame.message = printable(json.text("message"));
    } else if (frame.op == "parameterValues") {
      for (const JsonValue& parameter : json.list("parameters")) {
        const auto value = parameter.find("value");
        if (value && value->is_text()) frame.parameters[parameter.text("name")] = value->as_text();
      }
    } else if (frame.op == "serviceCallFailure") {
      frame.call = json.id("callId");
      frame.message = printable(json.text_or("message", {}));
    }
    return frame;
  } catch (const JsonError& error) {
    throw FrameError(std::string("a text frame cannot be read: ") + error.what());
  }
}

BinaryFrame parse_binary_frame(Bytes bytes) {
  constexpr std::uint8_t kMessage = 1, kResponse = 3;
  try {
    ByteReader reader(bytes);
    const auto op = reader.number<std::uint8_t>();
    BinaryFrame frame;
    if (op == kMessage) {
      frame.kind = BinaryFrame::Kind::message;
      frame.id = reader.number<std::uint32_t>();
      reader.skip(sizeof(std::uint64_t));  // reception time on the bridge's clock
    } else if (op == kResponse) {
      frame.kind = BinaryFrame::Kind::response;
      reader.skip(sizeof(std::uint32_t));  // which service
      frame.id = reader.number<std::uint32_t>();
      reader.skip(reader.number<std::uint32_t>());  // the encoding, the same as the request's
    }
    frame.payload = reader.take(reader.left());
    return frame;
  } catch (const BytesError& error) {
    throw FrameError("a binary frame of " + byte_count(bytes.size()) +
                     " cannot be read: " + error.what());
  }
}

std::string subscribe_frame(std::uint32_t subscription, std::uint32_t channel) {
  const Json link = {{"id", subscription}, {"channelId", channel}};
  return json_text({{"op", "subscribe"}, {"subscriptions", Json::array({link})}});
}

std::string advertise_frame(std::uint32_t id, const std::string& topic,
                            const BridgeSchema& schema) {
  Json channel = {{"id", id},
                  {"topic", topic},
                  {"encoding", schema.encoding},
                  {"schemaName", schema.type},
                  {"schema", schema.definition}};
  if (!schema.definition_kind.empty()) channel["schemaEncoding"] = schema.definition_kind;
  return json_text({{"op", "advertise"}, {"channels", Json::array({channel})}});
}

std::string parameter_frame(const std::string& name) {
  return json_text({{"op", "getParameters"}, {"parameterNames", {name}}, {"id", name}});
}

std::string publish_frame(std::uint32_t id, Bytes message) {
  std::string frame(1, '\x01');
  append_number(frame, id);
  frame.append(reinterpret_cast<const char*>(message.data()), message.size());
  return frame;
}

std::string call_frame(std::uint32_t service, std::uint32_t call, std::string_view encoding,
                       Bytes request) {
  std::string frame(1, '\x02');
  append_number(frame, service);
  append_number(frame, call);
  append_number(frame, static_cast<std::uint32_t>(encoding.size()));
  frame += encoding;
  frame.append(reinterpret_cast<const char*>(request.data()), request.size());
  return frame;
}

}  // namespace kinecal::detail
