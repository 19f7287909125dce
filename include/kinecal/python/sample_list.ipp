// Samples as the module holds them.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "kinecal/files/diagnostics.hpp"
#include "kinecal/samples/sample.hpp"

namespace kinecal::python {

/// Samples of arrays or files.
struct SampleList {
  std::vector<Sample> samples = {};     ///< in the order of the rows, or of the files
  std::string urdf = {};                ///< that a recording has; may be empty
  std::vector<std::string> files = {};  ///< that were read
  Diagnostics diagnostics = {};         ///< of their readers
};

}  // namespace kinecal::python
