// kinecal detect: samples from photographs with a table of joint positions, and from recordings.
// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <optional>
#include <set>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "commands.hpp"
#include "detected.hpp"
#include "input.hpp"
#include "kinecal/files/cameras/read_camera_file.hpp"
#include "kinecal/files/recordings/write_recording.hpp"
#include "kinecal/files/results/file_set.hpp"
#include "kinecal/files/text_file.hpp"
#include "kinecal/files/urdf/read_urdf.hpp"
#include "kinecal/text/counted.hpp"
#include "kinecal/text/nearest_name.hpp"
#include "kinecal/text/printable.hpp"
#include "kinecal/tools/detect/detect_all.hpp"
#include "output_file.hpp"
#include "progress.hpp"
#include "sheets.hpp"
#include "terminal.hpp"

namespace kinecal::cli {
namespace {

/// @throws InputError  if options do not go together
void check_options(const DetectOptions& options) {
  if (options.images.empty() && options.bags.empty()) {
    throw InputError(
        "give photographs (--images and --frame), masks (--masks and --frame) or recordings "
        "(--bag)");
  }
  if (options.config.empty() == options.masks.empty()) {
    throw InputError(options.masks.empty()
                         ? "what to look for is missing: a capture.yaml, or --masks"
                         : "--masks needs no capture.yaml");
  }
  if (!options.poses.empty() && options.images.empty()) {
    throw InputError("--poses has the joints of --images or --masks");
  }
  if (!options.images.empty() && options.frame.empty()) {
    throw InputError("photographs need the name of the camera's frame: --frame");
  }
  const bool has_links = !options.board_link.empty() || !options.camera_link.empty();
  if (has_links && options.urdf.empty()) {
    throw InputError("--board-link and --camera-link need the robot: --urdf");
  }
  constexpr double kShortest = 1e-3, kLongest = 3600.0;  // seconds
  if (options.every && !(*options.every >= kShortest && *options.every <= kLongest)) {
    throw InputError(fmt::format("--every takes 0.001 to 3600 seconds, is {}", *options.every));
  }
  if (options.every && !options.restless.empty()) {
    throw InputError(
        "--restless names joints that need not stand still in standstills; --every takes views "
        "while the robot moves: leave one of them out");
  }
}

/// Errors of links that the robot does not have.
void check_links(const DetectOptions& options, const Robot& robot, Diagnostics& diagnostics) {
  for (const auto& [option, link] : {std::pair("--board-link", options.board_link),
                                     std::pair("--camera-link", options.camera_link)}) {
    if (link.empty() || robot.has_link(link)) continue;
    std::vector<std::string> links;
    for (const Joint& joint : robot.joints()) links.push_back(joint.child);
    diagnostics.errors.push_back(std::string(option) + ": the robot has no link '" + link + "'" +
                                 did_you_mean(link, links));
  }
}

/// Errors of joints of the photographs that the robot does not have.
void check_joints(const DetectOptions& options, const DetectionInput& task,
                  Diagnostics& diagnostics) {
  const std::vector<PosedImage>& images = task.rig.empty() ? task.images : task.rig.front().images;
  if (images.empty() || !task.robot) return;
  std::vector<std::string> joints;
  for (const Joint& joint : task.robot->joints()) joints.push_back(joint.name);
  const bool has_columns = !options.columns.empty();
  for (const std::string& name : images.front().joints.names) {
    if (task.robot->has_joint(name)) continue;
    const std::string nearest = did_you_mean(name, joints);
    diagnostics.errors.push_back(
        (has_columns ? options.columns + ": joint '" : options.poses + ":1: column '") +
        printable(name) + "' is not a joint of " + options.urdf +
        (nearest.empty() && !has_columns ? "; --columns says what each column is" : nearest));
  }
}

/// The files of a recording: those of its folder, or itself.
std::vector<std::filesystem::path> recording_files(const std::string& recording) {
  std::error_code failed;
  if (!std::filesystem::is_directory(recording, failed)) return {recording};
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(recording, failed)) {
    if (entry.path().extension() == ".db3" || entry.path().extension() == ".mcap") {
      files.push_back(entry.path());
    }
  }
  return files;
}

/// Whether two files are one, or have the same content.
bool is_same_file(const std::filesystem::path& a, const std::filesystem::path& b) {
  std::error_code missing;
  if (std::filesystem::equivalent(a, b, missing)) return true;
  const auto size = std::filesystem::file_size(a, missing);
  if (missing || size == 0 || size != std::filesystem::file_size(b, missing) || missing) {
    return false;
  }
  std::ifstream one(a, std::ios::binary), other(b, std::ios::binary);
  std::vector<char> of_one(std::size_t{1} << 20), of_other(of_one.size());
  while (one && other) {
    one.read(of_one.data(), static_cast<std::streamsize>(of_one.size()));
    other.read(of_other.data(), static_cast<std::streamsize>(of_other.size()));
    if (one.gcount() != other.gcount() ||
        !std::equal(of_one.begin(), of_one.begin() + one.gcount(), of_other.begin())) {
      return false;
    }
  }
  return one.eof() && other.eof();
}

/// @throws InputError  if a recording is given twice: its samples would count twice
void check_recordings(const std::vector<std::string>& bags) {
  for (std::size_t i = 0; i < bags.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      for (const auto& file : recording_files(bags[i])) {
        for (const auto& other : recording_files(bags[j])) {
          if (!is_same_file(file, other)) continue;
          throw InputError("--bag: " + bags[i] + " is the same recording as " + bags[j] +
                           "; give it once, else its samples count twice");
        }
      }
    }
  }
}

