// The program kinecal: its commands and their options.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/program.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "commands.hpp"
#include "describe.hpp"
#include "kinecal/files/poses/pose_numbers.hpp"
#include "kinecal/text/name_list.hpp"
#include "kinecal/text/nearest_name.hpp"
#include "kinecal/text/printable.hpp"
#include "kinecal/text/shell_command.hpp"
#include "kinecal/tools/init/init_answers.hpp"
#include "terminal.hpp"

namespace {

using namespace kinecal::cli;

/// The type of an option whose values help and completion list, as CLI11 writes it; the command refuses
/// others with better words.
std::string one_of(const std::string& type, const std::vector<std::string>& values) {
  std::string list;
  for (const std::string& value : values) list += (list.empty() ? "" : ",") + value;
  return type + ":{" + list + "}";
}

/// Refuses other values than a few words, which help and completion list.
CLI::Validator one_word_of(const std::vector<std::string>& words) {
  const auto check = [words](const std::string& value) -> std::string {
    if (std::find(words.begin(), words.end(), value) != words.end()) return "";
    return fmt::format("'{}' is not one of {}{}", kinecal::printable(value), fmt::join(words, ", "),
                       kinecal::did_you_mean(value, words));
  };
  return {check, one_of("", words).substr(1)};
}

/// Refuses what is not a number above zero, or above `most`.
CLI::Validator above_zero(double most, const std::string& unit) {
  const auto check = [most, unit](const std::string& value) -> std::string {
    double number = 0.0;
    if (CLI::detail::lexical_cast(value, number) && number > 0.0 && number <= most) return "";
    return fmt::format("'{}' is no number above 0 and at most {:g}{}", kinecal::printable(value),
                       most, unit.empty() ? "" : " " + unit);
  };
  return {check, ""};
}

/// A unit alone is no length: before a transformation takes it for one.
CLI::Validator with_a_number() {
  return {[](std::string& value) -> std::string {
            const bool has_digit = value.find_first_of("0123456789") != std::string::npos;
            return has_digit ? "" : "'" + kinecal::printable(value) + "' has no number";
          },
          ""};
}

std::vector<std::string> target_words() {
  std::vector<std::string> words;
  for (const kinecal::InitTargetWord& target : kinecal::kInitTargets)
    words.emplace_back(target.word);
  words.emplace_back(kinecal::kBaseTarget);
  words.emplace_back(kinecal::kMagnetometerTarget);
  return words;
}

void add_cameras(CLI::App& command, std::vector<std::string>& cameras) {
  command
      .add_option(
          "--camera", cameras,
          "intrinsics of a sensor that was recorded without camera_info: camera_info, Kalibr "
          "or OpenCV YAML; FILE:cam1 for one of several")
      ->type_name("NAME=FILE")
      ->allow_extra_args(false);
}

void add_urdf(CLI::App& command, std::string& urdf) {
  command.add_option("--urdf", urdf, "the robot's URDF; default: /robot_description of the bag")
      ->type_name("FILE");
}

/// An option that takes names, also several in one word: a,b.
CLI::Option* add_names(CLI::App& command, const std::string& flags, std::vector<std::string>& names,
                       const std::string& help) {
  return command
      .add_option_function<std::vector<std::string>>(
          flags,
          [&names](const std::vector<std::string>& lists) {
            for (const std::string& list : lists) {
              for (std::string& name : kinecal::names_of_list(list)) {
                names.push_back(std::move(name));
              }
            }
          },
          help)
      ->type_name("NAME");
}

CLI::Option* add_samples(CLI::App& command, std::vector<std::string>& samples) {
  return command
      .add_option("--samples", samples,
                  "recorded samples: CalibrationData in YAML, a ROS 1 bag, MCAP or a ROS 2 bag")
      ->type_name("FILE");
}

void add_mesh_path(CLI::App& command, std::vector<std::string>& paths) {
  command
      .add_option("--mesh-path", paths,
                  "folder of the URDF's packages, or of one of them, in which meshes are; beside "
                  "ROS_PACKAGE_PATH, AMENT_PREFIX_PATH and the folders above the URDF")
      ->type_name("DIR");
}

/// The options that say what is calibrated, from which samples.
/// @returns  --samples
CLI::Option* add_input(CLI::App& command, InputOptions& options) {
  add_urdf(command, options.urdf);
  command
      .add_option("--config", options.config,
                  "what to calibrate: a configuration of robot_calibration, ROS 1 or ROS 2")
      ->required()
      ->type_name("FILE");
  CLI::Option* samples = add_samples(command, options.samples);
  add_cameras(command, options.cameras);
  add_mesh_path(command, options.mesh_paths);
  add_names(command, "--hold", options.hold,
            "parameters that keep their initial values, though the configuration frees them");
  command
      .add_option_function<std::string>(
          "--samples-recorded",
          [&options](const std::string& when) {
            options.recorded =
                when == "before" ? kinecal::Recorded::before : kinecal::Recorded::after;
          },
          "before or after <calibration rising> of the URDF was written: after, the recorded "
          "positions contain it; before, it is added to them")
      ->check(one_word_of({"after", "before"}))
      ->default_str("after");
  return samples;
}

void add_offsets(CLI::App& command, std::string& offsets) {
  command
      .add_option(
          "--offsets", offsets,
          "where joint offsets go: rising adds them to <calibration rising>, origin puts them "
          "into the joints' <origin>, which all programs read, ros2_control adds them to <param "
          "name=\"offset\"> of the joint; default: ros2_control if it has that, else rising")
      ->check(one_word_of({"rising", "origin", "ros2_control"}));
}

void add_reader(CLI::App& command, std::string& reader) {
  command
      .add_option(
          "--reader", reader,
          "who reads the result, so whose errors are judged: driver applies "
          "calibration.yaml (true_position.hpp), urdf reads calibrated.urdf with its zeros, "
          "origins reads it without <calibration rising>; default: urdf")
      ->check(one_word_of({"driver", "urdf", "origins"}));
}

/// The files of the robot's programs.
void add_robot_files(CLI::App& command, RobotFileOptions& files) {
  command
      .add_option("--kinematics", files.kinematics,
                  "also write the origins of the joints, with their zeros, as YAML: UR's "
                  "calibration file, Franka's, or one with the names of the joints; of several "
                  "arms, for each: PREFIX=FILE, with what the names of its joints begin with")
      ->allow_extra_args(false)
      ->type_name("FILE");
  CLI::Option* zeros =
      command
          .add_option("--zeros", files.zeros,
                      "also write the zeros of the joints as a list, YAML: joint: number, to be "
                      "added to the reading; radians and metres")
          ->type_name("FILE");
  command.add_flag("--degrees", files.degrees, "--zeros in degrees and millimetres")->needs(zeros);
  CLI::Option* homing =
      command
          .add_option("--homing", files.homing,
                      "also add the zeros to the homing offsets of servos: JSON of LeRobot, which "
                      "is patched, and kept as FILE.backup_1")
          ->type_name("FILE");
  command
      .add_option("--servos", files.servos,
                  "make of these servos, which decides the sign: homing offsets of feetech are "
                  "subtracted from what the encoder reads, those of dynamixel are added")
      ->check(one_word_of({"feetech", "dynamixel"}))
      ->needs(homing)
      ->capture_default_str();
  command
      .add_option("--xacro", files.xacro,
                  "the xacro file that the URDF was made of: numbers that are literals there or in "
                  "files that it includes are patched, others are named with their lines")
      ->type_name("FILE");
}

/// How the command speaks.
void add_manner(CLI::App& command, Manner& manner) {
  command
      .add_option("--color", manner.color,
                  "auto: on a terminal, unless NO_COLOR is set; always; never")
      ->check(one_word_of({"auto", "always", "never"}))
      ->capture_default_str();
}

/// Options of results, but for the folder.
void add_results(CLI::App& command, ResultOptions& options) {
  add_offsets(command, options.offsets);
  add_reader(command, options.reader);
  add_robot_files(command, options.robot_files);
  command.add_flag("--upstream-names", options.upstream_names,
                   "name the files as robot_calibration does, with the date");
  command.add_flag("--force", options.force, "replace the results that are in the folder");
  command
      .add_option("--threads", options.threads,
                  "number of threads, default: one per core; the result does not depend on it")
      ->check(CLI::Range(1, 1024));
}

void add_reports(CLI::App& command, std::vector<std::string>& reports) {
  command
      .add_option(
          "--report", reports,
          "write a report, whatever the verdict: a page to look at if the name ends in .html, "
          "else report.json; may be given twice")
      ->allow_extra_args(false)
      ->type_name("FILE");
}

void add_calibrate_log(CLI::App& command, LogOptions& options) {
  add_input(command, options)->required();
  command
      .add_option("--output", options.output,
                  "output folder; processes that share it share the work, and an interrupted run "
                  "resumes in it")
      ->required()
      ->type_name("DIR");
  add_results(command, options);
  add_reports(command, options.reports);
  command
      .add_option(
          "--draw", options.draw,
          "samples, evenly from all files, by which causes, changes, held-out errors and bad "
          "captures are judged; the result, its +- and the noise are of all samples")
      ->check(CLI::Range(1, 1000000))
      ->capture_default_str();
}

void add_calibrate(CLI::App& command, CalibrateOptions& options) {
  options.nothing_free = kinecal::NothingFree::without_lists;
  add_input(command, options)->required();
  command.get_option("--config")
      ->required(false)
      ->description(
          "what to calibrate: a configuration of robot_calibration, ROS 1 or ROS 2; without one, "
          "or "
          "if it has neither free_params nor free_frames, what is free is searched for, as by "
          "'kinecal identify'");
  command.add_option("--output", options.output, "folder for the results")->type_name("DIR");
  add_results(command, options);
  command.add_flag("--dry-run", options.dry_run, "calibrate, but write nothing");
  add_manner(command, options.manner);
  CLI::Option* const quiet = command.add_flag("--quiet", options.manner.quiet, "print one line");
  CLI::Option* const json =
      command
          .add_flag("--json", options.manner.json,
                    "print report.json, and nothing else, on the standard output")
          ->excludes(quiet);
  command
      .add_flag("--verbose", options.manner.verbose,
                "also print values in radians and metres, and what each step did")
      ->excludes(quiet)
      ->excludes(json);
  add_reports(command, options.reports);
  command
      .add_option("--scene", options.scene,
                  "write the robot before and after, and what was measured, for Foxglove and "
                  "Lichtblick (.mcap), whatever the verdict")
      ->type_name("FILE");
  command
      .add_option("--exclude", options.exclude,
                  "leave out these samples: numbers from 1, in the order of the files")
      ->delimiter(',')
      ->type_name("N");
  command.add_flag(
      "--keep-outliers", options.keep_outliers,
      "use all samples; by default, outliers are left out: samples with a residual that "
      "chance exceeds once in 1000 recordings");
  command
      .add_option("--folds", options.folds,
                  "parts into which samples are divided for held-out errors; 0: leave-one-out")
      ->check(CLI::Range(0, 1000000))
      ->capture_default_str();
  add_names(
      command, "--between", options.between,
      "sensors, links or frames: also report how well the pose of each in each other is known: "
      "left,right,top");
  command
      .add_option(
          "--starts", options.starts,
          "also solve from N random starts, the same ones each time: joints up to 10 degrees "
          "or 2 cm off, frames up to 10 degrees and 5 cm; keeps the lowest minimum")
      ->check(CLI::Range(0, 100000))
      ->type_name("N");
  command
      .add_option("--cost", options.cost,
                  "how Ceres gets the samples: compressed sums them, stacked keeps every feature "
                  "(slower, for comparison)")
      ->check(one_word_of({"compressed", "stacked"}))
      ->capture_default_str();
}

void add_identify(CLI::App& command, IdentifyOptions& options) {
  add_urdf(command, options.urdf);
  command
      .add_option("--config", options.config,
                  "whose models, error blocks and unknown poses are kept; default: as of 'kinecal "
                  "init --from' "
                  "the samples")
      ->type_name("FILE");
  add_samples(command, options.samples)->required();
  add_cameras(command, options.cameras);
  add_names(command, "--hold", options.hold,
            "parameters, frames or candidates that keep their initial values");
  command.add_flag("--geometry-only", options.geometry_only,
                   "without joint models and lags, which a URDF cannot hold");
  command.add_option("-o,--output", options.output, "the configuration to write")
      ->type_name("FILE")
      ->capture_default_str();
  command.add_flag("--force", options.force, "replace the file");
  command
      .add_option(
          "--report", options.reports,
          "write a report of the calibration with what was found, and of the search, whatever the "
          "verdict: a page to look at if the name ends in .html, else report.json; may be given "
          "twice")
      ->allow_extra_args(false)
      ->type_name("FILE");
  add_mesh_path(command, options.mesh_paths);
}

void add_init(CLI::App& command, InitOptions& options) {
  CLI::Option* urdf =
      command
          .add_option("--urdf", options.urdfs,
                      "the robot's URDF; of several robots each: --urdf left=FILE --urdf "
                      "right=FILE, which are joined in robots.urdf")
          ->allow_extra_args(false)
          ->type_name("FILE");
  command
      .add_option("--stands", options.stands,
                  "where one of several robots stands, roughly: right=X,Y,Z,ROLL,PITCH,YAW in "
                  "metres and radians; by default it is found from nothing")
      ->needs(urdf)
      ->allow_extra_args(false)
      ->type_name("NAME=POSE");
  CLI::Option* poses =
      command
          .add_option("--poses", options.poses,
                      "instead of a URDF: a table of the flange's poses, or samples of MoveIt "
                      "Calibration or "
                      "easy_handeye2, for a hand-eye calibration; "
                      "writes hand_eye.urdf and columns.yaml, too.  --target says where the camera "
                      "is: world_... on the hand, else beside the robot")
          ->excludes(urdf)
          ->type_name("FILE");
  add_names(command, "--cameras", options.cameras,
            "instead of a robot: names of cameras that see a board which somebody holds; "
            "intrinsics, lenses and where they stand are found from photographs alone")
      ->excludes(urdf)
      ->excludes(poses);
  command
      .add_option(
          "--form", options.form,
          "what the columns of --poses are: quaternion_xyzw, quaternion_wxyz, "
          "rotation_vector, rpy, matrix, ur, abb, kuka, fanuc, doosan, yaskawa, ..., fixed_xyz, "
          "euler_zyx, ...; "
          "default: by their names, and by what the camera sees")
      ->needs(poses)
      ->type_name(one_of("FORM", kinecal::pose_form_names()));
  command.add_flag("--inverse", options.inverse, "--poses has the poses of the base in the flange")
      ->needs(poses);
  CLI::Option* corners =
      command
          .add_option(
              "--corners", options.corners,
              "a table of the corners seen (image, id, u, v), instead of photographs; with --poses "
              "(of several cameras: left=FILE,right=FILE) or --cameras (of several: a column "
              "camera)")
          ->type_name("FILE");
  corners->needs(command
                     .add_option("--target-points", options.target_points,
                                 "a table of where these corners are on the board (id, x, y, z)")
                     ->needs(corners)
                     ->type_name("FILE"));
  command.add_option("--output", options.output, "the configuration to write")
      ->type_name("FILE")
      ->capture_default_str();
  command
      .add_option("--from", options.from,
                  "recorded samples: target, camera and names are theirs, "
                  "nothing is asked; of a table (.csv, .tsv, .txt), "
                  "the meaning of its columns is proposed in columns.yaml")
      ->type_name("FILE");
  command
      .add_option("--capture", options.capture,
                  "the capture.yaml to write, with the same names; default: beside the output, if "
                  "there is none")
      ->type_name("FILE");
  command
      .add_option(
          "--target", options.targets,
          "what the robot is measured against: leds; checkerboard, apriltag or charuco (in the "
          "gripper); world_checkerboard, world_apriltag or world_charuco; tracker; ground, which "
          "also goes with another: leds,ground; robot (its own surface); or what the tip touches, "
          "with "
          "nothing but joints recorded: point, tool, sockets, plane, line, sphere, bar, distance; "
          "grip (one thing in both hands); gravity (an accelerometer); base (a mobile base: its "
          "wheels, odometry and gyroscope); or magnetometer, from recorded readings (--from)")
      ->delimiter(',')
      ->type_name(one_of("TARGET", target_words()));
  command
      .add_option(
          "--target-frame", options.target_frame,
          "frame_id of the board's corners or of the reflector in the samples (several reflectors: "
          "with commas), not a link of "
          "the URDF; default: 'checkerboard' or 'smr'.  Of a tip that touches: its link, if the "
          "URDF "
          "has one")
      ->type_name("NAME");
  command
      .add_option("--tracker-frame", options.tracker_frame,
                  "frame_id of the points of a tracker, default: 'tracker_frame'")
      ->type_name("NAME");
  command
      .add_option("--length", options.length,
                  "a length that is known, metres: of a bar, between two sockets, from a ball's "
                  "center to the tip")
      ->type_name("METRES");
  command
      .add_option(
          "--touched-link", options.touched_link,
          "link that carries what the tip touches; with grip: the other hand; default: the base, "
          "or the other of two arms")
      ->type_name("LINK");
  command
      .add_option("--touched-at", options.touched_at,
                  "where it is in that link, if that is known, metres: a bore of the robot's own "
                  "body.  This place is then held: a first joint is found, too")
      ->delimiter(',')
      ->expected(3)
      ->type_name("X,Y,Z");
  command
      .add_option("--arm", options.arm,
                  "link at the end of the arm; with target robot: frees the joints up to it")
      ->type_name("LINK");
  command
      .add_option("--camera", options.camera,
                  "the camera's optical frame; with --poses: names of cameras, left,right,top; "
                  "default: camera")
      ->type_name("LINK");
  command
      .add_option("--camera-type", options.camera_type,
                  "camera3d (points in metres), the default, or camera2d (pixels)")
      ->type_name(one_of("TYPE", {"camera2d", "camera3d"}));
  command
      .add_option("--robot-camera-name", options.camera_name,
                  "sensor_name of the camera in the samples, default: 'camera'")
      ->type_name("NAME");
  const auto add_of_base = [&](const char* name, auto& value, const char* says, const char* type) {
    return command.add_option(name, value, std::string("of a base: ") + says)->type_name(type);
  };
  constexpr double kWheel = 2.0, kBase = 20.0;  // metres
  add_of_base("--drive", options.drive,
              "odometry (as reported), differential, mecanum or tricycle (positions of wheels); "
              "default: what the recording has",
              "DRIVE");
  add_of_base("--seen", options.seen,
              "what shows how the base moved: wall (in scans) or pose (tracked)", "WHAT");
  add_of_base(
      "--sensor", options.sensor,
      "link of the laser or of what is tracked: its place on the base is that of the URDF or "
      "tf; default: the frame of the scans",
      "LINK");
  add_of_base(
      "--wheel-radius", options.wheel_radius,
      "nominal, metres; if the table counts ticks, metres a tick; default: that of the URDF",
      "METRES")
      ->check(above_zero(kWheel, "metres"));
  add_of_base("--track-width", options.track_width,
              "nominal distance of left and right wheels, metres; default: that of the URDF.  With "
              "--drive odometry: what the driver has, which 'install' corrects; default: not known",
              "METRES")
      ->check(above_zero(kBase, "metres"));
  add_of_base("--wheelbase", options.wheelbase,
              "nominal distance of the axles, metres; default: that of the URDF", "METRES")
      ->check(above_zero(kBase, "metres"));
  add_of_base(
      "--gyro-scale", options.gyro_scale,
      "scale of the gyroscope in its driver, rad/s a count, which 'install' corrects; default: "
      "not known",
      "FACTOR")
      ->check(above_zero(1e3, ""));
  command
      .add_option("--base", options.base,
                  "link in which measurements are compared; default: the root of the URDF")
      ->type_name("LINK");
  command.add_flag("--force", options.force, "replace the file that is there");
}

void add_simulate(CLI::App& command, SimulateOptions& options) {
  command.add_option("urdf,--urdf", options.urdf, "the robot's URDF")
      ->required()
      ->type_name("FILE");
  command.add_option("-o,--output", options.output, "folder for images and tables")
      ->required()
      ->type_name("DIR");
  CLI::Option* scene =
      command
          .add_option(
              "--scene", options.scene,
              "camera, target, errors, motion and faults in YAML; default: what the URDF allows")
          ->type_name("FILE");
  command
      .add_option(
          "--target", options.target,
          "checkerboard (default, apriltag if this build does not find it), apriltag, aprilgrid "
          "(Kalibr's), ground, robot (its own meshes: clouds; masks if the scene's camera is a "
          "camera2d), leds for a session, or base: a table of the drive of a mobile base")
      ->excludes(scene)
      ->check(one_word_of(
          {"checkerboard", "apriltag", "aprilgrid", "ground", "robot", "leds", "base"}));
  add_mesh_path(command, options.mesh_paths);
  command.add_option("--poses", options.poses, "number of images, default: 30")
      ->check(CLI::Range(1, 9999))
      ->type_name("N");
  command.add_option("--seed", options.seed, "random seed (default 1); each seed is another robot")
      ->excludes(scene)
      ->check(CLI::Range(1, 1000000000))
      ->type_name("N");
  command.add_flag("--force", options.force, "replace the images that are in the folder");
}

/// The options that say what is studied.
void add_study_files(CLI::App& command, StudyFiles& files) {
  command.add_option("--urdf", files.urdf, "the robot's URDF")->required()->type_name("FILE");
  command
      .add_option("--config", files.config,
                  "what is calibrated; default: a first configuration, as of `kinecal init`")
      ->type_name("FILE");
  CLI::Option* samples =
      command
          .add_option("--samples", files.samples,
                      "recorded samples: uses their poses and targets, simulates the measurements")
          ->type_name("FILE");
  command
      .add_option("--pose-file", files.pose_file,
                  "poses: YAML of robot_calibration, or a bag; default: generates them")
      ->excludes(samples)
      ->type_name("FILE");
  CLI::Option* scene =
      command
          .add_option("--scene", files.scene,
                      "camera, target, errors and noise in YAML, as of `kinecal simulate`")
          ->type_name("FILE");
  command
      .add_option(
          "--target", files.target,
          "checkerboard, apriltag, aprilgrid, leds, or robot: its own meshes; default: robot "
          "if the configuration compares them, else checkerboard")
      ->excludes(scene)
      ->excludes(samples)
      ->check(one_word_of({"checkerboard", "apriltag", "aprilgrid", "leds", "robot"}));
  add_mesh_path(command, files.mesh_paths);
  command.add_option("--seed", files.seed, "random seed (default 1) of robots and noise")
      ->check(CLI::Range(1, 1000000000))
      ->type_name("N");
}

void add_study(CLI::App& command, StudyOptions& options) {
  add_study_files(command, options);
  command
      .add_option("--poses", options.poses,
                  "samples of a calibration, several numbers; default: 100,50,25")
      ->delimiter(',')
      ->check(CLI::Range(1, 1000000))
      ->type_name("N");
  command.add_option("--repeat", options.repeats, "calibrations of each robot and number of poses")
      ->check(CLI::Range(1, 1000000))
      ->capture_default_str()
      ->type_name("N");
  command.add_option("--robots", options.robots, "simulated robots")
      ->check(CLI::Range(1, 100000000))
      ->capture_default_str()
      ->type_name("N");
  command
      .add_option("--ruined", options.ruined,
                  "fraction of samples with one wrong joint reading; default: from the scene")
      ->check(CLI::Range(0.0, 0.9))
      ->type_name("SHARE");
  command.add_flag("--free-targets", options.free_targets,
                   "compare with a calibration that also estimates the target pose of each sample "
                   "(as on the PR2)");
  command
      .add_option(
          "--limit", options.limit,
          "mean re-projection error above which a calibration counts as failed, greater than 0, "
          "metres (clouds) or pixels (photographs); "
          "default: 3 mm as in the paper, or 1 pixel")
      ->check(CLI::PositiveNumber);
  command.add_option("--threads", options.threads, "number of threads, default: one per core")
      ->check(CLI::Range(1, 1024));
  command
      .add_option("-o,--output", options.output,
                  "folder for tables and trials; an interrupted study resumes in it")
      ->type_name("DIR");
  command
      .add_option("--report", options.report,
                  "a page with charts and the tables, one file: its name ends in .html")
      ->type_name("FILE");
  command.add_flag("--force", options.force,
                   "replace the study that is in the folder, and the page");
}

/// Options of poses that are chosen.
void add_choice(CLI::App& command, StudyFiles& files, int& candidates, std::string& output,
                bool& force) {
  add_study_files(command, files);
  command
      .add_option("--have", files.have,
                  "poses in which samples exist already; the chosen ones come in addition")
      ->type_name("FILE");
  command.add_option("--candidates", candidates, "poses that are generated without --pose-file")
      ->check(CLI::Range(2, 5000))
      ->capture_default_str()
      ->type_name("N");
  command
      .add_option("-o,--output", output,
                  "file of the chosen poses: YAML of robot_calibration, or a bag by its name")
      ->type_name("FILE");
  command.add_flag("--force", force, "replace a file that exists");
}

CLI::Option* add_tell_apart(CLI::App& command, StudyFiles& files) {
  return add_names(
             command, "--tell-apart", files.tell_apart,
             "two candidates of 'kinecal identify' that explain the same: the poses that show "
             "which one is wrong; with --samples of a tracker, new poses between those of the "
             "samples")
      ->type_name("A,B");
}

void add_select_poses(CLI::App& command, SelectPosesOptions& options) {
  add_choice(command, options, options.candidates, options.output, options.force);
  command.add_option("--count", options.count, "poses to choose")
      ->check(CLI::Range(1, 5000))
      ->capture_default_str()
      ->type_name("N");
  command
      .add_option("--criterion", options.criterion,
                  "gripper: variance of the gripper in the camera; a: mean variance of the "
                  "parameters; d: volume of their uncertainty; e: the worst combination")
      ->check(one_word_of({"gripper", "a", "d", "e"}))
      ->capture_default_str();
  command
      .add_option("--distance", options.least_distance,
                  "treat poses as equal if every joint is within this fraction of its range")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  add_tell_apart(command, options);
  command.add_option("--failures", options.failures, "poses that may fail")
      ->check(CLI::Range(0, 100))
      ->capture_default_str()
      ->type_name("N");
  command.add_option("--random", options.random, "random sets to compare with")
      ->check(CLI::Range(1, 1000000))
      ->capture_default_str()
      ->type_name("N");
  command.add_option("--simulate", options.trials, "simulated calibrations of each set")
      ->check(CLI::Range(0, 100000))
      ->capture_default_str()
      ->type_name("N");
}

void add_plan(CLI::App& command, PlanOptions& options) {
  add_choice(command, options, options.candidates, options.output, options.force);
  CLI::Option* accuracy =
      command
          .add_option(
              "--accuracy", options.accuracy,
              "of the gripper in the camera frame, one standard deviation: \"gripper 0.5 mm\"")
          ->capture_default_str()
          ->type_name("TEXT");
  CLI::Option* report =
      command
          .add_option("--report", options.report,
                      "a page with the accuracy over the number of poses: its name ends in .html")
          ->type_name("FILE");
  add_tell_apart(command, options)->excludes(accuracy)->excludes(report);
}

void add_detect(CLI::App& command, DetectOptions& options) {
  command
      .add_option("config", options.config,
                  "what to look for: robot_calibration's capture.yaml; not with --masks")
      ->type_name("FILE");
  CLI::Option* images =
      command.add_option("--images", options.images, "folder of photographs: PNG, JPEG, BMP, TIFF")
          ->type_name("DIR");
  command
      .add_option(
          "--masks", options.masks,
          "folder of images in which some program has marked the robot: 255 where it is, else "
          "0; their edges are the features")
      ->type_name("DIR")
      ->excludes(images);
  CLI::Option* poses =
      command
          .add_option(
              "--poses", options.poses,
              "table of joint positions for --images or --masks, radians and metres: a column for "
              "each "
              "joint, and 'image' for the file's name; without it, the photographs are of a camera "
              "alone")
          ->type_name("FILE");
  command.add_option("--columns", options.columns, "what the table's columns mean, as for convert")
      ->needs(poses)
      ->type_name("FILE");
  CLI::Option* bag =
      command
          .add_option("--bag", options.bags,
                      "recording of images, clouds or scans, camera_info and joint states: ROS 1 "
                      "bag, ROS 2 bag "
                      "or MCAP; each standstill of the robot gives a sample; may be repeated")
          ->allow_extra_args(false)
          ->type_name("FILE");
  command
      .add_option("--led", options.led,
                  "which LEDs were on when, for a LedFinder: a topic of recordings whose messages "
                  "have led_code or data, or a table with columns time and code; default: the "
                  "gripper's commands, of robot_calibration_msgs/GripperLedCommandActionGoal")
      ->needs(bag)
      ->type_name("TOPIC|FILE");
  add_names(command, "--restless", options.restless,
            "joints that need not stand still in recordings, such as that of a scanner")
      ->allow_extra_args(false)
      ->type_name("JOINT");
  command
      .add_option("--every", options.every,
                  "a sample each so many seconds of a slow motion instead of one of each "
                  "standstill, with joint velocities, for the lag of a camera; 0.001 to 3600")
      ->needs(bag)
      ->type_name("SECONDS");
  command
      .add_option("--joints", options.joints,
                  "topics of joint states in recordings, default: all of sensor_msgs/JointState")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->type_name("TOPIC");
  command
      .add_option("--camera", options.camera,
                  "camera_info, a file of Kalibr or OpenCV (file.yaml:cam1 for one of several); "
                  "default: as recordings have it")
      ->type_name("FILE");
  command
      .add_option("--depth", options.depth,
                  "folder of depth images under the names of --images: 16-bit PNG, millimetres; or "
                  "topic of depth in recordings")
      ->type_name("DIR|TOPIC");
  command
      .add_option(
          "--urdf", options.urdf,
          "the robot's URDF, for regions in a link's frame and for boards that look the same "
          "when they are turned")
      ->type_name("FILE");
  command
      .add_option(
          "--board-link", options.board_link,
          "link that the board is fixed to, which shows whether it was seen turned; default: "
          "its frame_id, if that is a link")
      ->type_name("LINK");
  command
      .add_option(
          "--camera-link", options.camera_link,
          "link that the camera is fixed to, for the same; default: --frame, if that is a link")
      ->type_name("LINK");
  command
      .add_option("--frame", options.frame,
                  "the camera's optical frame, as the configuration of the calibration has it; "
                  "default: as recordings have it; of several cameras on a body, a,b: their "
                  "photographs are in the folders a and b of --images, those taken at once under "
                  "one name")
      ->type_name("NAME");
  command.add_option("-o,--output", options.output, "samples: .yaml, .bag or .mcap")
      ->required()
      ->type_name("FILE");
  command
      .add_option("--contact-sheet", options.sheet,
                  "page with pictures of all detections, HTML; more than 24: sheet-2.html, ...")
      ->type_name("FILE");
  command
      .add_option("--threads", options.threads,
                  "number of threads, default: one per core; the result does not depend on it")
      ->check(CLI::Range(1, 1024))
      ->type_name("N");
  command.add_flag("--force", options.force, "replace files that are there");
}

/// Configuration, address and URDF of a robot that is captured.
template <class Options>
void add_robot(CLI::App& command, Options& options) {
  command
      .add_option(
          "config", options.config,
          "chains that move and finders that look: capture.yaml of robot_calibration; of a mobile "
          "base, the configuration of its calibration")
      ->required()
      ->type_name("FILE");
  command
      .add_option("--robot", options.robot,
                  "ws://HOST:PORT of foxglove_bridge (ROS 1 or ROS 2), pipe:COMMAND, or "
                  "simulated:SCENE")
      ->required()
      ->type_name("ADDRESS");
  command
      .add_option("--urdf", options.urdf,
                  "the robot's URDF; default: /robot_description behind the bridge")
      ->type_name("FILE");
  command
      .add_option("--joint-states", options.joints,
                  "topic of the joint states behind a bridge; default: /joint_states")
      ->type_name("TOPIC");
}

void add_capture_poses(CLI::App& command, CapturePosesOptions& options) {
  add_robot(command, options);
  command.get_option("config")->required(false)->description(
      "chains whose joints are recorded and finders: capture.yaml of robot_calibration; default: "
      "all joints of the URDF, all finders");
  command
      .add_option("-o,--output", options.output,
                  "the poses, written at each Enter: .yaml, .bag (ROS 1) or .mcap")
      ->required()
      ->type_name("FILE");
  command.add_flag("--resume", options.resume, "add to the poses that the output has");
  command.add_flag("--force", options.force, "replace the file that is there");
}

/// An option that a script fills in with nothing is a mistake.
const CLI::Validator kNotEmpty(
    [](const std::string& text) { return text.empty() ? "must not be empty" : std::string(); }, "");

void add_capture(CLI::App& command, CaptureOptions& options) {
  add_robot(command, options);
  command.add_option("--poses", options.poses, "poses in YAML or in a bag")
      ->check(kNotEmpty)
      ->type_name("FILE");
  command.add_flag("--manual", options.manual,
                   "you move the robot by hand; each Enter records a sample");
  command
      .add_option("-o,--output", options.output,
                  "the samples, written after each pose: .yaml, .bag (ROS 1) or .mcap")
      ->required()
      ->type_name("FILE");
  command
      .add_option(
          "--depth", options.depth,
          "topic of depth images behind a bridge, registered to the images of capture.yaml's "
          "topics; default: these topics are clouds")
      ->check(kNotEmpty)
      ->type_name("TOPIC");
  command.add_option("--velocity", options.velocity, "speed, as a fraction of normal")
      ->check(CLI::Range(0.01, 1.0))
      ->capture_default_str();
  CLI::Option* drive = command.add_flag(
      "--drive", options.drive,
      "with the configuration of a mobile base: command it to turn in place, and ahead and "
      "back in front of a wall (1.5 rad/s and 0.2 m/s at most, times --velocity); "
      "without it, you drive");
  command
      .add_option("--distance", options.distance,
                  "length of each run ahead towards the wall, metres; default: 1")
      ->needs(drive)
      ->type_name("METRES");
  command
      .add_option(
          "--seconds", options.seconds,
          "record a base that you drive for so many seconds; default: until Enter or Ctrl-C")
      ->check(CLI::PositiveNumber)
      ->excludes(drive)
      ->type_name("S");
  command
      .add_option(
          "--topic", options.topics,
          "a topic of a base, for each KEY: odom (default: /odom), scan (/base_scan, /scan), "
          "commands (/cmd_vel), imu (/imu, /imu1/imu, /imu/data), wheels (/joint_states), or pose "
          "(a tracker's)")
      ->allow_extra_args(false)
      ->type_name("KEY=NAME");
  command.add_flag("--resume", options.resume,
                   "continue an interrupted session: record the poses that the output lacks");
  add_mesh_path(command, options.mesh_paths);
  CLI::Option* calibrate =
      command
          .add_option(
              "--calibrate", options.calibrate,
              "configuration: calibrate after each pose and print the gripper's uncertainty")
          ->check(kNotEmpty)
          ->type_name("FILE");
  command
      .add_option("--until", options.until,
                  "end when the pose is known this well, one sigma: \"gripper 1 mm\", "
                  "\"tool0 0.1 deg\"")
      ->needs(calibrate)
      ->check(kNotEmpty)
      ->type_name("ACCURACY");
  CLI::Option* result =
      command.add_option("--result", options.result, "calibrate at the end, into this folder")
          ->needs(calibrate)
          ->check(kNotEmpty)
          ->type_name("DIR");
  command
      .add_option(
          "--report", options.report,
          "a report of that calibration: a page to look at if the name ends in .html, else JSON")
      ->needs(result)
      ->check(kNotEmpty)
      ->type_name("FILE");
  command
      .add_option("--contact-sheet", options.sheet,
                  "page with pictures of all views and what was found in them, HTML; more than 24: "
                  "sheet-2.html, ...")
      ->check(kNotEmpty)
      ->type_name("FILE");
  command.add_flag("--force", options.force, "replace files that are there");
}

void add_convert(CLI::App& command, ConvertOptions& options) {
  command
      .add_option("input", options.input,
                  "samples or poses in YAML, a ROS 1 bag, MCAP, a ROS 2 bag, or a table")
      ->required()
      ->type_name("FILE");
  command
      .add_option("output", options.output,
                  "the file to write, in the format of its name: .yaml, .bag (ROS 1) or .mcap")
      ->required()
      ->type_name("FILE");
  command
      .add_option("--columns", options.columns,
                  "read the input as a table; this YAML file says what its columns mean")
      ->type_name("FILE");
  command.add_flag("--drop-clouds", options.drop_clouds,
                   "leave out point clouds and images; YAML never has them");
  command.add_flag("--force", options.force, "replace the file that is there");
}

void add_camera(CLI::App& command, CameraOptions& options) {
  command.add_option("file", options.file, "camera_info, Kalibr or OpenCV YAML; FILE:cam1")
      ->required()
      ->type_name("FILE");
  CLI::Option* output =
      command.add_option("--output", options.output, "write the camera to this file")
          ->type_name("FILE");
  command
      .add_option(
          "--keys", options.keys,
          "file: keys as in files of camera drivers; message: as in the ROS 2 message; kalibr "
          "or opencv: as these read it")
      ->check(one_word_of({"file", "message", "kalibr", "opencv"}))
      ->needs(output)
      ->capture_default_str();
  command.add_option("--name", options.name, "camera_name in the file; cam0 for Kalibr")
      ->needs(output)
      ->capture_default_str();
  command.add_flag("--force", options.force, "replace the file that is there")->needs(output);
}

/// The arguments as the parser expects them, the last one first.  The parser takes -.5 for an option,
/// so the numbers of rpy become -0.5.
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
      command.add_option("result", installing.result, "folder that calibrate wrote")
          ->type_name("DIR");
  command.add_option("--to", installing.folder, "folder of the robot's launch file")
      ->required()
      ->type_name("DIR");
  command.add_option("--launch", installing.launch, "name of the launch file")
      ->type_name("FILE")
      ->capture_default_str();
  command
      .add_option(
          "--name", installing.names,
          "set another name in the launch file than Fetch's: z_offset_mm=camera/z_offset_mm; "
          "KEY= leaves the key out")
      ->type_name("KEY=NAME")
      ->allow_extra_args(false);
  command.add_flag("--force", installing.force,
                   "install a result that did not converge or should not be used; restore a "
                   "version whose files are gone");
  CLI::Option* restore =
      command.add_flag("--restore", installing.restore, "put the previous version back")
          ->excludes(result);
  CLI::Option* date =
      command.add_flag("--date", installing.date, "print the date of the installed version")
          ->excludes(result)
          ->excludes(restore);
  command
      .add_option("--reset", installing.reset,
                  "put this launch file there, as the robot was delivered; --restore undoes it")
      ->type_name("FILE")
      ->excludes(result)
      ->excludes(restore)
      ->excludes(date);
}

