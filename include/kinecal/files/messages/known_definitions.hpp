// Definitions of the messages that kinecal reads and writes: for bags without definitions (SQLite
// of older ROS 2), and for writing bags.  Otherwise, the bag's own definitions are used.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "kinecal/files/bags/bag.hpp"

namespace kinecal::detail {

/// The .msg text of a message and of all types that it uses; empty if unknown to kinecal.
/// @param type  "package/Type"
[[nodiscard]] std::string known_definition(const std::string& type, Encoding encoding);

/// The checksum that identifies a message in ROS 1; empty for those that kinecal does not write.
[[nodiscard]] std::string known_md5(const std::string& type);

}  // namespace kinecal::detail