void add_recordings(const DetectOptions& options, DetectionInput& task, Diagnostics& diagnostics) {
  for (const std::string& bag : options.bags) {
    RecordingOptions recording{
        .path = bag, .frame = options.frame, .camera = task.camera, .robot = task.robot};
    for (const std::string& topic : options.joints) {
      recording.joints.push_back(detail::plain_topic(topic));
    }
    if (options.every) {
      recording.every = std::chrono::round<Stamp>(std::chrono::duration<double>(*options.every));
    }
    recording.restless.insert(options.restless.begin(), options.restless.end());
    if (options.images.empty()) recording.depth = options.depth;
    recording.led = is_led_table(options.led) ? options.led : detail::plain_topic(options.led);
    ProgressLine line;
    task.recordings.emplace_back(std::move(recording), task.config.finders, diagnostics,
                                 line.meter());
  }
}

/// The cameras of a rig: names after --frame; empty for one camera.
/// @throws InputError  if options do not go together
std::vector<std::string> cameras_of(const DetectOptions& options) {
  std::vector<std::string> cameras;
  if (options.images.empty() || options.frame.find(',') == std::string::npos) return cameras;
  std::istringstream names(options.frame);
  for (std::string name; std::getline(names, name, ',');) {
    if (name.empty() || std::find(cameras.begin(), cameras.end(), name) != cameras.end()) {
      throw InputError("--frame: '" + options.frame +
                       "' names a camera twice, or has an empty name");
    }
    cameras.push_back(name);
  }
  if (!options.depth.empty() || !options.camera.empty() || !options.bags.empty()) {
    throw InputError("--frame names several cameras: --camera, --depth and --bag go with one only");
  }
  return cameras;
}

DetectionInput read_task(const DetectOptions& options, Diagnostics& diagnostics) {
  DetectionInput task;
  task.frame = options.frame;
  task.links = {options.board_link, options.camera_link};
  if (options.masks.empty()) {
    task.config = read_capture_config(options.config, diagnostics);
  } else {
    task.config.finders.push_back({.name = "masks",
                                   .type = "MaskFinder",
                                   .topic = "",
                                   .camera_info = "",
                                   .settings = MaskFinder{},
                                   .place = {}});
  }
  if (!options.urdf.empty()) {
    task.robot = read_urdf(options.urdf);
    check_links(options, *task.robot, diagnostics);
  }
  (void)make_finders(task, diagnostics.errors);
  for (const CaptureFinder& finder : task.config.finders) {
    if (options.images.empty() || !std::holds_alternative<LedFinder>(finder.settings)) continue;
    try {
      (void)view_finder(finder, finder.settings);
    } catch (const InputError& error) {
      diagnostics.errors.emplace_back(error.what());
    }
  }
  if (!options.camera.empty()) task.camera = read_camera_argument(options.camera, diagnostics);
  const std::vector<std::string> cameras = cameras_of(options);
  const auto folder_of_camera = [&](const std::string& camera) {
    return options.images + "/" + camera;
  };
  for (const std::string& camera : cameras) {
    ImageFolder folder{folder_of_camera(camera), options.poses, options.columns, {}};
    for (const std::string& other : cameras) {
      if (other != camera) folder.others.push_back(folder_of_camera(other));
    }
    task.rig.push_back({camera, list_images(folder, diagnostics)});
  }
  if (!options.images.empty() && cameras.empty()) {
    task.images =
        list_images({options.images, options.poses, options.columns, options.depth}, diagnostics);
  }
  check_joints(options, task, diagnostics);
  if (diagnostics.errors.empty()) add_recordings(options, task, diagnostics);
  return task;
}

