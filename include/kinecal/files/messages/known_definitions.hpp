// Definitions of the messages that kinecal reads and writes: for bags that do not carry any (SQLite
// of older ROS 2), and for writing bags.  A bag that carries definitions is read by those.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "kinecal/files/bags/bag.hpp"

namespace kinecal::detail {

/// The .msg text of a message and of all types that it uses; empty if kinecal does not know it.
/// @param type  "package/Type"
[[nodiscard]] std::string known_definition(const std::string& type, Encoding encoding);

/// The checksum by which ROS 1 identifies a message; empty for those that kinecal does not write.
[[nodiscard]] std::string known_md5(const std::string& type);

}  // namespace kinecal::detail

#ifdef KINECAL_HEADER_ONLY
#include "kinecal/files/messages/known_definitions.ipp"
#endif
