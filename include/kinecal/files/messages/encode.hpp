// Encodes messages as the bytes of ROS 1 and ROS 2 (CDR).
//
// The definition decides what is written.  Fields are found by name; a field that the value does
// not have is written as zero or empty.  So a message of ROS 1 becomes one of ROS 2, and back.  By hand, as
// they are read: see decode.hpp.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "kinecal/files/bags/bag.hpp"
#include "kinecal/files/messages/definition.hpp"
#include "kinecal/files/messages/value.hpp"

namespace kinecal::detail {

/// @throws BytesError  if a list or text is longer than the format allows
[[nodiscard]] std::vector<std::byte> encode(const MessageFields& value,
                                            const MessageDefinition& definition, Encoding encoding);

}  // namespace kinecal::detail
