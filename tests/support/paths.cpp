// Folders of this checkout and its build, from CMake.
// SPDX-License-Identifier: Apache-2.0
#include "support/paths.hpp"

namespace kinecal::test {

std::string source_folder() {
  return KINECAL_SOURCE_DIR;
}

std::string default_data_folder() {
  return KINECAL_DATA_DEFAULT;
}

std::string bridge_folder() {
  return KINECAL_BRIDGE_FOLDER;
}

}  // namespace kinecal::test