void add_check(CLI::App& command, InputOptions& options) {
  add_input(command, options);
}

void add_inspect(CLI::App& command, std::vector<std::string>& samples) {
  command.add_option("samples", samples, "recorded samples")->required()->type_name("FILE");
}

/// When samples were recorded, of commands that hold them against a result.
void add_recorded(CLI::App& command, std::optional<kinecal::Recorded>& recorded) {
  command
      .add_option_function<std::string>(
          "--samples-recorded",
          [&recorded](const std::string& when) {
            recorded = when == "before" ? kinecal::Recorded::before : kinecal::Recorded::after;
          },
          "before or after calibrated.urdf and the calibrated cameras were installed; default: "
          "what fits better")
      ->check(one_word_of({"after", "before"}));
}

/// Result, samples, cameras and report of evaluate and verify.
void add_recheck(CLI::App& command, RecheckOptions& options) {
  command.add_option("result", options.result, "folder that calibrate wrote")
      ->required()
      ->type_name("DIR");
  command.add_option("samples", options.samples, "samples of the same robot, in any format")
      ->required()
      ->type_name("FILE");
  add_cameras(command, options.cameras);
  add_recorded(command, options.recorded);
  command.add_option("--report", options.report, "write what is found as JSON")->type_name("FILE");
  add_mesh_path(command, options.mesh_paths);
  add_manner(command, options.manner);
}

