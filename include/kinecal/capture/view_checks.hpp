// What finders need of a view, and the sentence about what it lacks.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "kinecal/capture/view.hpp"
#include "kinecal/linkage.hpp"

namespace kinecal {

/// Why the image of a view cannot be used; empty if it can.
[[nodiscard]] std::string image_problem(const View& view);

/// Why the cloud of a view cannot be used; empty if it can.  Points may be missing.
[[nodiscard]] std::string cloud_problem(const View& view);

/// Why the camera_info of a view cannot be used with its image and its organised cloud; empty if it
/// can.
[[nodiscard]] std::string camera_problem(const View& view);

/// Why a pixel of the image does not have its point in the cloud; empty if it has.  The cloud must be
/// of the image's size, and its points where camera_info sees them, within a few pixels.
[[nodiscard]] std::string registration_problem(const View& view);

/// The first of all these problems: why a view cannot be used by a finder that needs an image, the
/// point of each pixel and camera_info; empty if it can.
[[nodiscard]] std::string image_and_depth_problem(const View& view);

}  // namespace kinecal

#ifdef KINECAL_HEADER_ONLY
#include "kinecal/capture/view_checks.ipp"
#endif
