// Where the plug-ins are: parts of kinecal with large dependencies, loaded when they are needed.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

namespace kinecal::detail {

/// The file of a plug-in; empty if it is not installed.  It is in $KINECAL_PLUGINS or, if that is not set, in the first of
/// these folders that has it: beside the running program, in its build or its installation; where this library is
/// installed; where its Debian package is.
/// @param name  of the file: "kinecal_opencv.so"
[[nodiscard]] std::filesystem::path plugin_file(const std::string& name);

}  // namespace kinecal::detail
