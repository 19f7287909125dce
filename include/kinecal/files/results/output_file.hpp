// A file to be written, and why it could not be.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdexcept>
#include <string>

namespace kinecal {

/// A file could not be written: which, and why.
struct OutputError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// A file to write.
struct OutputFile {
  std::string name;     ///< in its folder
  std::string content;  ///< all bytes of it
};

}  // namespace kinecal
