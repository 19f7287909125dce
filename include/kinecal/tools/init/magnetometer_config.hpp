// A first configuration for a magnetometer, and the meaning of a table's columns.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "kinecal/samples/sample.hpp"

namespace kinecal {

/// The URDF of a magnetometer alone, on a link of this name.
[[nodiscard]] std::string magnetometer_urdf(const std::string& link);

/// The configuration: hard iron, and of soft iron what the readings show.
/// @param base_link  a link of the URDF
/// @param samples    with conditions mag_x mag_y mag_z
/// @throws InputError  if they have none, or too few
[[nodiscard]] std::string magnetometer_config(const std::string& base_link,
                                              std::span<const Sample> samples);

/// A columns.yaml for a table with three columns such as mag_x, mx, magnetic_field.x.
/// @param text  of the table
/// @throws InputError  if it has no such columns
[[nodiscard]] std::string magnetometer_columns(std::string_view text, const std::string& file);

}  // namespace kinecal
