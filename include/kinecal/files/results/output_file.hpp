// A file to write, and the error if it cannot be written.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdexcept>
#include <string>

namespace kinecal {

/// A file could not be written: its name, and the reason.
struct OutputError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// A file to write.
struct OutputFile {
  std::string name;     ///< in its folder
  std::string content;  ///< all its bytes
};

}  // namespace kinecal
