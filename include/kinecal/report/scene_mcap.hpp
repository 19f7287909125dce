// Writes the scene of a calibration as an MCAP file for Foxglove and Lichtblick.
//
//   /transforms    foxglove.FrameTransforms: all joints of each sample, corrected; and uncorrected, in
//                  frames "before/<link>" below the base link
//   /robot         foxglove.SceneUpdate: the shapes of the links
//   /robot_before  the same before the calibration, transparent
//   /errors        measured (green) and predicted (orange) points of each sample, lines between them, its
//                  number and its worst error
//   /errors_before the same before the calibration, grey
//
// Messages are JSON with their schemas, with the stamps of the samples, or one second apart.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iosfwd>

#include "kinecal/files/bags/codec/compression.hpp"
#include "kinecal/report/robot_scene.hpp"

namespace kinecal {

/// Writes the file; then check the stream for errors.
void write_scene(const RobotScene& scene, std::ostream& out, Compression compression);

}  // namespace kinecal
