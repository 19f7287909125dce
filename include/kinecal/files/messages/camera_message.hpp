// Camera settings from sensor_msgs/CameraInfo.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <string_view>

#include "kinecal/files/cameras/image_part.hpp"
#include "kinecal/files/messages/message_fields.hpp"
#include "kinecal/samples/sample.hpp"

namespace kinecal::detail {

template <class Numbers>
void copy_numbers(const MessageFields& message, std::string_view field, Numbers& numbers) {
  const auto& list = list_at(message, field);
  for (std::size_t i = 0; i < std::min(list.size(), numbers.size()); ++i) {
    list[i].visit_number([&](auto x) { numbers[i] = static_cast<double>(x); });
  }
}

[[nodiscard]] CameraInfo camera_of(const MessageFields& message);

[[nodiscard]] ImagePart image_part_of(const MessageFields& message);

}  // namespace kinecal::detail
