// Images, depth and points from their messages: sensor_msgs/Image, CompressedImage, PointCloud2.
// Source: packages sensor_msgs, cv_bridge (names of encodings), compressed_depth_image_transport; REP
// 118 (depth images).
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

#include "kinecal/capture/image.hpp"
#include "kinecal/files/messages/value.hpp"
#include "kinecal/linkage.hpp"

namespace kinecal::detail {

/// Brightness of an Image (gray, colour, Bayer, YUV) or a CompressedImage (PNG, JPEG).  Of 16 bits, the
/// upper 8 of those that the camera uses.  A Bayer mosaic is smoothed over 3x3 pixels, which gives
/// each pixel the same share of each colour.
/// @throws std::runtime_error  if the encoding is not one of these, or the data is damaged
[[nodiscard]] GrayImage gray_image(const MessageFields& message);

/// Metres of an Image (32FC1: metres; 16UC1: millimetres) or a CompressedImage of either; NaN where
/// nothing was measured.
/// @throws std::runtime_error  if the encoding is not one of depth, or the data is damaged
[[nodiscard]] DepthImage depth_image(const MessageFields& message);

/// Points of a PointCloud2, and colour as brightness if there is any and the image is empty.
/// @throws std::runtime_error  if it has no x, y, z, or the data is damaged
void read_cloud(const MessageFields& cloud, PointCloud& points, GrayImage& image);

/// Whether an encoding of Image, or a format of CompressedImage, is one of depth.
[[nodiscard]] bool is_depth(std::string_view encoding);

}  // namespace kinecal::detail

#ifdef KINECAL_HEADER_ONLY
#include "kinecal/files/messages/view_message.ipp"
#endif
