// Definitions of camera_message.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/files/messages/camera_message.hpp"

#include <string>

namespace kinecal::detail {

CameraInfo camera_of(const MessageFields& message) {
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

ImagePart image_part_of(const MessageFields& message) {
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
