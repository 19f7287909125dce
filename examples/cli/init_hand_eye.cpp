// kinecal init --poses: a hand-eye calibration from poses of a flange, without a URDF.
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <set>
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
#include "kinecal/text/name_list.hpp"
#include "kinecal/text/nearest_name.hpp"
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
       {std::pair("--arm", options.arm), std::pair("--base", options.base),
        std::pair("--target-frame", options.target_frame),
        std::pair("--robot-camera-name", options.camera_name)}) {
    if (!value.empty()) {
      throw InputError(
          fmt::format("{} does not go with --poses, which has names of its own", option));
    }
  }
  if (!options.from.empty()) throw InputError("--from does not go with --poses");
  return *target;
}

/// The names of the cameras.
/// @throws InputError  if one cannot be a link of a URDF, or occurs twice
std::vector<std::string> cameras_of(const InitOptions& options) {
  if (options.camera.empty()) return {HandEyeNames::kCamera};
  const std::vector<std::string> names = names_of_list(options.camera);
  const std::set<std::string> taken = {HandEyeNames::kBase,   HandEyeNames::kFlange, "arm", "board",
                                       HandEyeNames::kTarget, HandEyeNames::kObject};
  std::set<std::string> before;
  for (const std::string& name : names) {
    const bool is_plain = std::all_of(name.begin(), name.end(), [](unsigned char c) {
      return std::isalnum(c) != 0 || c == '_' || c == '-';
    });
    if (!is_plain || std::isalpha(static_cast<unsigned char>(name.front())) == 0 ||
        taken.contains(name)) {
      throw InputError(fmt::format("--camera: '{}' cannot be the name of a camera{}", name,
                                   is_plain && taken.contains(name)
                                       ? ": something else has it"
                                       : ": give letters, digits, _ and -, a letter first"));
    }
    if (!before.insert(name).second) {
      throw InputError(
          fmt::format("--camera: '{}' occurs twice; each camera has a name of its own", name));
    }
  }
  if (names.empty()) throw InputError("--camera: no camera is named");
  return names;
}

/// The tables of --corners: FILE of one camera, NAME=FILE,... of several.
/// @throws InputError  if a camera has none, or two, or is unknown
std::vector<CameraCorners> corners_of(const InitOptions& options,
                                      const std::vector<std::string>& cameras) {
  if (options.corners.empty()) return {};
  if (cameras.size() == 1 && options.corners.find('=') == std::string::npos) {
    return {{cameras.front(), options.corners}};
  }
  std::vector<CameraCorners> tables;
  for (const std::string& entry : names_of_list(options.corners)) {
    const std::size_t equals = entry.find('=');
    const std::string name = entry.substr(0, equals);
    if (equals == std::string::npos || equals + 1 == entry.size()) {
      throw InputError(fmt::format(
          "--corners: '{}' is no NAME=FILE: each camera has a table of its own: {}=FILE", entry,
          fmt::join(cameras, "=FILE,")));
    }
    if (std::find(cameras.begin(), cameras.end(), name) == cameras.end()) {
      throw InputError(fmt::format("--corners: no camera '{}'{}; --camera names {}", name,
                                   did_you_mean(name, cameras), fmt::join(cameras, ", ")));
    }
    const auto same = [&](const CameraCorners& other) { return other.camera == name; };
    if (std::any_of(tables.begin(), tables.end(), same)) {
      throw InputError(fmt::format("--corners: camera '{}' has two tables", name));
    }
    tables.push_back({name, entry.substr(equals + 1)});
  }
  for (const std::string& camera : cameras) {
    const auto is_it = [&](const CameraCorners& table) { return table.camera == camera; };
    if (std::any_of(tables.begin(), tables.end(), is_it)) continue;
    throw InputError(fmt::format("--corners: camera '{0}' sees nothing: add {0}=FILE", camera));
  }
  return tables;
}

InitAnswers answers_of(const InitTargetWord& word, const std::string& camera, bool is_one,
                       const InitOptions& options) {
  InitAnswers answers;
  answers.target = word.target;
  answers.board = word.board;
  answers.base = HandEyeNames::kBase;
  answers.camera = answers.camera_name = camera;
  answers.known_lens =
      !is_one;  // each of several sees a part of the poses, which tell little of its lens
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
  const std::vector<std::string> cameras = cameras_of(options);
  std::vector<InitAnswers> answers;
  for (const std::string& camera : cameras)
    answers.push_back(answers_of(word, camera, cameras.size() == 1, options));
  const InitAnswers& any = answers.front();
  const bool on_hand = word.target == InitTarget::world_checkerboard;
  const std::filesystem::path folder = folder_of(options.output);
  const auto beside = [&](const char* name) {
    return folder == "." ? std::string(name) : (folder / name).string();
  };
  const std::string urdf = beside("hand_eye.urdf"), columns = beside("columns.yaml");
  const std::string capture = options.capture.empty() ? beside("capture.yaml") : options.capture;
  const HandEyeTables tables{.poses = options.poses,
                             .form = options.form,
                             .inverse = options.inverse,
                             .corners = corners_of(options, cameras),
                             .target = options.target_points,
                             .holder = holder_of(any),
                             .camera_on_hand = on_hand};
  const bool has_corners = !tables.corners.empty();
  std::vector<std::string> inputs = {options.poses, options.target_points, holder_of(any)};
  for (const CameraCorners& camera : tables.corners) inputs.push_back(camera.file);
  std::vector<std::string> outputs = {options.output, urdf, columns};
  if (!has_corners) outputs.push_back(capture);
  for (const std::string& output : outputs) check_output(output, inputs, options.force);

  const std::string urdf_text = hand_eye_urdf(on_hand, cameras);
  const Robot robot = parse_urdf(urdf_text, urdf);
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
  const bool is_rig = cameras.size() > 1;
  if (has_corners || is_rig) {
    for (const std::string& camera : cameras)
      inputs_of_calibrate.cameras.push_back(camera + "=" + camera + ".yaml");
  }
  if (has_corners) {
    say("next: {} && {}\n", convert_command(options.poses, columns).str(),
        calibrate_command(inputs_of_calibrate).str());
    return kDone;
  }
  write_output(capture, initial_capture(robot, any));
  say("wrote {}\n  fill in what is zero: its sizes decide the scale of the result\n", capture);
  const std::string frames = fmt::format("{}", fmt::join(cameras, ","));
  ShellCommand detect = ShellCommand{"kinecal", "detect", shell_file(capture), "--images", "images"}
                            .add_option("--poses", {options.poses})
                            .add_option("--columns", {columns});
  if (!is_rig) detect.add({"--camera", "camera.yaml"});
  detect.add({"--frame", frames, "-o", "samples.yaml"});
  say("next: {} && {}\n", detect.str(), calibrate_command(inputs_of_calibrate).str());
  if (is_rig) {
    say("  photographs of each camera are in its folder: images/{}; those of a pose have the name "
        "that its row has\n",
        fmt::join(cameras, ", images/"));
  }
  return kDone;
}

}  // namespace kinecal::cli
