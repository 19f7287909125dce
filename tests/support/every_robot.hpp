// All robots with their URDFs: the shipped ones, and the real ones if their data are present.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <string>
#include <vector>

#include "kinecal/files/urdf/read_urdf.hpp"
#include "support/data.hpp"
#include "support/paths.hpp"

namespace kinecal::test {

struct NamedUrdf {
  std::string name;  ///< letters, digits and underscores
  std::filesystem::path file;

  friend void PrintTo(const NamedUrdf& urdf, std::ostream* out) { *out << urdf.name; }
};

inline std::vector<NamedUrdf> every_robot() {
  std::vector<NamedUrdf> all;
  const std::filesystem::path source = source_folder();
  for (const auto& folder :
       {source / "examples/robots", source / "examples/mobile_manipulator", data_folder() / "fetch",
        data_folder() / "ur5_tracker", data_folder() / "mukca_panda"}) {
    if (!std::filesystem::exists(folder)) continue;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
      if (entry.path().extension() != ".urdf") continue;
      const auto parent = entry.path().parent_path();
      std::string name = parent.parent_path().filename().string() + "_" +
                         parent.filename().string() + "_" + entry.path().stem().string();
      for (char& c : name) {
        if (std::isalnum(static_cast<unsigned char>(c)) == 0) c = '_';
      }
      all.push_back({name, entry});
    }
  }
  std::sort(all.begin(), all.end(), [](const auto& a, const auto& b) { return a.name < b.name; });
  return all;
}

}  // namespace kinecal::test
