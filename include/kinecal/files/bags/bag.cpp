// Converts names of topics and types between ROS 1 and ROS 2.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/files/bags/bag.hpp"

#include <algorithm>
#include <cstddef>
#include <string>
#include <string_view>

namespace kinecal {

namespace detail {

std::string plain_type(std::string_view type) {
  const std::size_t at = type.find("/msg/");
  if (at == std::string_view::npos) return std::string(type);
  return std::string(type.substr(0, at)) + std::string(type.substr(at + 4));
}

std::string plain_topic(std::string_view name) {
  name.remove_prefix(std::min(name.find_first_not_of('/'), name.size()));
  return std::string(name);
}

std::string ros2_type(std::string_view type) {
  const std::size_t at = type.find('/');
  if (at == std::string_view::npos || type.find('/', at + 1) != std::string_view::npos) {
    return std::string(type);
  }
  return std::string(type.substr(0, at)) + "/msg" + std::string(type.substr(at));
}

}  // namespace detail

}  // namespace kinecal
