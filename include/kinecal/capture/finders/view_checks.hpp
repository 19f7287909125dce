// Checks that a view has what finders need; reports what is missing.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "kinecal/capture/view.hpp"

namespace kinecal {

/// Why the image of a view cannot be used; empty if it can.  The colours of a list of points are not
/// an image.
[[nodiscard]] std::string image_problem(const View& view);

/// Why the cloud of a view cannot be used; empty if it can.  Points may be missing.
[[nodiscard]] std::string cloud_problem(const View& view);

/// Why the camera_info of a view cannot be used with its image and its organised cloud; empty if it
/// can.
[[nodiscard]] std::string camera_problem(const View& view);

/// Why a pixel of the image does not match its point in the cloud; empty if it does.  The cloud
/// must have the image's size, and its points must project to their pixels, within a few pixels.
[[nodiscard]] std::string registration_problem(const View& view);

/// The first of all these problems: why a finder that needs image, points and camera_info cannot
/// use a view; empty if it can.
[[nodiscard]] std::string image_and_depth_problem(const View& view);

}  // namespace kinecal