void add_evaluate(CLI::App& command, RecheckOptions& options) {
  add_recheck(command, options);
  command
      .add_option(
          "--fail-above", options.fail_above,
          "exit code 2 if the distances of an error block are more than that times those of "
          "samples that the calibration held out")
      ->check(CLI::PositiveNumber)
      ->type_name("TIMES");
}

void add_verify(CLI::App& command, RecheckOptions& options) {
  add_recheck(command, options);
  command
      .add_option("--level", options.level,
                  "false alarm rate: how often a valid result may be rejected")
      ->check(CLI::Range(1e-6, 0.5))
      ->capture_default_str();
}

void add_watch(CLI::App& command, WatchOptions& options) {
  command
      .add_option("tree", options.tree,
                  "folder of robots, each a folder with a result and the recordings that appear")
      ->required()
      ->type_name("DIR");
  command.add_flag("--once", options.once,
                   "look once: exit code 2 if a robot has to be calibrated again");
  command.add_option("--interval", options.interval, "seconds between looks, without --once")
      ->check(CLI::Range(0.1, 1e6))
      ->capture_default_str();
  command
      .add_option("--history", options.history, "file of the history, default: DIR/history.sqlite")
      ->type_name("FILE");
  command
      .add_option("--result", options.result,
                  "name of the folder, in that of a robot, that calibrate wrote")
      ->capture_default_str()
      ->type_name("NAME");
  command
      .add_option("--recordings", options.recordings,
                  "name of the folder, in that of a robot, where recordings appear")
      ->capture_default_str()
      ->type_name("NAME");
  command
      .add_option(
          "--limit", options.limit,
          "change of the gripper's pose that matters, greater than 0, in mm, or with a unit: "
          "0.5mm; default: three times the +- of the result")
      ->transform(CLI::AsNumberWithUnit(
          std::map<std::string, double>{{"mm", 1.0}, {"cm", 10.0}, {"m", 1000.0}, {"in", 25.4}},
          CLI::AsNumberWithUnit::CASE_SENSITIVE, "LENGTH"))
      ->transform(with_a_number())
      ->check(above_zero(1e6, "mm"))
      ->option_text("LENGTH");
  command
      .add_option("--ahead", options.ahead,
                  "calibrate again if the limit is reached within so many days")
      ->check(CLI::Range(0.0, 3650.0))
      ->capture_default_str();
  command
      .add_option("--level", options.level,
                  "false alarm rate: of a verdict on a recording, and of all robots together")
      ->check(CLI::Range(1e-6, 0.5))
      ->capture_default_str();
  command
      .add_option("--settle", options.settle,
                  "seconds without a change after which a recording is complete")
      ->check(CLI::Range(0.0, 1e6))
      ->capture_default_str();
  add_recorded(command, options.recorded);
  command
      .add_option("--report", options.report,
                  "write what is found: a page with charts if the name ends in .html, else JSON")
      ->type_name("FILE");
  command.add_flag("--json", options.manner.json,
                   "print JSON; without --once, a line whenever something is new");
  add_mesh_path(command, options.mesh_paths);
  add_manner(command, options.manner);
}

