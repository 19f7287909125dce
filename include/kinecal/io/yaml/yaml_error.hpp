// What is not YAML.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdexcept>
#include <string>

namespace kinecal {

/// Text that is not YAML, with the line where this shows, from 1.
struct YamlError : std::runtime_error {
  YamlError(int error_line, const std::string& what) : std::runtime_error(what), line(error_line) {}
  int line;
};

}  // namespace kinecal
