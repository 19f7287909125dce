// The depth correction of a camera as a file, depth_correction_<camera>.yaml: for drivers, which know offset and
// scale at most.  It says its formula; sensors/depth/true_depth.hpp applies it.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <span>
#include <string>

#include "kinecal/problem/mounted_sensor.hpp"
#include "kinecal/samples/sample.hpp"
#include "kinecal/sensors/depth/true_depth.hpp"

namespace kinecal {

/// The depth correction of a calibrated depth camera.
struct CalibratedDepth {
  DepthErrors errors = {};                     ///< of a camera3d
  int width = 0, height = 0;                   ///< of its image, pixels
  std::map<std::string, double> values = {};   ///< by the name of each number of the file
  std::map<std::string, int> parameters = {};  ///< index in the table, by the same; -1: not in it

  /// True if its polynomial is not zero.
  [[nodiscard]] bool bends() const;
};

/// The depth correction of a camera3d.
/// @param seen    an observation, with the settings while recording
/// @param values  of all parameters of the problem
[[nodiscard]] CalibratedDepth calibrated_depth(const MountedSensor& sensor, const Observation& seen,
                                               ParameterValues values);

/// Why a depth correction cannot be: some feature would be behind the camera, or farther points nearer than it; empty
/// if it can.
[[nodiscard]] std::string impossible_depth(const CalibratedDepth& depth, const std::string& camera,
                                           std::span<const Sample> samples);

/// The content of the file.
/// @param deviations  standard deviations by table index; infinite: not determined
/// @param samples     the file says where their features are: nothing else held the polynomial
[[nodiscard]] std::string depth_correction_yaml(const CalibratedDepth& depth,
                                                const std::string& camera,
                                                const std::map<int, double>& deviations,
                                                std::span<const Sample> samples);

}  // namespace kinecal