void add_grade(CLI::App& command, GradeOptions& options) {
  command.add_option("episodes", options.episodes, "recordings, or folders of them")
      ->required()
      ->type_name("FILE");
  CLI::Option* result =
      command
          .add_option("--result", options.result,
                      "folder that calibrate wrote; without it, each tenth of the episodes is held "
                      "against a calibration with the others")
          ->type_name("DIR");
  CLI::Option* urdf = command.add_option("--urdf", options.urdf, "the robot, without a result")
                          ->type_name("FILE")
                          ->excludes(result);
  CLI::Option* config =
      command.add_option("--config", options.config, "what is calibrated, without a result")
          ->type_name("FILE")
          ->excludes(result);
  urdf->needs(config);
  config->needs(urdf);
  add_cameras(command, options.cameras);
  add_recorded(command, options.recorded);
  command
      .add_option("--level", options.level,
                  "probability of naming any episode of a data set that is consistent")
      ->check(CLI::Range(1e-6, 0.5))
      ->capture_default_str();
  command.add_option("--report", options.report, "write what is found as JSON")->type_name("FILE");
  command.add_flag("--json", options.manner.json, "print it as JSON");
  add_mesh_path(command, options.mesh_paths);
  add_manner(command, options.manner);
}

void add_compare(CLI::App& command, CompareOptions& options) {
  command.add_option("a", options.a, "folder that calibrate wrote, the earlier one")
      ->required()
      ->type_name("DIR");
  command.add_option("b", options.b, "another one, of the same robot")
      ->required()
      ->type_name("DIR");
  command
      .add_option("--report", options.report,
                  "write what is found: a page to look at if the name ends in .html, else JSON")
      ->type_name("FILE");
}

