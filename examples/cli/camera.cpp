// kinecal camera: what a camera file says, and the same as camera_info.
// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <filesystem>
#include <span>
#include <system_error>

#include "commands.hpp"
#include "input.hpp"
#include "kinecal/io/camera_info.hpp"
#include "kinecal/io/cameras/read_camera_file.hpp"
#include "kinecal/io/results/file_set.hpp"

namespace kinecal::cli {
namespace {

void print_row(const char* title, std::span<const double> numbers) {
  fmt::print("{:<14}", title);
  for (const double number : numbers) fmt::print(" {}", number);
  fmt::print("\n");
}

void print_camera(const CameraInfo& camera) {
  fmt::print("{:<14} {} x {} pixels\n", "size", camera.width, camera.height);
  fmt::print("{:<14} {}\n", "distortion", camera.distortion_model);
  print_row("D", camera.d);
  print_row("K", camera.k);
  print_row("R", camera.r);
  print_row("P", camera.p);
}

}  // namespace

int camera(const CameraOptions& options) {
  Diagnostics diagnostics;
  const CameraInfo camera = read_camera_argument(options.file, diagnostics);
  print(diagnostics);
  if (!diagnostics.errors.empty()) return kBadInput;
  print_camera(camera);
  if (options.output.empty()) return kDone;
  const std::filesystem::path output(options.output);
  std::error_code missing;
  for (const std::string& input : {options.file, options.file.substr(0, options.file.rfind(':'))}) {
    if (!std::filesystem::equivalent(output, input, missing)) continue;
    throw OutputError(options.output + ": would replace the input; choose another --output");
  }
  OutputFolder folder(output.has_parent_path() ? output.parent_path() : ".");
  folder.write({{output.filename().string(), options.keys == "message"
                                                 ? to_camera_message_yaml(camera)
                                                 : to_camera_info_yaml(camera, options.name)}});
  fmt::print("wrote {}\n", options.output);
  return kDone;
}

}  // namespace kinecal::cli
