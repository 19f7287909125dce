// The fields of a message type, parsed from the .msg text in a bag.
//
//   # comment                        geometry_msgs/PointStamped[] features
//   uint8 FLOAT32 = 7                float64[9] K
//   ================================================================================
//   MSG: geometry_msgs/PointStamped
//   ...
//
// A type without a package belongs to the package that uses it; Header, if that package does not
// define one, is std_msgs/Header.  The time and duration of ROS 1 are two numbers.  ROS 2 adds
// bounds (string<=10) and default values.
// It is parsed by hand: Debian's only parser of .msg text, genmsg, is in Python.
// Source: ROS 1 wiki, msg; ROS 2 documentation, Interfaces.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace kinecal::detail {

/// The type of a field.  A time or duration of ROS 1 is a message.
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

/// A field of a message type.
struct MessageField {
  /// A single value, a list of fixed size, or a list of any size.
  enum class Count : std::uint8_t { one, fixed, any };

  std::string name;                     ///< as in the definition
  FieldType type = FieldType::message;  ///< of the value, or of each item
  std::size_t message = 0;   ///< index of its type in the definition, if this is a message
  Count count = Count::one;  ///< whether it is a list
  std::uint32_t size = 1;    ///< items of a list of fixed size
};

/// A message type.
struct MessageType {
  std::string name;                  ///< "package/Type"
  std::vector<MessageField> fields;  ///< in the order of the definition
};

/// A message type, followed by all types that it uses.
using MessageDefinition = std::vector<MessageType>;

/// An invalid definition, with the reason and the line of the text.
struct DefinitionError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Largest size of a definition text, bytes.  Real ones have about 1 % of that.
inline constexpr std::size_t kMostOfADefinition = std::size_t{1} << 20;

/// @param type  "package/Type" of the message, spelt as in ROS 1 or ROS 2
/// @param text  its .msg text and those of all types that it uses
/// @throws DefinitionError  naming the line of the text or the missing type
[[nodiscard]] MessageDefinition parse_definition(const std::string& type, std::string_view text);

}  // namespace kinecal::detail