void add_plot(CLI::App& command, PlotOptions& options) {
  command.add_option("report", options.report, "HTML that 'calibrate --report' wrote")
      ->required()
      ->type_name("FILE");
  command.add_option("names", options.names, "charts to write, default: all")->type_name("NAME");
  CLI::Option* list = command.add_flag("--list", options.list, "print the names of the charts");
  command.add_option("-o,--output", options.output, "folder for NAME.svg")
      ->type_name("DIR")
      ->excludes(list);
  command
      .add_option("--width", options.width,
                  "width of a chart on paper, in mm, or with a unit: 85mm (a column), 16cm, 3.5in")
      ->transform(CLI::AsNumberWithUnit(
          std::map<std::string, double>{{"mm", 1.0}, {"cm", 10.0}, {"in", 25.4}},
          CLI::AsNumberWithUnit::CASE_SENSITIVE, "LENGTH"))
      ->check(CLI::Range(10.0, 2000.0))
      ->option_text("LENGTH=160mm");
  command.add_flag("--force", options.force, "replace files that are in the folder");
  command.footer("As PDF: rsvg-convert -f pdf -o NAME.pdf NAME.svg");
}

void add_rpy(CLI::App& command, RpyOptions& options) {
  command.add_option("numbers", options.numbers, "A B C, or R P Y; radians")
      ->required()
      ->expected(3);
  command.add_flag("--to-vector", options.to_vector, "the numbers are roll, pitch, yaw");
  command.add_flag("--comma", options.comma,
                   "print the result alone, in radians with commas, as robot_calibration's to_rpy");
}

