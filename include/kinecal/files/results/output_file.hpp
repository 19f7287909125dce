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

/// What becomes of a file of the same name.
enum class Existing {
  replaced,
  kept  ///< it is an error, also if the file appears while others are written
};

/// A file to write.
struct OutputFile {
  std::string name;     ///< in its folder
  std::string content;  ///< all its bytes
};

}  // namespace kinecal
