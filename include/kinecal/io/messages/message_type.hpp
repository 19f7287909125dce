// What a message consists of: fields, one after the other, each a number, a text or a message.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace kinecal {

enum class FieldType : std::uint8_t {
  boolean,
  int8,
  uint8,
  int16,
  uint16,
  int32,
  uint32,
  int64,
  uint64,
  float32,
  float64,
  text,
  message
};

struct MessageField {
  enum class Count : std::uint8_t { one, fixed, any };

  std::string name;
  FieldType type = FieldType::message;
  std::size_t message = 0;  ///< of type message: which one of the definition
  Count count = Count::one;
  std::uint32_t size = 1;  ///< of a list of fixed size
};

struct MessageType {
  std::string name;  ///< "package/Type"
  std::vector<MessageField> fields;
};

/// A message and all that it consists of; the message is the first.
using MessageDefinition = std::vector<MessageType>;

}  // namespace kinecal
