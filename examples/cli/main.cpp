// kinecal: calibrates robots from a URDF, a configuration and recorded samples.
// SPDX-License-Identifier: Apache-2.0
#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <string>
#include <utility>
#include <vector>

#include "commands.hpp"

namespace {

using namespace kinecal::cli;

void add_input(CLI::App& command, std::string& urdf, std::string& config) {
  command.add_option("--urdf", urdf, "the robot's URDF")->required()->type_name("FILE");
  command
      .add_option("--config", config, "what is calibrated: robot_calibration's YAML, of ROS 1 or 2")
      ->required()
      ->type_name("FILE");
}

void add_cameras(CLI::App& command, std::vector<std::string>& cameras) {
  command
      .add_option("--camera", cameras,
                  "intrinsics of a sensor whose samples have none: camera_info, Kalibr or OpenCV "
                  "YAML; FILE:cam1 of several")
      ->type_name("NAME=FILE")
      ->allow_extra_args(false);
}

void add_camera(CLI::App& command, CameraOptions& options) {
  command.add_option("file", options.file, "camera_info, Kalibr or OpenCV YAML; FILE:cam1")
      ->required()
      ->type_name("FILE");
  CLI::Option* output =
      command.add_option("--output", options.output, "where it is written as camera_info")
          ->type_name("FILE");
  command.add_option("--keys", options.keys, "those of drivers' files, or of the ROS 2 message")
      ->check(CLI::IsMember({"file", "message"}))
      ->needs(output)
      ->capture_default_str();
  command.add_option("--name", options.name, "camera_name in the file")
      ->needs(output)
      ->capture_default_str();
}

/// The arguments in the order that the parser takes, the last one first.  It takes -.5 for an
/// option, and -0.5 for a number.
std::vector<std::string> arguments_of(int argc, char** argv) {
  const bool are_numbers = argc > 1 && std::string("rpy") == argv[1];
  std::vector<std::string> arguments;
  for (int i = argc - 1; i > 0; --i) {
    const std::string text = argv[i];
    const bool cut = are_numbers && text.starts_with("-.");
    arguments.push_back(cut ? "-0" + text.substr(1) : text);
  }
  return arguments;
}

void add_install(CLI::App& command, InstallOptions& installing) {
  CLI::Option* result =
      command.add_option("result", installing.result, "what calibrate wrote")->type_name("DIR");
  command.add_option("--to", installing.folder, "folder of the robot's launch file")
      ->required()
      ->type_name("DIR");
  command.add_option("--launch", installing.launch, "name of the launch file")
      ->type_name("FILE")
      ->capture_default_str();
  command
      .add_option("--name", installing.names,
                  "how the launch file calls what is set, where that is not as on Fetch: "
                  "z_offset_mm=camera/z_offset_mm; KEY= sets nothing")
      ->type_name("KEY=NAME")
      ->allow_extra_args(false);
  command.add_flag("--force", installing.force, "install what did not converge")->needs(result);
  CLI::Option* restore =
      command.add_flag("--restore", installing.restore, "take the last installation back")
          ->excludes(result);
  command.add_flag("--date", installing.date, "print the date of what is installed")
      ->excludes(result)
      ->excludes(restore);
}

int run(int argc, char** argv) {
  CLI::App app("Calibrates robots: corrects joint zeros, frames and cameras from recorded samples.",
               "kinecal");
  app.set_version_flag("--version", version());
  app.require_subcommand(1);

  CalibrateOptions calibrating;
  CLI::App* calibrate_command = app.add_subcommand(
      "calibrate", "calibrate the robot and write its corrected URDF and camera files");
  add_input(*calibrate_command, calibrating.urdf, calibrating.config);
  calibrate_command
      ->add_option("--samples", calibrating.samples, "recorded samples, CalibrationData YAML")
      ->required()
      ->type_name("FILE");
  add_cameras(*calibrate_command, calibrating.cameras);
  CLI::Option* output =
      calibrate_command->add_option("--output", calibrating.output, "folder for the results")
          ->type_name("DIR");
  calibrate_command
      ->add_option("--offsets", calibrating.offsets,
                   "where joint offsets are written: added to <calibration rising>, or folded into "
                   "<origin> for drivers that ignore it")
      ->check(CLI::IsMember({"rising", "origin"}))
      ->capture_default_str();
  calibrate_command->add_flag("--upstream-names", calibrating.upstream_names,
                              "name the files as robot_calibration does, with the date");
  calibrate_command->add_flag("--dry-run", calibrating.dry_run, "calibrate, but write nothing");
  calibrate_command
      ->add_option("--threads", calibrating.threads,
                   "how many threads share the work, one for each core by default; the result does "
                   "not depend on it")
      ->check(CLI::Range(1, 1024));
  calibrate_command
      ->add_option("--cost", calibrating.cost,
                   "how Ceres is given the samples: summed, or each feature by itself (slower, for "
                   "comparison)")
      ->check(CLI::IsMember({"compressed", "stacked"}))
      ->capture_default_str();

  CheckOptions checking;
  CLI::App* check_command =
      app.add_subcommand("check", "find every mistake in the input, without calibrating");
  add_input(*check_command, checking.urdf, checking.config);
  check_command->add_option("--samples", checking.samples, "recorded samples")->type_name("FILE");

  add_cameras(*check_command, checking.cameras);

  std::vector<std::string> inspected;
  CLI::App* inspect_command = app.add_subcommand(
      "inspect", "show what is in the samples: sensors, features, joint ranges, gaps");
  inspect_command->add_option("samples", inspected, "recorded samples")
      ->required()
      ->type_name("FILE");

  CameraOptions showing;
  CLI::App* camera_command =
      app.add_subcommand("camera", "show a camera file, and write it as camera_info");
  add_camera(*camera_command, showing);

  InstallOptions installing;
  CLI::App* install_command =
      app.add_subcommand("install", "put a result onto the robot: its files and its launch file");
  add_install(*install_command, installing);

  RpyOptions turning;
  CLI::App* rpy_command = app.add_subcommand(
      "rpy", "a rotation vector (a b c of a free frame) as roll, pitch, yaw (a URDF's), and back");
  rpy_command->add_option("numbers", turning.numbers, "A B C, or R P Y; radians")
      ->required()
      ->expected(3);
  rpy_command->add_flag("--to-vector", turning.to_vector, "the numbers are roll, pitch, yaw");

  try {
    std::vector<std::string> arguments = arguments_of(argc, argv);
    app.parse(std::move(arguments));
  } catch (const CLI::ParseError& e) {
    return app.exit(e) == 0 ? kDone : kBadInput;
  }
  if (*calibrate_command && output->empty() && !calibrating.dry_run) {
    std::fprintf(stderr, "error: --output is required (or --dry-run)\n");
    return kBadInput;
  }
  if (*install_command && installing.result.empty() && !installing.restore && !installing.date) {
    std::fprintf(stderr, "error: a result is required (or --restore, or --date)\n");
    return kBadInput;
  }
  int code = kDone;
  if (*calibrate_command) code = calibrate(calibrating);
  if (*check_command) code = check(checking);
  if (*inspect_command) code = inspect(inspected);
  if (*camera_command) code = camera(showing);
  if (*install_command) code = install(installing);
  if (*rpy_command) code = rpy(turning);
  if (std::fflush(stdout) == 0) return code;
  std::fprintf(stderr, "error: the output cannot be printed\n");
  return kBadInput;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run(argc, argv);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "error: %s\n", e.what());
  }
  return kBadInput;
}
