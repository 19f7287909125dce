// Assigns a camera to samples recorded without one.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "kinecal/files/diagnostics.hpp"
#include "kinecal/samples/sample.hpp"

namespace kinecal {

/// Assigns a camera to the observations of a sensor recorded without one.
/// @param argument     "NAME=FILE", or "NAME=FILE:cam1" for a file with several cameras
/// @param diagnostics  receives an error if no sample has the sensor, and a warning if some
///                     observations already have a camera
/// @throws InputError  if the argument or the file cannot be read
void set_camera(std::vector<Sample>& samples, const std::string& argument,
                Diagnostics& diagnostics);

}  // namespace kinecal
