// kinecal init --cameras: a calibration of cameras alone, from photographs of a board.
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <filesystem>
#include <sstream>
#include <string>
#include <vector>

#include "commands.hpp"
#include "input.hpp"
#include "kinecal/config/cameras/initial_cameras.hpp"
#include "kinecal/config/own_frames.hpp"
#include "kinecal/config/read_config.hpp"
#include "kinecal/files/results/file_set.hpp"
#include "kinecal/files/samples/write_samples.hpp"
#include "kinecal/files/text_file.hpp"
#include "kinecal/files/urdf/read_urdf.hpp"
#include "kinecal/text/counted.hpp"
#include "kinecal/tools/init/hand_eye.hpp"
#include "kinecal/tools/init/initial_capture.hpp"
#include "output_file.hpp"
#include "terminal.hpp"

namespace kinecal::cli {

int init_cameras(const InitOptions& options) {
  if (!options.from.empty()) throw InputError("--from does not go with --cameras; give --target");
  const auto target =
      options.targets.size() == 1 ? init_target(options.targets.front()) : std::nullopt;
  if (!target || !is_board(target->target)) {
    throw InputError("--target: cameras alone see a board: checkerboard, apriltag or charuco");
  }
  note_fault_of_target(target->word);
  const std::filesystem::path folder = folder_of(options.output);
  const std::string capture = !options.capture.empty() ? options.capture
                              : folder == "."          ? "capture.yaml"
                                                       : (folder / "capture.yaml").string();
  check_output(options.output, {}, options.force);
  if (options.corners.empty()) check_output(capture, {}, options.force);
  const bool has_corners = !options.corners.empty();
  const std::string samples_file =
      folder == "." ? "samples.yaml" : (folder / "samples.yaml").string();
  if (has_corners)
    check_output(samples_file, {options.corners, options.target_points}, options.force);
  std::string text;
  try {
    text = initial_cameras(options.cameras);
  } catch (const std::invalid_argument& e) {
    throw InputError(fmt::format("--cameras: {}", e.what()));
  }
  Diagnostics diagnostics;
  const Config config = parse_config(text, options.output, diagnostics);
  print_or_throw(diagnostics);
  const Robot robot = parse_urdf(urdf_of_cameras(config), "cameras");
  InitAnswers answers;
  answers.target = InitTarget::world_checkerboard;
  answers.board = target->board;
  answers.base = answers.camera = answers.camera_name = options.cameras.front();
  answers.camera_type = "camera2d";
  answers.target_frame = answers.holder = "board";
  const std::string finder = initial_capture(robot, answers);
  if (has_corners) {
    const std::vector<Sample> samples =
        corner_samples(options.corners, options.target_points, options.cameras);
    std::ostringstream yaml;
    write_samples(yaml, samples);
    write_output(options.output, text);
    write_output(samples_file, yaml.str());
    say("wrote {} and {}: {}\n", options.output, samples_file, counted(samples.size(), "image"));
    say("next: {}\n",
        calibrate_command({.config = options.output, .samples = {samples_file}}).str());
    return kDone;
  }
  write_output(options.output, text);
  write_output(capture, finder);
  say("wrote {} and {}\n  fill in what is zero in {}: its sizes decide the scale\n", options.output,
      capture, capture);
  const ShellCommand detect =
      ShellCommand{"kinecal", "detect", shell_file(capture), "--images", "images"}
          .add_option("--frame", {fmt::format("{}", fmt::join(options.cameras, ","))})
          .add({"-o", "samples.yaml"});
  const InputOptions inputs{.config = options.output, .samples = {"samples.yaml"}};
  say("next: {} && {}\n", detect.str(), calibrate_command(inputs).str());
  if (options.cameras.size() > 1) {
    say("  photographs of each camera are in its folder: images/{}; those taken at once have the "
        "same name\n",
        fmt::join(options.cameras, ", images/"));
  }
  return kDone;
}

}  // namespace kinecal::cli
