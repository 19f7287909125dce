// kinecal camera: shows a camera file, and writes it as camera_info, or as Kalibr or OpenCV read it.
// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <span>
#include <stdexcept>
#include <string>

#include "commands.hpp"
#include "input.hpp"
#include "kinecal/files/cameras/camera_info.hpp"
#include "kinecal/files/cameras/read_camera_file.hpp"
#include "kinecal/files/diagnostics.hpp"
#include "kinecal/files/results/file_set.hpp"
#include "output_file.hpp"
#include "terminal.hpp"

namespace kinecal::cli {
namespace {

void print_row(const char* title, std::span<const double> numbers) {
  say("{:<14}", title);
  for (const double number : numbers) say(" {}", number);
  say("\n");
}

void print_camera(const CameraInfo& camera) {
  say("{:<14} {} x {} pixels\n", "size", camera.width, camera.height);
  say("{:<14} {}\n", "distortion", camera.distortion_model);
  print_row("D", camera.d);
  print_row("K", camera.k);
  print_row("R", camera.r);
  print_row("P", camera.p);
}

/// @throws InputError  if a camera_info of it would be refused, here and by drivers
void check_size(const CameraInfo& camera, const std::string& file) {
  if (camera.width > 0 && camera.height > 0) return;
  throw InputError(file + ": the size of the image is missing, and camera_info needs it; add " +
                   (camera.width > 0 ? "image_height" : "image_width and image_height") +
                   "; nothing was written");
}

}  // namespace

int camera(const CameraOptions& options) {
  if (!options.output.empty()) {
    const std::string without_name = options.file.substr(0, options.file.rfind(':'));
    check_output(options.output, {options.file, without_name}, options.force);
  }
  Diagnostics diagnostics;
  const CameraInfo camera = read_camera_argument(options.file, diagnostics);
  print(diagnostics);
  if (!diagnostics.errors.empty()) return kBadInput;
  print_camera(camera);
  if (options.output.empty()) return kDone;
  check_size(camera, options.file);
  const auto text = [&] {
    if (options.keys == "message") return to_camera_message_yaml(camera);
    if (options.keys == "kalibr")
      return to_kalibr_yaml(camera, options.name == CameraOptions{}.name ? "cam0" : options.name);
    if (options.keys == "opencv") return to_opencv_yaml(camera);
    return to_camera_info_yaml(camera, options.name);
  };
  try {
    write_output(options.output, text());
  } catch (const std::invalid_argument& e) {
    throw InputError(fmt::format("{}: {}; nothing was written", options.file, e.what()));
  }
  say("wrote {}\n", options.output);
  return kDone;
}

}  // namespace kinecal::cli