/// Prints what was refused, and what a single image says.
void print_refusals(const std::vector<Look>& looks) {
  std::size_t single = 0;
  std::map<std::string, std::size_t> refusals;  // how often, if not yet printed
  for (const Look& look : looks) {
    for (const std::string& refused : look.refused) ++refusals[refused];
  }
  for (const Look& look : looks) {
    if (look.features > 0 && !look.compared) ++single;
    for (const std::string& refused : look.refused) {
      const std::size_t others = std::exchange(refusals[refused], 0);
      if (others == 0) continue;
      say(stderr, "warning: {}{}\n", look.source + ": " + refused,
          others > 1 ? " (and in " + counted(others - 1, "other view") + ")" : "");
    }
  }
  if (single > 0) {
    say(stderr,
        "note: {} used with a single image each: whether it moved is not known; record more "
        "images a second\n",
        single == 1 ? "1 standstill is" : std::to_string(single) + " standstills are");
  }
}

/// The pictures of all looks.
std::vector<Thumbnail> thumbnails_of(std::vector<Look> looks) {
  std::vector<Thumbnail> all;
  for (Look& look : looks) {
    std::move(look.thumbnails.begin(), look.thumbnails.end(), std::back_inserter(all));
  }
  return all;
}

void write(const DetectOptions& options, const std::vector<Sample>& samples) {
  const OutputFolder folder(folder_of(options.output));  // creates it if it is missing
  write_recording(options.output, samples,
                  options.urdf.empty() ? "" : detail::read_text_file(options.urdf),
                  existing_at(options.output));
}

}  // namespace

int detect(const DetectOptions& given) {
  DetectOptions options = given;
  if (!options.masks.empty()) options.images = options.masks;
  check_options(options);
  std::vector<std::string> inputs = {options.config, options.poses, options.columns, options.camera,
                                     options.urdf};
  inputs.insert(inputs.end(), options.bags.begin(), options.bags.end());
  check_output(options.output, inputs, options.force);
  (void)output_encoding(options.output);
  inputs.push_back(options.output);
  if (!options.sheet.empty()) check_sheets(options.sheet, inputs, options.force);
  check_recordings(options.bags);
  Diagnostics diagnostics;
  const DetectionInput task = read_task(options, diagnostics);
  print(diagnostics);
  if (!diagnostics.errors.empty()) return kBadInput;
  Diagnostics turns;
  DetectedSamples found;
  {
    ProgressLine line;
    found = detect_all(task, {options.threads, !options.sheet.empty(), line.meter()}, turns);
  }
  // First: who reads only the first lines of what is printed gets the file as well.
  if (!found.samples.empty()) write(options, found.samples);
  print_refusals(found.looks);
  print(turns);
  const std::size_t count = found.looks.size();
  const std::string noun = options.bags.empty()                       ? "image"
                           : options.images.empty() && !options.every ? "standstill"
                                                                      : "view";
  const std::string seen = counted(count, noun);
  const std::vector<Sample>& samples = found.samples;
  std::string sheets;
  if (!options.sheet.empty()) {
    sheets = write_sheets(options.sheet, thumbnails_of(std::move(found.looks)));
  }
  if (samples.empty()) {
    say(stderr, "error: nothing was found in {}; {} was not written\n", seen, options.output);
    return kBadInput;
  }
  say("wrote {}: {} of {}: {}; {} refused{}\n", options.output, found.used, seen,
      counted(found.features, "feature"), count - found.used, count_of_targets(samples));
  if (!sheets.empty()) say("wrote {}\n", sheets);
  if (options.every) print_speed(samples, task.robot);
  // With the poses of a robot, each camera need not see what another one sees.
  print_lacks(samples, options.poses.empty() ? cameras_of(options) : std::vector<std::string>());
  return kDone;
}

}  // namespace kinecal::cli