void add_describe(CLI::App& command, DescribeOptions& options) {
  command
      .add_option("format", options.format,
                  "man: a manual page; bash, zsh: completion of commands and options")
      ->required()
      ->check(one_word_of({"man", "bash", "zsh", "fish"}));
  command.add_option("--output", options.output, "the file to write")->type_name("FILE");
  command.add_flag("--force", options.force, "replace the file that is there");
}

/// An argument that begins like an option but is not one of the command; empty if absent.
std::string unknown_option(const CLI::App& command, const std::vector<std::string>& arguments) {
  for (auto argument = arguments.rbegin(); argument != arguments.rend(); ++argument) {
    std::string option = argument->substr(0, argument->find('='));
    if (!option.starts_with("--") || option == "--") continue;
    if (command.get_option_no_throw(option) == nullptr) return option;
  }
  return "";
}

/// Names of the options of a command: "--urdf".
std::vector<std::string> option_names(const CLI::App& command) {
  std::vector<std::string> names;
  for (const CLI::Option* option : command.get_options()) {
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  }
  return names;
}

/// The commands of the program, and which of them the arguments call.
class Commands {
 public:
  explicit Commands(CLI::App& app) : app_(app) {}

  /// @param describe  adds the options to the command
  /// @param run       runs the command
  template <class Options>
  void add(const char* name, const char* says, void (*describe)(CLI::App&, Options&),
           const std::function<int(const Options&)>& run) {
    const auto options = std::make_shared<Options>();
    names_.push_back(name);
    CLI::App* const command = app_.add_subcommand(name, says);
    describe(*command, *options);
    command->callback([this, options, run] { called_ = [=] { return run(*options); }; });
  }

