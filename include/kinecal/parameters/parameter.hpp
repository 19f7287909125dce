// A parameter: one number that calibration may correct, identified by its name.
//
// Names follow robot_calibration, the same in types, configurations, results and reports:
//
//   <joint>                  offset added to the measured position            rad or m
//   <frame>_x _y _z          translation of a frame correction                m
//   <frame>_a _b _c          rotation vector of a frame correction            rad
//   <camera>_fx _fy _cx _cy  relative change of an intrinsic: f = f0 (1 + v)  1
//   <camera>_z_offset        z = (z0 + z_offset) (1 + z_scaling)              m
//   <camera>_z_scaling                                                        1
//   <camera>_z_quadratic ... further terms of depth: sensors/depth/depth_polynomial.hpp  1/m, 1
//   <sensor>_<parameter>     what a sensor declares
//   <block>_<parameter>      what an error block declares
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <limits>
#include <string>
#include <string_view>

namespace kinecal {

/// Name of one parameter of a frame, a sensor or an error block: "head_pan_joint" + "x" ->
/// "head_pan_joint_x".
[[nodiscard]] inline std::string parameter_name(std::string_view owner, std::string_view part) {
  return std::string(owner) + "_" + std::string(part);
}

/// A parameter that its owner declares: a frame, a sensor, an error block.
struct ParameterInfo {
  std::string_view name;        ///< after the owner's: "fx" of "camera_fx"
  std::string_view unit = "1";  ///< "rad", "m" or "1"
  double initial = 0.0;         ///< value before the first step
  double lower = -std::numeric_limits<double>::infinity();  ///< lower bound of the value
  double upper = std::numeric_limits<double>::infinity();   ///< upper bound of the value
};

/// The parameters of a frame correction: translation, rotation vector.
inline constexpr std::array<ParameterInfo, 6> kFrameParameters = {
    {{"x", "m"}, {"y", "m"}, {"z", "m"}, {"a", "rad"}, {"b", "rad"}, {"c", "rad"}}};
/// Their names, after the frame's.
inline constexpr auto kFrameAxes = [] {
  std::array<std::string_view, 6> names;
  for (std::size_t axis = 0; axis < 6; ++axis) names[axis] = kFrameParameters[axis].name;
  return names;
}();
/// True for the name of one of a frame's parameters.
[[nodiscard]] inline bool is_frame_parameter(std::string_view name, std::string_view frame) {
  return std::any_of(kFrameAxes.begin(), kFrameAxes.end(),
                     [&](std::string_view axis) { return name == parameter_name(frame, axis); });
}

/// A parameter of a calibration with its value and bounds.
struct Parameter {
  std::string name;          ///< unique in a table
  std::string unit = "rad";  ///< "rad", "m" or "1"
  double initial = 0.0;      ///< in a result: the value before the first step
  double value = initial;    ///< current value: set it for another start
  double lower = -std::numeric_limits<double>::infinity();  ///< lower bound of the value
  double upper = std::numeric_limits<double>::infinity();   ///< upper bound of the value
};

}  // namespace kinecal
