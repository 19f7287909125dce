// OpenCV's searches for boards and markers, loaded by the first call that needs them.
//
// So neither the library nor a program links OpenCV and its 24 shared libraries.  The plug-in is
// capture/opencv/kinecal_opencv.hpp.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "kinecal/capture/opencv/kinecal_opencv.hpp"

namespace kinecal::detail {

/// The plug-in, loaded once.
/// @return  nullptr if it is not installed or cannot be loaded: opencv_fault() says why
[[nodiscard]] const OpencvModule* opencv_module();

/// Why there is no plug-in, and what to do; empty if there is one.
/// @param what  needs it: "checkerboards"
[[nodiscard]] std::string opencv_fault(const std::string& what);

}  // namespace kinecal::detail
