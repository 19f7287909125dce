// The definition of a bridge's messages.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "kinecal/files/messages/known_definitions.hpp"
#include "kinecal/robots/action_definitions.ipp"
#include "kinecal/robots/bridge_client.hpp"
#include "kinecal/robots/bridge_frames.hpp"
#include "kinecal/text/printable.hpp"

namespace kinecal::detail {

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

}  // namespace kinecal::detail
