// Images and camera settings sent by a program over a pipe (pipe_robot.hpp).
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "kinecal/files/checksum.hpp"
#include "kinecal/files/images/read_image.hpp"
#include "kinecal/files/json/json_value.hpp"
#include "kinecal/text/printable.hpp"

namespace kinecal::detail {

/// The image of a file name or of {"base64": "..."}.
/// @param decode  decode_image or decode_depth
/// @throws JsonError   if a file cannot be read
/// @throws InputError  if it is not a valid image
template <class Decode>
[[nodiscard]] auto pipe_image(const JsonValue& image, Decode&& decode) {
  if (!image.is_text()) {
    const auto bytes = from_base64(image.text("base64"));
    if (!bytes) throw JsonError("the base64 has a character outside its alphabet");
    return decode(*bytes, "the image");
  }
  const std::string name = image.as_text();
  std::ifstream file(name, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(file), {}};
  if (bytes.empty()) throw JsonError("'" + printable(name) + "' cannot be read");
  return decode(bytes, name);
}

template <std::size_t N>
void copy_numbers(const JsonValue& json, const std::string& field, std::array<double, N>& to) {
  const std::vector<double> numbers = json.numbers(field);
  if (numbers.size() != N) {
    throw JsonError("field '" + field + "' has " + std::to_string(numbers.size()) +
                    " numbers; expected " + std::to_string(N));
  }
  std::copy(numbers.begin(), numbers.end(), to.begin());
}

/// P defaults to K.
[[nodiscard]] inline CameraInfo pipe_camera(const JsonValue& json) {
  CameraInfo camera;
  camera.width = static_cast<int>(json.id("width"));
  camera.height = static_cast<int>(json.id("height"));
  camera.distortion_model = json.text_or("distortion_model", "plumb_bob");
  camera.d = json.find("d") ? json.numbers("d") : std::vector<double>(5, 0.0);
  camera.r = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  if (json.find("r")) copy_numbers(json, "r", camera.r);
  if (json.find("k")) copy_numbers(json, "k", camera.k);
  if (json.find("p")) {
    copy_numbers(json, "p", camera.p);
    return camera;
  }
  copy_numbers(json, "k", camera.k);  // one of the two is required
  const auto& k = camera.k;
  camera.p = {k[0], k[1], k[2], 0, k[3], k[4], k[5], 0, k[6], k[7], k[8], 0};
  return camera;
}

}  // namespace kinecal::detail
