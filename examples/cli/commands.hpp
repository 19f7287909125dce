// The commands of the program.  Each returns an exit code.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "kinecal/config/config.hpp"
#include "kinecal/config/doubts/rising.hpp"
#include "kinecal/text/shell_command.hpp"
#include "terminal.hpp"

namespace kinecal::cli {

/// 0: done; 1: bad input; 2: the verdict is "do not use", the solver did not converge, or a result does
/// not hold any more.
enum ExitCode { kDone = 0, kBadInput = 1, kNotUsable = 2, kInterrupted = 130 };

/// What is calibrated, from which samples.
struct InputOptions {
  std::string urdf = {};                     ///< empty: the /robot_description of the samples' bag
  std::string urdf_text = {};                ///< content of a URDF, if neither is there
  std::string config = {};                   ///< file
  std::string config_text = {};              ///< content of a configuration, if there is no file
  std::vector<std::string> samples = {};     ///< files
  std::vector<std::string> cameras = {};     ///< NAME=FILE, for samples without camera_info
  std::vector<std::string> hold = {};        ///< parameters that are not calibrated
  std::vector<int> exclude = {};             ///< samples to leave out, from 1
  std::vector<std::string> mesh_paths = {};  ///< where the URDF's packages may be
  Recorded recorded = Recorded::after;       ///< the samples, and <calibration rising>
  bool is_part = false;                      ///< there are more samples: these may be few
  /// Unless it is an error, a configuration may be missing, and what is free is searched for: always if it is allowed,
  /// else if the configuration leaves it open.
  NothingFree nothing_free = NothingFree::is_error;
};

/// Files of the robot's own programs that the calibration is written into; empty: none.
struct RobotFileOptions {
  std::vector<std::string> kinematics;  ///< origins, YAML: FILE, or PREFIX=FILE of each arm
  std::string zeros;                    ///< list of zeros, YAML
  bool degrees = false;                 ///< of these: else radians
  std::string homing;                   ///< homing offsets of servos, JSON of LeRobot
  std::string servos = "feetech";       ///< their make
  std::string xacro;                    ///< what the URDF was made of

