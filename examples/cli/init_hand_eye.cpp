// kinecal init --poses: a hand-eye calibration from poses of a flange, without a URDF.
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "commands.hpp"
#include "input.hpp"
#include "kinecal/files/csv/read_csv_samples.hpp"
#include "kinecal/files/poses/hand_eye_samples.hpp"
#include "kinecal/files/poses/pose_table.hpp"
#include "kinecal/files/results/file_set.hpp"
#include "kinecal/files/urdf/read_urdf.hpp"
#include "kinecal/text/counted.hpp"
#include "kinecal/tools/init/hand_eye.hpp"
#include "kinecal/tools/init/initial_capture.hpp"
#include "kinecal/tools/init/initial_config.hpp"
#include "output_file.hpp"
#include "terminal.hpp"

namespace kinecal::cli {
namespace {

/// @throws InputError  if no board is given, or options do not go together
InitTargetWord board_of(const InitOptions& options) {
  constexpr const char* kBoards =
      "checkerboard, apriltag or charuco if the flange carries the board and the camera stands "
      "beside the robot; world_checkerboard, world_apriltag or world_charuco if the flange carries "
      "the camera; marker or world_marker if the table also has the pose of a marker in the camera";
  if (options.targets.empty()) throw InputError(fmt::format("--target: give {}", kBoards));
  const auto target = init_target(options.targets.front());
  const bool is_board = target && (target->target == InitTarget::checkerboard ||
                                   target->target == InitTarget::world_checkerboard);
  if (options.targets.size() > 1 || !is_board) {
    throw InputError(fmt::format("--target: '{}' does not go with --poses: give {}",
                                 fmt::join(options.targets, ","), kBoards));
  }
  for (const auto& [option, value] :
       {std::pair("--arm", options.arm), std::pair("--camera", options.camera),
        std::pair("--base", options.base), std::pair("--target-frame", options.target_frame),
        std::pair("--robot-camera-name", options.camera_name)}) {
    if (!value.empty()) {
      throw InputError(
          fmt::format("{} does not go with --poses, which has names of its own", option));
    }
  }
  if (!options.from.empty()) throw InputError("--from does not go with --poses");
  return *target;
}

InitAnswers answers_of(const InitTargetWord& word, const InitOptions& options) {
  InitAnswers answers;
  answers.target = word.target;
  answers.board = word.board;
  answers.base = HandEyeNames::kBase;
  answers.camera = HandEyeNames::kCamera;
  answers.camera_name = "camera";
  answers.camera_type = options.camera_type.empty() ? "camera2d" : options.camera_type;
  answers.target_frame = HandEyeNames::kTarget;
  if (needs_arm(word.target)) answers.arm = HandEyeNames::kFlange;
  return answers;
}

}  // namespace

int init_hand_eye(const InitOptions& options) {
  const auto is_marker = [](const std::string& target) {
    return target == "marker" || target == "world_marker";
  };
  if (is_hand_eye_samples(options.poses) ||
      (options.targets.size() == 1 && is_marker(options.targets.front()))) {
    return init_hand_eye_samples(options);
  }
  const InitTargetWord word = board_of(options);
  if (options.corners.empty()) note_fault_of_target(word.word);
  const InitAnswers answers = answers_of(word, options);
  const std::filesystem::path folder = folder_of(options.output);
  const auto beside = [&](const char* name) {
    return folder == "." ? std::string(name) : (folder / name).string();
  };
  const std::string urdf = beside("hand_eye.urdf"), columns = beside("columns.yaml");
  const std::string capture = options.capture.empty() ? beside("capture.yaml") : options.capture;
  const bool has_corners = !options.corners.empty();
  std::vector<std::string> inputs = {options.poses, options.corners, options.target_points,
                                     holder_of(answers)};
  std::vector<std::string> outputs = {options.output, urdf, columns};
  if (!has_corners) outputs.push_back(capture);
  for (const std::string& output : outputs) check_output(output, inputs, options.force);

  const std::string urdf_text = hand_eye_urdf(word.target == InitTarget::world_checkerboard);
  const Robot robot = parse_urdf(urdf_text, urdf);
  const HandEyeTables tables{.poses = options.poses,
                             .form = options.form,
                             .inverse = options.inverse,
                             .corners = options.corners,
                             .target = options.target_points,
                             .holder = holder_of(answers),
                             .camera_on_hand = word.target == InitTarget::world_checkerboard};
  const std::string config = initial_config(robot, answers);
  Diagnostics diagnostics;
  write_output(columns, hand_eye_columns(tables, folder.string(), diagnostics));
  const CsvMapping mapping =
      read_csv_mapping(columns, diagnostics, has_corners ? CsvUse::samples : CsvUse::joints);
  const std::vector<Sample> samples =
      csv_samples(read_pose_table(options.poses), mapping, options.poses, diagnostics);
  print_or_throw(diagnostics);
  write_output(urdf, urdf_text);
  write_output(options.output, config);
  say("wrote {}, {} and {}\n  {} of the flange; {} says how the columns are read: look at it\n",
      urdf, columns, options.output, counted(samples.size(), "pose"), columns);
  InputOptions inputs_of_calibrate{
      .urdf = urdf, .config = options.output, .samples = {"samples.yaml"}};
  if (has_corners) {
    inputs_of_calibrate.cameras = {"camera=camera.yaml"};
    say("next: {} && {}\n", convert_command(options.poses, columns).str(),
        calibrate_command(inputs_of_calibrate).str());
    return kDone;
  }
  write_output(capture, initial_capture(robot, answers));
  say("wrote {}\n  fill in what is zero: its sizes decide the scale of the result\n", capture);
  const ShellCommand detect =
      ShellCommand{"kinecal", "detect", shell_file(capture), "--images", "images"}
          .add_option("--poses", {options.poses})
          .add_option("--columns", {columns})
          .add({"--camera", "camera.yaml", "--frame", HandEyeNames::kCamera, "-o", "samples.yaml"});
  say("next: {} && {}\n", detect.str(), calibrate_command(inputs_of_calibrate).str());
  return kDone;
}

}  // namespace kinecal::cli
