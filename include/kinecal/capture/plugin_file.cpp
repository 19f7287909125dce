// Definitions of plugin_file.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/capture/plugin_file.hpp"

#include <cstdlib>
#include <system_error>
#include <vector>

namespace kinecal::detail {

std::filesystem::path plugin_file(const std::string& name) {
  std::error_code error;
  const auto program = std::filesystem::read_symlink("/proc/self/exe", error).parent_path();
  std::vector<std::filesystem::path> folders = {program / KINECAL_PLUGINS_FROM_PROGRAM,
                                                program / ".." / "lib" / "kinecal", KINECAL_PLUGINS,
                                                KINECAL_PACKAGED_PLUGINS};
  if (const char* given = std::getenv("KINECAL_PLUGINS")) folders = {given};
  for (const auto& folder : folders) {
    if (std::filesystem::exists(folder / name, error)) return folder / name;
  }
  return {};
}

}  // namespace kinecal::detail