  /// Their names; empty ones among them.
  [[nodiscard]] std::vector<std::string> files() const;
};

/// What is calibrated, and where the result goes.
struct ResultOptions : InputOptions {
  std::string output;   ///< folder
  std::string offsets;  ///< rising, origin or ros2_control; empty: ros2_control where it has one
  std::string reader;   ///< driver, urdf or origins: of the results; empty: urdf
  RobotFileOptions robot_files = {};
  bool upstream_names = false;
  bool force = false;  ///< replace results
  int threads = 0;     ///< zero: one per core
};

struct CalibrateOptions : ResultOptions {
  std::vector<std::string>
      reports;  ///< files: a page if it ends in .html, else JSON; whatever the verdict
  ShellCommand command = {};   ///< as the user typed it, for the report
  std::string scene;           ///< MCAP for viewers; whatever the verdict
  bool keep_outliers = false;  ///< use samples that do not fit the others
  bool dry_run = false;
  int folds = 5;                     ///< for held-out errors; 0: leave-one-out
  int starts = 0;                    ///< random ones, beside the one of the configuration
  std::vector<std::string> between;  ///< sensors, links or frames: +- of the pose of one in another
  std::string cost = "compressed";
  Manner manner = {};
};

/// Calibrates the robot and writes the results, all or none.
int calibrate(const CalibrateOptions& options);

struct LogOptions : CalibrateOptions {
  int draw = 3000;  ///< samples on which the log is judged
};

/// Calibrates with recordings that are read one after another, never all at once; several processes
/// share them.
int calibrate_log(const LogOptions& options);

/// Checks what can be known of the results before the work.
/// @throws OutputError  if the folder cannot be written to, or has files that may not be replaced
void check_results(const ResultOptions& options);

/// Lists every error in the input and what the samples cannot determine, without calibrating.
int check(const InputOptions& options);

/// Shows what is in recordings.
int inspect(const std::vector<std::string>& samples);

struct InitOptions {
  std::vector<std::string> urdfs;   ///< a file, or NAME=FILE of each of several robots
  std::vector<std::string> stands;  ///< NAME=X,Y,Z,ROLL,PITCH,YAW of some of them
  std::string urdf = {};            ///< of the robot, or of all of them: written beside the output
  std::string output = "calibrate.yaml";
  std::string capture;            ///< file; empty: capture.yaml beside the output
  std::vector<std::string> from;  ///< samples that give the answers; empty: ask
  std::string base, arm, camera, camera_type, camera_name;  ///< empty: ask, or propose
  std::string target_frame, tracker_frame;                  ///< the same
  std::vector<std::string> targets;
  std::optional<double> length;    ///< of what the tip touches, metres
  std::string touched_link;        ///< that carries it; empty: the base
  std::vector<double> touched_at;  ///< a known place on it: three numbers, metres; empty: not known
  std::vector<std::string> cameras;  ///< names of cameras alone, instead of a robot
  std::string poses;     ///< table of poses of the flange, or samples of another program,
                         ///< instead of a URDF; or empty
  std::string form;      ///< of these poses; empty: by the names of columns
  bool inverse = false;  ///< they are those of the base in the flange
  std::string corners, target_points;  ///< tables beside them; empty: photographs
  std::string drive, seen, sensor;     ///< of a base: see tools/init/initial_base.hpp; empty: ask
  std::optional<double> wheel_radius, track_width, wheelbase,
      gyro_scale;      ///< of it, metres; a factor
  bool force = false;  ///< replace a file
};

/// Writes the configuration of a mobile base; of a table, columns.yaml, too, and without a URDF one of the base alone.
int init_base(const InitOptions& options);

/// Writes a URDF, columns.yaml, a configuration and, for photographs, capture.yaml from poses of a
/// flange.
int init_hand_eye(const InitOptions& options);

/// Writes a URDF, a configuration and samples from the poses of a flange and of an object in the camera
/// which another program of hand-eye calibration saved, or which are in a table: then columns.yaml, too.
int init_hand_eye_samples(const InitOptions& options);

/// Writes the configuration and capture.yaml of a calibration of cameras alone.
int init_cameras(const InitOptions& options);

/// Writes the configuration of a magnetometer from its readings; without --urdf, a URDF of it alone, too.
int init_magnetometer(const InitOptions& options);

/// Writes a first configuration from a URDF and a few answers.
int init(const InitOptions& options);

struct IdentifyOptions : InputOptions {
  std::string output = "identified.yaml";  ///< file
  bool geometry_only = false;              ///< no joint models
  bool force = false;                      ///< replace it
  std::vector<std::string> reports;        ///< files: a page if it ends in .html, else JSON
  ShellCommand command = {};               ///< as the user typed it, for the report
};

/// Finds out which parameters of a robot are wrong, and writes a configuration that frees them.
int identify(const IdentifyOptions& options);

struct DetectOptions {
  std::string config;                 ///< capture.yaml
  std::string images;                 ///< folder; empty: none
  std::string masks = {};             ///< folder of masks of the robot; empty: none
  std::string poses;                  ///< table of joint positions, for the images
  std::string columns;                ///< what its columns mean; empty: each is a joint
  std::vector<std::string> bags;      ///< recordings
  std::vector<std::string> joints;    ///< topics of joint states in recordings; empty: all
  std::vector<std::string> restless;  ///< joints that need not stand still in recordings
  std::optional<double> every;        ///< seconds between views of a motion; nullopt: standstills
  std::string depth;        ///< folder of the images' depth, or topic of recordings; empty: none
  std::string led;          ///< topic or table of codes of LEDs in recordings; empty: by type
  std::string camera;       ///< file; empty: none
  std::string urdf;         ///< file; empty: none
  std::string board_link;   ///< that holds boards; empty: their frame, if it is a link
  std::string camera_link;  ///< that holds the camera; empty: its frame, if it is a link
  std::string frame;        ///< of the camera; empty: as recordings have it
  std::string output;       ///< samples
  std::string sheet;        ///< HTML; empty: none
  int threads = 0;          ///< zero: one per core
  bool force = false;       ///< replace files
};

/// Writes samples of what finders find in photographs and recordings.
int detect(const DetectOptions& options);

struct DescribeOptions {
  std::string format;  ///< man, bash or zsh
  std::string output;  ///< empty: the standard output
  bool force = false;  ///< replace a file
};

struct ConvertOptions {
  std::string input, output;
  std::string columns;       ///< what the columns of a table mean
  bool drop_clouds = false;  ///< leave out images and point clouds
  bool force = false;        ///< replace a file
};

/// Writes samples or poses in another format.
int convert(const ConvertOptions& options);

struct CameraOptions {
  std::string file;    ///< or file:cam1
  std::string output;  ///< empty: none
  std::string keys = "file", name = "camera";
  bool force = false;  ///< replace a file
};

/// Shows a camera file, and writes it as camera_info.
int camera(const CameraOptions& options);

struct RecheckOptions {
  std::string result;                   ///< folder that calibrate wrote
  std::vector<std::string> samples;     ///< new ones
  std::vector<std::string> cameras;     ///< NAME=FILE
  std::optional<Recorded> recorded;     ///< before or after the result was installed
  std::vector<std::string> mesh_paths;  ///< where the URDF's packages may be
  std::string report;                   ///< JSON is written there
  double level = 0.01;                  ///< of verify: share of false alarms
  double fail_above =
      0.0;  ///< of evaluate: exit code 2 beyond that times the held-out error; 0: never
  Manner manner = {};
};

/// Shows how a result fits other samples; nothing is solved.
int evaluate(const RecheckOptions& options);

/// Decides whether a result still holds for a few new samples, and what has moved if not.
int verify(const RecheckOptions& options);

struct WatchOptions {
  std::string tree;               ///< folder
  std::string history;            ///< file; empty: history.sqlite in the tree
  std::string result = "result";  ///< folders of a robot
  std::string recordings = "recordings";
  std::optional<Recorded> recorded;     ///< before or after the result was installed
  std::vector<std::string> mesh_paths;  ///< where the URDF's packages may be
  std::string report;                   ///< a page or JSON is written there
  double limit = 0.0;                   ///< millimetres; 0: three times the +- of the result
  double ahead = 7.0;                   ///< days
  double level = 0.01;                  ///< share of false alarms
  double settle = 10.0;                 ///< seconds after which a file is no longer written to
  double interval = 60.0;               ///< seconds between looks
  bool once = false;                    ///< look once
  Manner manner = {};
};

/// Verifies the recordings of many robots as they appear, and says which of them have to be calibrated again.
int watch(const WatchOptions& options);

struct GradeOptions {
  std::vector<std::string> episodes;  ///< files, or folders of them
  std::string result;        ///< folder that calibrate wrote; empty: the episodes are calibrated
  std::string urdf, config;  ///< files, without a result
  std::vector<std::string> cameras;     ///< NAME=FILE
  std::optional<Recorded> recorded;     ///< before or after the result was installed
  std::vector<std::string> mesh_paths;  ///< where the URDF's packages may be
  std::string report;                   ///< JSON is written there
  double level = 0.01;  ///< probability of naming any episode of a consistent data set
  Manner manner = {};
};

/// Finds the episodes of a data set in which the camera or a zero is not as in the others.
int grade(const GradeOptions& options);

struct CompareOptions {
  std::string a, b;    ///< folders that calibrate wrote
  std::string report;  ///< JSON is written there
};

/// Lists what differs between two results by more than its uncertainty.
int compare(const CompareOptions& options);

struct SimulateOptions {
  std::string urdf, output;
  std::string scene;                         ///< file; empty: defaults
  std::string target;                        ///< empty: the scene's
  std::vector<std::string> mesh_paths = {};  ///< where the URDF's packages may be
  int poses = 0;                             ///< zero: the scene's
  int seed = 0;                              ///< zero: the scene's
  bool force = false;                        ///< replace what is in the folder
};

/// Photographs a simulated robot that differs from its URDF by known errors.
int simulate(const SimulateOptions& options);

/// What a study, a selection or a plan is about.
struct StudyFiles {
  std::string urdf, config;          ///< files; without a configuration, a first one
  std::vector<std::string> samples;  ///< recorded ones, whose features are simulated anew
  std::string pose_file;             ///< poses; without them and samples, poses are generated
  std::string have;                  ///< poses in which samples exist already
  std::string scene;                 ///< file; empty: defaults
  std::string target;                ///< empty: the scene's
  std::vector<std::string> mesh_paths = {};  ///< where the URDF's packages may be
  int seed = 0;                              ///< zero: the scene's
  std::vector<std::string> tell_apart = {};  ///< two candidates of identify; empty: none
  ShellCommand command = {};                 ///< as the user typed it, for the page
};

struct StudyOptions : StudyFiles {
  int robots = 3, repeats = 10;
  std::vector<int> poses;     ///< samples of a calibration; empty: 100, 50, 25
  double ruined = -1.0;       ///< share of ruined samples; below zero: the scene's
  bool free_targets = false;  ///< also say what six unknowns for each target would give
  double limit = 0.0;  ///< mean re-projection error beyond which a calibration failed; zero: 3 mm
                       ///< as in the paper, or 1 pixel
  int threads = 0;     ///< zero: one per core
  std::string output;  ///< folder; empty: only print
  std::string report;  ///< page with charts; empty: none
  bool force = false;  ///< replace results, and forget a study that was interrupted
};

/// Calibrates simulated robots many times and prints how well that repeats.
int study(const StudyOptions& options);

struct SelectPosesOptions : StudyFiles {
  int count = 25;
  std::string criterion = "gripper";
  int candidates = 200;          ///< poses that are generated
  double least_distance = 0.02;  ///< of poses, share of the range of the joint that differs most
  int failures = 0;              ///< poses that may fail
  int random = 1000;             ///< random sets, for comparison
  int trials = 100;              ///< simulated calibrations; 0: none
  std::string output;            ///< file of poses; empty: only print
  bool force = false;            ///< replace it
};

/// Chooses few poses of many, so that a calibration with them is as good as possible.
int select_poses(const SelectPosesOptions& options);

struct PlanOptions : StudyFiles {
  std::string accuracy = "gripper 1 mm";
  int candidates = 100;  ///< poses that are generated
  std::string output;    ///< file of poses; empty: only print
  std::string report;    ///< page with a chart; empty: none
  bool force = false;    ///< replace them
};

/// How many poses an accuracy takes, which, how long that is, and what cannot be known that way.
int plan(const PlanOptions& options);

struct CaptureOptions {
  std::string config;       ///< capture.yaml
  std::string urdf, robot;  ///< file, empty: that behind the bridge; address
  std::string joints;       ///< topic of joint states; empty: /joint_states
  std::string depth;        ///< topic of depth images; empty: clouds
  std::string poses;        ///< file
  std::string output;       ///< file of samples
  std::string calibrate;    ///< configuration of a calibration that follows; empty: none
  std::string until;        ///< "gripper 1 mm"; empty: all poses
  std::vector<std::string> mesh_paths = {};  ///< where the URDF's packages may be
  std::string result;                        ///< folder of that calibration
  std::string report;                        ///< of that calibration: a page or JSON; empty: none
  std::string sheet;                         ///< page of all views; empty: none
  double velocity = 1.0;                     ///< factor
  bool manual = false;                       ///< a person moves the robot
  bool resume = false;                       ///< go on with the samples of the output
  bool force = false;                        ///< replace results
  bool drive = false;                        ///< a base: command it
  std::vector<std::string> topics = {};      ///< of a base: KEY=NAME
  std::optional<double> distance = {};       ///< of its straight runs, metres
  std::optional<double> seconds = {};        ///< how long it is recorded; nullopt: until Enter
};

/// True if a configuration has an error block of a mobile base.
[[nodiscard]] bool is_base_config(const std::string& path);

/// Records the drive of a mobile base, and drives it if that is asked for.
int capture_base(const CaptureOptions& options);

/// Moves a robot through poses and records what its finders see.
int capture(const CaptureOptions& options);

struct CapturePosesOptions {
  std::string config;       ///< capture.yaml; empty: all joints, all finders
  std::string urdf, robot;  ///< file, empty: that behind the bridge; address
  std::string joints;       ///< topic of joint states; empty: /joint_states
  std::string output;       ///< file of poses
  bool resume = false;      ///< go on with the poses of the output
  bool force = false;       ///< replace it
};

/// Records poses into which a person moves the robot.
int capture_poses(const CapturePosesOptions& options);

struct InstallOptions {
  std::string result;  ///< folder that calibrate wrote
  std::string folder;  ///< with the launch file
  std::string launch = "robot.launch";
  std::vector<std::string> names;  ///< KEY=NAME
  std::string reset = {};          ///< the launch file as the robot was delivered; empty: none
  bool force = false, restore = false, date = false;
};

/// Installs a result on the robot, restores the previous one or the factory's, or prints the date of the current one.
int install(const InstallOptions& options);

struct PlotOptions {
  std::string report;              ///< HTML that calibrate wrote
  std::vector<std::string> names;  ///< of charts; empty: all
  std::string output;              ///< folder
  double width = 160.0;            ///< of a chart on paper, millimetres
  bool list = false;               ///< print their names
  bool force = false;              ///< replace files
};

/// Writes the charts of a report as SVG files.
int plot(const PlotOptions& options);

struct RpyOptions {
  std::vector<std::string> numbers;  ///< three, radians
  bool to_vector = false;            ///< they are roll, pitch, yaw
  bool comma = false;                ///< print the result alone: "r, p, y"
};

/// Prints a rotation as a rotation vector and as roll, pitch, yaw; degrees, too.
int rpy(const RpyOptions& options);

/// Name, version and the instruction set of the evaluation.
std::string version();

/// What this program finds in images, and what it does not: "finds AprilTags (libapriltag)".
std::string found_targets();

/// Why this build cannot find a target of `init` or `simulate` in photographs; empty if it can.
/// @param target  "world_checkerboard"
std::string fault_of_target(std::string_view target);

/// Prints that, with what it finds instead, before anybody takes photographs.
void note_fault_of_target(std::string_view target);

}  // namespace kinecal::cli
