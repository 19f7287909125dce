// kinecal detect: samples from photographs and a table of joint positions.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/io/detect/detect.hpp"

#include <fmt/core.h>

#include <filesystem>
#include <optional>
#include <variant>

#include "commands.hpp"
#include "input.hpp"
#include "kinecal/capture/board_order.hpp"
#include "kinecal/io/cameras/read_camera_file.hpp"
#include "kinecal/io/detect/contact_sheet.hpp"
#include "kinecal/io/detect/image_folder.hpp"
#include "kinecal/io/recordings/write_recording.hpp"
#include "kinecal/io/results/file_set.hpp"
#include "kinecal/io/text_file.hpp"
#include "kinecal/io/urdf/read_urdf.hpp"
#include "output_file.hpp"
#include "progress.hpp"
#include "words.hpp"

namespace kinecal::cli {
namespace {

/// What is looked at, and by what.
struct Task {
  std::vector<ViewFinder> finders;
  std::vector<PosedImage> images;
  std::optional<CameraInfo> camera;
};

/// What was found in all images.
struct Detections {
  std::vector<Sample> samples;
  std::vector<Thumbnail> thumbnails;
  std::vector<std::string> refused;  ///< lines
  std::size_t images = 0;            ///< in which something was found
  std::size_t features = 0;
};

/// Warns of a board that shows no difference when it is turned.
void warn_of_turns(const CaptureFinder& finder, Diagnostics& diagnostics) {
  constexpr int kFullTurn = 4;  // quarters
  const auto* board = std::get_if<CheckerboardSettings>(&finder.settings);
  if (board == nullptr || turns_alike(board->points_x, board->points_y) == kFullTurn) {
    return;
  }
  diagnostics.warning(finder.place,
                      fmt::format("finder '{}': a board of {}x{} corners looks the same when it is "
                                  "turned; x is taken as the direction nearest to the image's "
                                  "right, so leave out images in which it is turned further, or "
                                  "use a board of which points_x + points_y is odd",
                                  finder.name, board->points_x, board->points_y));
}

std::vector<ViewFinder> make_finders(const DetectOptions& options, Diagnostics& diagnostics) {
  const CaptureConfig config = read_capture_config(options.config, diagnostics);
  std::optional<Robot> robot;
  if (!options.urdf.empty()) robot = read_urdf(options.urdf);
  std::vector<ViewFinder> finders;
  for (const CaptureFinder& finder : config.finders) {
    warn_of_turns(finder, diagnostics);
    try {
      if (!finder.region_frame.empty() && !robot) {
        throw InputError(finder.place.str() + ": finder '" + finder.name +
                         "' has a region in frame '" + finder.region_frame +
                         "'; give the robot with --urdf");
      }
      finders.push_back(view_finder(finder, robot ? on_robot(finder, *robot) : finder.settings));
    } catch (const InputError& error) {
      diagnostics.errors.emplace_back(error.what());
    }
  }
  return finders;
}

Task read_task(const DetectOptions& options, Diagnostics& diagnostics) {
  Task task;
  task.finders = make_finders(options, diagnostics);
  if (!options.camera.empty()) task.camera = read_camera_argument(options.camera, diagnostics);
  task.images =
      list_images({options.images, options.poses, options.columns, options.depth}, diagnostics);
  return task;
}

/// @throws InputError  naming both images, if they differ in size
void check_size(const View& view, const std::string& path, const GrayImage& first,
                const std::string& first_path) {
  if (view.image.width == first.width && view.image.height == first.height) return;
  throw InputError(fmt::format(
      "{}: has {}x{} pixels, but {} has {}x{}; images of one camera have "
      "one size",
      path, view.image.width, view.image.height, first_path, first.width, first.height));
}

Detections detect_all(const Task& task, const DetectOptions& options) {
  Detections all;
  GrayImage first;
  ProgressLine line;
  const ProgressMeter meter = line.meter();
  for (std::size_t i = 0; i < task.images.size(); ++i) {
    const PosedImage& image = task.images[i];
    if (meter) {
      meter(static_cast<double>(i) / static_cast<double>(task.images.size()), "detecting");
    }
    const View view = read_view(image, task.camera, options.frame);
    if (i == 0) first = view.image;
    check_size(view, image.path, first, task.images.front().path);
    Detection found = detect(view, task.finders, image.source);
    all.features += found.features;
    if (!found.samples.empty()) ++all.images;
    std::string reasons;
    for (const std::string& refused : found.refused) {
      all.refused.push_back(image.path + ": " + refused);
      if (found.samples.empty()) reasons += (reasons.empty() ? "" : "; ") + refused;
    }
    if (!options.sheet.empty()) {
      all.thumbnails.push_back(thumbnail(view.image, std::move(found.marks),
                                         std::filesystem::path(image.path).filename().string(),
                                         reasons));
    }
    for (Sample& sample : found.samples) all.samples.push_back(std::move(sample));
  }
  return all;
}

void write(const DetectOptions& options, const Detections& all) {
  const OutputFolder folder(folder_of(options.output));  // creates it if it is missing
  write_recording(options.output, all.samples,
                  options.urdf.empty() ? "" : detail::read_text_file(options.urdf));
}

}  // namespace

int detect(const DetectOptions& options) {
  const std::vector<std::string> inputs = {options.config, options.poses, options.columns,
                                           options.camera, options.urdf};
  check_output(options.output, inputs, options.force);
  (void)output_encoding(options.output);
  if (!options.sheet.empty()) check_output(options.sheet, inputs, options.force);
  Diagnostics diagnostics;
  const Task task = read_task(options, diagnostics);
  print(diagnostics);
  if (!diagnostics.errors.empty()) return kBadInput;
  const Detections all = detect_all(task, options);
  for (const std::string& refused : all.refused) fmt::print(stderr, "warning: {}\n", refused);
  if (!options.sheet.empty()) write_file(options.sheet, contact_sheet(all.thumbnails));
  if (all.samples.empty()) {
    fmt::print(stderr, "error: nothing was found in {}; {} was not written\n",
               counted(task.images.size(), "image"), options.output);
    return kBadInput;
  }
  write(options, all);
  fmt::print("wrote {}: {} of {}: {}; {} refused\n", options.output, all.images,
             counted(task.images.size(), "image"), counted(all.features, "feature"),
             task.images.size() - all.images);
  if (!options.sheet.empty()) fmt::print("wrote {}\n", options.sheet);
  return kDone;
}

}  // namespace kinecal::cli
