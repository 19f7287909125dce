// The names of lenses in files, and their coefficients in camera_info.
// Source: sensor_msgs/distortion_models; Kalibr wiki, supported models; OpenCV, calib3d.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "kinecal/linkage.hpp"
#include "kinecal/parameters/parameter.hpp"
#include "kinecal/samples/sample.hpp"

namespace kinecal {

/// The lens that a camera_info describes: "plumb_bob", also where it has no distortion; "thin_prism" of a
/// rational_polynomial with more than eight coefficients that are not zero.
/// @throws SettingsError  if nobody knows the name of its distortion model
[[nodiscard]] std::string lens_of(const CameraInfo& info);

/// The lens that a name in a file means: "equidistant" of "fisheye"; empty if nobody knows it.
[[nodiscard]] std::string_view lens_named(std::string_view name);

/// True for the lenses that bend the image of a pinhole: plumb_bob, rational_polynomial, thin_prism, each of which
/// contains the one before it.
[[nodiscard]] bool bends_pinhole(std::string_view lens);

/// True if a lens can have all coefficients of another one.
[[nodiscard]] bool contains_lens(std::string_view lens, std::string_view other);

/// The distortion_model of a lens in camera_info: its name, but rational_polynomial of thin_prism.
[[nodiscard]] std::string_view distortion_model_of(std::string_view lens);

/// The names of all lenses.
[[nodiscard]] std::span<const std::string_view> lens_names();

/// The coefficients of a camera_info for a lens that can take them: its own, or those of a lens that it
/// contains (rational_polynomial contains plumb_bob).
/// @param lens   one of lens_names(), or your own, which camera_info names as its distortion_model
/// @param count  how many coefficients it has
/// @throws SettingsError  if there are too many or too few, one is not a number, or they are of another lens and not
///                        all zero
[[nodiscard]] std::vector<double> coefficients_of(const CameraInfo& info, std::string_view lens,
                                                  std::size_t count);

/// Adds changes to the coefficients of a camera_info, if one is not zero: its distortion model becomes that of
/// the lens, unless it can hold them.
/// @param coefficients  of the lens, their names
/// @param changes       of each coefficient
/// @param raw           false: the image is rectified
/// @throws std::invalid_argument  if it is rectified and a change is not zero
void set_coefficients(CameraInfo& info, std::string_view lens,
                      std::span<const ParameterInfo> coefficients, std::span<const double> changes,
                      bool raw);

}  // namespace kinecal

#ifdef KINECAL_HEADER_ONLY
#include "kinecal/sensors/lenses/lens_names.ipp"
#endif
