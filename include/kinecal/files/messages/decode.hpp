// Messages from the bytes in which ROS 1 and ROS 2 (CDR) write them.  By hand: a library such as Fast CDR reads
// types that were compiled in, but a type is known only from the text that its bag carries.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/files/bags/bag.hpp"
#include "kinecal/files/messages/definition.hpp"
#include "kinecal/files/messages/value.hpp"

namespace kinecal::detail {

/// @param definition  must outlive the result
/// @param data        must outlive the result
/// @throws BytesError  if the bytes are not such a message, with the reason and the byte
[[nodiscard]] MessageFields decode(const MessageDefinition& definition, Encoding encoding,
                                   Bytes data);

}  // namespace kinecal::detail
