// kinecal_robot_header: reads a URDF and writes a C++ header with the robot as constant data.
// kinecal_add_robot() runs it when a project is built.
// SPDX-License-Identifier: Apache-2.0
#include <cstdio>
#include <exception>
#include <filesystem>
#include <string>
#include <string_view>

#include "kinecal/files/results/file_set.hpp"
#include "kinecal/files/urdf/robot_header.hpp"

namespace {

namespace fs = std::filesystem;

constexpr const char* kUsage =
    "usage: kinecal_robot_header --urdf FILE --output FILE [--namespace NAME]\n"
    "Writes a C++ header with the robot of a URDF as constant data, NAME::Robot;\n"
    "without a NAME the namespace is the robot's name.\n";

struct Options {
  std::string urdf, output, name_space;
};

/// False if the arguments do not match the usage.
bool parse(int argc, char** argv, Options& options) {
  for (int i = 1; i + 1 < argc; i += 2) {
    const std::string_view name = argv[i];
    if (name == "--urdf") {
      options.urdf = argv[i + 1];
    } else if (name == "--output") {
      options.output = argv[i + 1];
    } else if (name == "--namespace") {
      options.name_space = argv[i + 1];
    } else {
      return false;
    }
  }
  return argc % 2 == 1 && !options.urdf.empty() && !options.output.empty();
}

/// Replaces the whole header at once; a reader never sees half of it.
void write(const fs::path& path, const std::string& text) {
  kinecal::OutputFolder folder(path.has_parent_path() ? path.parent_path() : fs::path("."));
  folder.write({{path.filename().string(), text}});
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  if (!parse(argc, argv, options)) {
    std::fputs(kUsage, stderr);
    return 1;
  }
  try {
    const std::string header = kinecal::robot_header(options.urdf, options.name_space);
    std::error_code missing;
    if (fs::equivalent(options.urdf, options.output, missing)) {
      throw kinecal::OutputError(options.output + ": would replace the URDF");
    }
    write(options.output, header);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "%s\n", e.what());
    return 1;
  }
  return 0;
}