  [[nodiscard]] int run_called() const { return called_(); }

  /// The message about wrong arguments.
  /// @param arguments  the last one first
  [[nodiscard]] std::string refusal(const std::vector<std::string>& arguments,
                                    const CLI::Error& error) const {
    const std::string first = arguments.empty() ? "" : arguments.back();
    std::string names;
    for (const std::string& name : names_) {
      if (name == first) return refusal_of(*app_.get_subcommand(name), arguments, error);
      names += (names.empty() ? "" : ", ") + name;
    }
    const std::string meant = kinecal::did_you_mean(first, names_);
    return "error: " +
           (first.empty() ? "no command is given" : "'" + first + "' is not a command") +
           (meant.empty() ? "; use one of " + names : meant) + "\n";
  }

 private:
  static std::string refusal_of(const CLI::App& command, const std::vector<std::string>& arguments,
                                const CLI::Error& error) {
    const std::string unknown = unknown_option(command, arguments);
    const std::string& name = command.get_name();
    std::string what = error.what();
    if (!unknown.empty()) {
      what = "'" + unknown + "' is not an option of '" + name + "'" +
             kinecal::did_you_mean(unknown, option_names(command));
    }
    return "error: " + what + (what.ends_with("?") ? " " : "; ") + "'kinecal " + name +
           " --help' lists its options\n";
  }

