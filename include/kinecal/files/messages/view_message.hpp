// Images, depth and points from messages: sensor_msgs/Image, CompressedImage, PointCloud2.
// Source: packages sensor_msgs, cv_bridge (names of encodings), compressed_depth_image_transport;
// REP 118 (depth images).
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

#include "kinecal/capture/image.hpp"
#include "kinecal/files/messages/value.hpp"

namespace kinecal::detail {

/// Brightness of an Image (gray, colour, Bayer, YUV) or a CompressedImage (PNG, JPEG).  For 16
/// bits, the upper 8 of those that the camera uses.  A Bayer mosaic is smoothed over 3x3 pixels,
/// which gives each pixel the same share of each colour.
/// @throws std::runtime_error  if it has another encoding, or the data is damaged
[[nodiscard]] GrayImage gray_image(const MessageFields& message);

/// Metres of an Image (32FC1: metres; 16UC1: millimetres) or a CompressedImage of either; NaN where
/// nothing was measured.
/// @throws std::runtime_error  if the encoding is not a depth encoding, or the data is damaged
[[nodiscard]] DepthImage depth_image(const MessageFields& message);

/// Points of a PointCloud2; also its colour as brightness, if it has any and the image is empty.
/// @throws std::runtime_error  if it has no x, y, z, or the data is damaged
void read_cloud(const MessageFields& cloud, PointCloud& points, GrayImage& image);

/// True if an encoding of Image, or a format of CompressedImage, is a depth encoding.
[[nodiscard]] bool is_depth(std::string_view encoding);

}  // namespace kinecal::detail
