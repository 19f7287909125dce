// Programs of this build, from CMake, or of another one.
// SPDX-License-Identifier: Apache-2.0
#include <cstdlib>
#include <filesystem>

#include "support/paths.hpp"

namespace kinecal::test {

std::string program(const std::string& name) {
  const char* other = std::getenv("KINECAL_BIN");
  return std::string(other != nullptr ? other : KINECAL_BIN) + "/" + name;
}

std::string kinecal_program() {
  return program("kinecal");
}

std::string mpirun() {
  return KINECAL_MPIRUN;
}

bool has_levels() {
  return std::filesystem::exists(program("../lib/kinecal/glibc-hwcaps"));
}

}  // namespace kinecal::test