  CLI::App& app_;
  std::vector<std::string> names_;
  std::function<int()> called_;
};

/// The command line.
kinecal::ShellCommand command_line(int argc, char** argv) {
  kinecal::ShellCommand line{"kinecal"};
  for (int i = 1; i < argc; ++i) line.add({argv[i]});  // NOLINT: of main()
  return line;
}

/// Runs a command with the line by which it was called.
template <class Options>
std::function<int(const Options&)> with_line(const kinecal::ShellCommand& line,
                                             int (*run)(const Options&)) {
  return [line, run](Options options) {
    options.command = line;
    return run(options);
  };
}

/// @param line  the command line, for reports
void add_commands(Commands& commands, const kinecal::ShellCommand& line) {
  commands.add<InitOptions>(
      "init", "write a first configuration from a URDF; asks for what the options leave open",
      add_init, init);
  commands.add<IdentifyOptions>(
      "identify",
      "find out which parameters of the robot are wrong, and write a configuration that frees them",
      add_identify, with_line(line, identify));
  commands.add<InputOptions>(
      "check",
      "check the input without solving: errors, warnings, what the samples cannot determine",
      add_check, check);
  commands.add<CalibrateOptions>(
      "calibrate", "calibrate the robot and write its corrected URDF and camera files",
      add_calibrate, with_line(line, calibrate));
  commands.add<LogOptions>("calibrate-log",
                           "calibrate with recordings that do not fit into memory, file after "
                           "file, in several processes",
                           add_calibrate_log, with_line(line, calibrate_log));
  commands.add<RecheckOptions>("evaluate", "show how a result fits other samples, without solving",
                               add_evaluate, evaluate);
  commands.add<RecheckOptions>(
      "verify", "decide by a few new samples whether a result still holds, and what has moved",
      add_verify, verify);
  commands.add<WatchOptions>("watch",
                             "verify the recordings of many robots as they appear: which of them "
                             "drift, and when they have "
                             "to be calibrated again",
                             add_watch, watch);
  commands.add<GradeOptions>(
      "grade",
      "find the episodes of a data set in which the camera or a zero is not as in the others",
      add_grade, grade);
  commands.add<CompareOptions>("compare",
                               "list what differs between two results by more than its uncertainty",
                               add_compare, compare);
  commands.add<InstallOptions>(
      "install",
      "copy a result to the robot and update its launch file, or restore the previous version",
      add_install, install);
  commands.add<std::vector<std::string>>(
      "inspect", "show what is in recordings: topics, sensors, features, joints, gaps", add_inspect,
      inspect);
  commands.add<CaptureOptions>("capture",
                               "move a robot through poses and record what its finders see",
                               add_capture, capture);
  commands.add<CapturePosesOptions>(
      "capture_poses", "record the poses for capture: you move the robot by hand and press Enter",
      add_capture_poses, capture_poses);
  commands.add<DetectOptions>(
      "detect", "find boards and tags in photographs and recordings, and write samples", add_detect,
      detect);
  commands.add<SimulateOptions>("simulate",
                                "render photographs, clouds or masks of a simulated robot, or "
                                "record the drive of a mobile base, with known errors",
                                add_simulate, simulate);
  commands.add<StudyOptions>(
      "study", "calibrate simulated robots many times: how well it repeats, with how many poses",
      add_study, with_line(line, study));
  commands.add<SelectPosesOptions>(
      "select-poses", "choose few poses of many, so that a calibration is as good as possible",
      add_select_poses, select_poses);
  commands.add<PlanOptions>(
      "plan", "find how many poses, and which, an accuracy needs, and how long they take", add_plan,
      with_line(line, plan));
  commands.add<ConvertOptions>("convert", "write samples or poses in another format", add_convert,
                               convert);
  commands.add<CameraOptions>("camera", "show a camera file, and write it as camera_info",
                              add_camera, camera);
  commands.add<PlotOptions>("plot", "write the charts of a report as SVG files, for papers",
                            add_plot, plot);
  commands.add<RpyOptions>(
      "rpy",
      "convert a rotation vector (a b c of a free frame) to roll, pitch, yaw (a URDF's), or back",
      add_rpy, rpy);
}

/// No argument, `help` and `help COMMAND` are `--help` and `COMMAND --help`.  A word that is not a command stays, and
/// is refused.
void replace_help(const CLI::App& app, std::vector<std::string>& arguments) {
  if (arguments.empty()) arguments = {"help"};
  if (arguments.back() != "help") return;
  arguments.pop_back();
  const std::string command = arguments.empty() ? "" : arguments.back();
  if (command.empty() || command.starts_with("-")) {
    arguments = {"--help"};
  } else {
    const auto known = app.get_subcommands(
        [&](const CLI::App* candidate) { return candidate->get_name() == command; });
    arguments = !known.empty() ? std::vector<std::string>{"--help", command} : std::vector{command};
  }
}

/// The exit code, or an error if something that was printed did not arrive: on a full disk.
int if_printed(int code) {
  if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0) return code;
  std::fprintf(stderr, "error: cannot write to the standard output\n");
  return kBadInput;
}

int run(int argc, char** argv) {
  CLI::App app("Calibrates robots: corrects joint zeros, frames and cameras from recorded samples.",
               "kinecal");
  app.set_version_flag("--version", [] { return version() + "\n" + found_targets(); });
  app.require_subcommand(1);
  app.footer("'kinecal help COMMAND' lists the options of a command.");
  Commands commands(app);
  add_commands(commands, command_line(argc, argv));
  std::string of;
  app.add_subcommand("help", "show this help, or that of a command")
      ->add_option("command", of)
      ->type_name("COMMAND");
  commands.add<DescribeOptions>(
      "describe", "print a manual page or shell completion", add_describe,
      [&](const DescribeOptions& options) { return describe(app, options); });
  app.get_subcommand("describe")->group("");  // for those who make packages
  std::vector<std::string> arguments = arguments_of(argc, argv);
  replace_help(app, arguments);
  const std::vector<std::string> given = arguments;
  try {
    app.parse(arguments);
  } catch (const CLI::ParseError& e) {
    app.failure_message([&](const CLI::App*, const CLI::Error& error) {
      return kinecal::printable(commands.refusal(given, error));
    });
    std::ostringstream out, err;
    const bool is_help = app.exit(e, out, err) == 0;
    say("{}", out.str());
    say(stderr, "{}", err.str());
    return if_printed(is_help ? kDone : kBadInput);
  }
  return if_printed(commands.run_called());
}

}  // namespace

namespace kinecal {

int run_program(int argc, char** argv) {
  try {
    return run(argc, argv);
  } catch (const std::filesystem::filesystem_error& e) {  // such as a name that is too long
    const std::string what = e.path1().string() + ": " + e.code().message();
    std::fprintf(stderr, "error: %s\n", printable(cli::with_hanging_lines(what)).c_str());
  } catch (const std::exception& e) {
    std::fprintf(stderr, "error: %s\n", printable(cli::with_hanging_lines(e.what())).c_str());
  }
  return cli::kBadInput;
}

}  // namespace kinecal
