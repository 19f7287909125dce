// Camera settings from sensor_msgs/CameraInfo.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <string>
#include <string_view>

#include "kinecal/files/cameras/image_part.ipp"
#include "kinecal/files/messages/message_fields.ipp"
#include "kinecal/samples/sample.hpp"

namespace kinecal::detail {

template <class Numbers>
void copy_numbers(const MessageFields& message, std::string_view field, Numbers& numbers) {
  const auto& list = list_at(message, field);
  for (std::size_t i = 0; i < std::min(list.size(), numbers.size()); ++i) {
    list[i].visit_number([&](auto x) { numbers[i] = static_cast<double>(x); });
  }
}

[[nodiscard]] inline CameraInfo camera_of(const MessageFields& message) {
  CameraInfo camera;
  camera.width = static_cast<int>(number_at(message, "width"));
  camera.height = static_cast<int>(number_at(message, "height"));
  camera.distortion_model = std::string(text_at(message, "distortion_model"));
  camera.d.resize(list_at(message, "d").size());
  copy_numbers(message, "d", camera.d);
  copy_numbers(message, "k", camera.k);
  copy_numbers(message, "r", camera.r);
  copy_numbers(message, "p", camera.p);
  return camera;
}

[[nodiscard]] inline ImagePart image_part_of(const MessageFields& message) {
  ImagePart part;
  part.binning_x = number_at(message, "binning_x");
  part.binning_y = number_at(message, "binning_y");
  part.x = number_at(message, "roi.x_offset");
  part.y = number_at(message, "roi.y_offset");
  part.width = number_at(message, "roi.width");
  part.height = number_at(message, "roi.height");
  return part;
}

}  // namespace kinecal::detail
