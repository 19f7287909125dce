// kinecal init --poses: a hand-eye calibration from poses of the flange and of a marker in the camera: samples of MoveIt
// Calibration or easy_handeye2, or a table.
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <span>
#include <sstream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "commands.hpp"
#include "input.hpp"
#include "kinecal/files/csv/read_csv_samples.hpp"
#include "kinecal/files/poses/hand_eye_samples.hpp"
#include "kinecal/files/results/file_set.hpp"
#include "kinecal/files/samples/write_samples.hpp"
#include "kinecal/text/counted.hpp"
#include "kinecal/tools/init/hand_eye.hpp"
#include "kinecal/tools/init/hand_eye_fit.hpp"
#include "output_file.hpp"
#include "terminal.hpp"

namespace kinecal::cli {
namespace {

/// Whether the camera is on the hand, by the target.
/// @throws InputError  if no target is given that says it, or options do not go together
bool is_camera_on_hand(const InitOptions& options) {
  constexpr std::array<std::string_view, 4> kTargets = {"marker", "checkerboard", "apriltag",
                                                        "charuco"};
  for (const auto& [option, value] :
       {std::pair("--corners", options.corners),
        std::pair("--target-points", options.target_points), std::pair("--arm", options.arm),
        std::pair("--camera", options.camera), std::pair("--base", options.base),
        std::pair("--target-frame", options.target_frame),
        std::pair("--capture", options.capture)}) {
    if (!value.empty()) {
      throw InputError(fmt::format("{} does not go with {}, which has poses of the object", option,
                                   options.poses));
    }
  }
  const std::string given = options.targets.size() == 1 ? options.targets.front() : "";
  const bool on_hand = given.starts_with("world_");
  const std::string word = on_hand ? given.substr(6) : given;
  if (std::find(kTargets.begin(), kTargets.end(), word) == kTargets.end()) {
    throw InputError(
        "--target: give marker if the flange carries the marker or board and the camera stands "
        "beside the robot; world_marker if the flange carries the camera");
  }
  return on_hand;
}

/// A doubt if the poses fit a camera in the other place much better.
void doubt_the_target(const InitOptions& options, bool on_hand, std::span<const Sample> samples,
                      Diagnostics& diagnostics) {
  constexpr double kTimes = 3.0, kLeast = 5e-3;  // metres
  const double given = fit_hand_eye(samples, on_hand).difference,
               other = fit_hand_eye(samples, !on_hand).difference;
  if (!(given > kLeast && given > kTimes * other)) return;
  const auto words = [](bool hand) { return hand ? "on the hand" : "beside the robot"; };
  diagnostics.doubt(
      {options.poses, 0},
      fmt::format("the poses fit a camera {} (to {:.1f} mm), not one {} ({:.1f} mm): is "
                  "--target {} meant{}?",
                  words(!on_hand), 1e3 * other, words(on_hand), 1e3 * given,
                  on_hand ? "marker" : "world_marker",
                  options.inverse ? ", or the file without --inverse" : ""));
}

}  // namespace

int init_hand_eye_samples(const InitOptions& options) {
  const bool on_hand = is_camera_on_hand(options);
  const std::filesystem::path folder = folder_of(options.output);
  const auto beside = [&](const char* name) {
    return folder == "." ? std::string(name) : (folder / name).string();
  };
  const std::string urdf = beside("hand_eye.urdf"), samples_file = beside("hand_eye_samples.yaml"),
                    columns = beside("columns.yaml");
  const bool is_table = !is_hand_eye_samples(options.poses);
  if (!is_table && !options.form.empty()) {
    throw InputError(
        fmt::format("--form does not go with {}, which says what its poses are", options.poses));
  }
  std::vector<std::string> outputs = {options.output, urdf, samples_file};
  if (is_table) outputs.push_back(columns);
  for (const std::string& output : outputs) check_output(output, {options.poses}, options.force);

  Diagnostics diagnostics;
  std::vector<Sample> samples;
  if (is_table) {
    const HandEyeTables tables{.poses = options.poses,
                               .form = options.form,
                               .inverse = options.inverse,
                               .camera_on_hand = on_hand,
                               .has_marker = true};
    write_text_file(columns, hand_eye_columns(tables, folder.string(), diagnostics));
    samples = read_csv_samples(options.poses, columns, diagnostics);
  } else {
    samples = read_hand_eye_samples(options.poses, on_hand, diagnostics);
    for (Sample& sample : samples) {
      Pose<double>& pose = sample.poses.at(HandEyeNames::kFlangeJoint);
      if (options.inverse) pose = pose.inverse();
    }
  }
  if (diagnostics.errors.empty()) doubt_the_target(options, on_hand, samples, diagnostics);
  print_or_throw(diagnostics);
  std::ostringstream text;
  write_samples(text, samples);
  write_output(urdf, hand_eye_urdf(on_hand));
  write_output(options.output, hand_eye_pose_config(on_hand));
  write_output(samples_file, text.str());
  say("wrote {}, {} and {}\n  {} of the flange and of the object in the camera, which is {}\n",
      urdf, options.output, samples_file, counted(samples.size(), "pose"),
      on_hand ? "on the hand" : "beside the robot");
  if (is_table) {
    say("  {} says how the columns were read: look at it; after changes: {}\n", columns,
        ShellCommand{"kinecal", "convert", shell_file(options.poses), shell_file(samples_file),
                     "--force"}
            .add_option("--columns", {columns})
            .str());
  }
  const InputOptions inputs{.urdf = urdf, .config = options.output, .samples = {samples_file}};
  say("next: {}\n", calibrate_command(inputs).str());
  return kDone;
}

}  // namespace kinecal::cli
