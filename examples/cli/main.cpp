// kinecal: calibrates robots from a URDF, a configuration and recorded samples.
// SPDX-License-Identifier: Apache-2.0
#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>

#include "commands.hpp"

namespace {

using namespace kinecal::cli;

void add_input(CLI::App& command, std::string& urdf, std::string& config) {
  command
      .add_option("--urdf", urdf,
                  "the robot's URDF; without it the bag's /robot_description is taken")
      ->type_name("FILE");
  command
      .add_option("--config", config, "what is calibrated: robot_calibration's YAML, of ROS 1 or 2")
      ->required()
      ->type_name("FILE");
}

void add_init(CLI::App& command, InitOptions& options) {
  command.add_option("--urdf", options.urdf, "the robot's URDF")->required()->type_name("FILE");
  command.add_option("--output", options.output, "the configuration to write")
      ->type_name("FILE")
      ->capture_default_str();
  command
      .add_option("--target", options.targets,
                  "what the robot is measured against: leds, checkerboard (in the gripper), "
                  "world_checkerboard, tracker or ground; ground may come with another")
      ->delimiter(',');
  command.add_option("--arm", options.arm, "link at the end of the arm")->type_name("LINK");
  command.add_option("--camera", options.camera, "the camera's optical frame")->type_name("LINK");
  command.add_option("--camera-type", options.camera_type,
                     "camera3d (points in metres, default) or camera2d (pixels)");
  command.add_option("--robot-camera-name", options.camera_name,
                     "sensor_name of the camera in the samples, by default 'camera'");
  command
      .add_option("--base", options.base,
                  "link in which everything is compared, by default the highest one")
      ->type_name("LINK");
  command.add_flag("--force", options.force, "replace the file that is there");
}

void add_convert(CLI::App& command, ConvertOptions& options) {
  command.add_option("input", options.input, "a table (.csv)")->required()->type_name("FILE");
  command.add_option("output", options.output, "samples to write, CalibrationData YAML")
      ->required()
      ->type_name("FILE");
  command.add_option("--columns", options.columns, "what the columns of the table mean, YAML")
      ->type_name("FILE");
  command.add_flag("--force", options.force, "replace the file that is there");
}

int run(int argc, char** argv) {
  CLI::App app(
      "Calibrates robots: corrects joint zeros, frames and cameras from recorded samples.");
  app.set_version_flag("--version", version());
  app.require_subcommand(1);

  CalibrateOptions calibrating;
  CLI::App* calibrate_command = app.add_subcommand(
      "calibrate", "calibrate the robot and write its corrected URDF and camera files");
  add_input(*calibrate_command, calibrating.urdf, calibrating.config);
  calibrate_command
      ->add_option("--samples", calibrating.samples,
                   "recorded samples: CalibrationData in YAML, a ROS 1 bag, MCAP or a ROS 2 bag")
      ->required()
      ->type_name("FILE");
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

  InitOptions starting;
  CLI::App* init_command =
      app.add_subcommand("init", "write a first configuration from a URDF: asks what is not given");
  add_init(*init_command, starting);

  ConvertOptions converting;
  CLI::App* convert_command =
      app.add_subcommand("convert", "write samples of another format as YAML");
  add_convert(*convert_command, converting);

  std::vector<std::string> inspected;
  CLI::App* inspect_command = app.add_subcommand(
      "inspect", "show what is in the samples: sensors, features, joint ranges, gaps");
  inspect_command->add_option("samples", inspected, "recorded samples")
      ->required()
      ->type_name("FILE");

  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    return app.exit(e) == 0 ? kDone : kBadInput;
  }
  if (*calibrate_command && output->empty() && !calibrating.dry_run) {
    std::fprintf(stderr, "error: --output is required (or --dry-run)\n");
    return kBadInput;
  }
  int code = kDone;
  if (*calibrate_command) code = calibrate(calibrating);
  if (*check_command) code = check(checking);
  if (*init_command) code = init(starting);
  if (*convert_command) code = convert(converting);
  if (*inspect_command) code = inspect(inspected);
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
