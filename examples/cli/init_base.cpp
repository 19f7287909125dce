// kinecal init --target base: the configuration of a mobile base.
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "commands.hpp"
#include "input.hpp"
#include "kinecal/files/csv/read_csv_samples.hpp"
#include "kinecal/files/recordings/base_messages.hpp"
#include "kinecal/files/recordings/fixed_frames.hpp"
#include "kinecal/files/recordings/read_bag.hpp"
#include "kinecal/files/results/file_set.hpp"
#include "kinecal/files/text_file.hpp"
#include "kinecal/files/urdf/read_urdf.hpp"
#include "kinecal/files/yaml/yaml_text.hpp"
#include "kinecal/text/nearest_name.hpp"
#include "kinecal/tools/init/initial_base.hpp"
#include "kinecal/tools/init/initial_config.hpp"
#include "output_file.hpp"
#include "question.hpp"
#include "table_samples.hpp"
#include "terminal.hpp"

namespace kinecal::cli {
namespace {

/// What is known before any question.
struct BaseInput {
  std::string urdf;       ///< file; empty: the bag has it
  std::string urdf_text;  ///< of the robot, or of a base alone
  bool writes_urdf = false;
  Robot robot = {};
  BaseDrive drive;      ///< without samples, if there is no recording
  FixedFrames frames;   ///< of the recording and the URDF
  std::string columns;  ///< columns.yaml of a table; empty: there is no table
};

std::string beside(const InitOptions& options, const char* name) {
  return (std::filesystem::path(options.output).parent_path() / name).string();
}

BaseInput read(const InitOptions& options) {
  BaseInput in;
  if (options.from.size() > 1) throw InputError("--from: a base takes one recording");
  Diagnostics diagnostics;
  std::string in_bag;
  if (!options.from.empty()) {
    const std::string& from = options.from.front();
    if (is_csv_table(from)) {
      in.columns = beside(options, "columns.yaml");
      in.drive.samples = table_samples(from, in.columns, options.force, base_columns);
    } else if (recording_format(from) == RecordingFormat::yaml) {
      in.drive.samples = read_recordings(options.from, diagnostics).samples;
    } else {
      in.drive = read_base_drive(from, diagnostics);
      in.frames = recorded_frames(from);
      in_bag = in.drive.urdf;
    }
    print_or_throw(diagnostics);
  }
  if (!options.urdfs.empty()) in.urdf = options.urdfs.front();
  if (!in.urdf.empty()) in.urdf_text = read_urdf_text(in.urdf);
  if (in.urdf.empty()) in.urdf_text = in_bag;
  if (in.urdf_text.empty()) {
    in.urdf = beside(options, "base.urdf");
    in.urdf_text = fmt::format(  // a robot has a joint
        "<robot name=\"base\">\n  <link name=\"{0}\"/>\n  <link name=\"sensor\"/>\n"
        "  <joint name=\"sensor_joint\" type=\"fixed\">\n    <parent link=\"{0}\"/>\n"
        "    <child link=\"sensor\"/>\n  </joint>\n</robot>\n",
        options.base.empty() ? "base_link" : options.base);
    in.writes_urdf =
        !std::filesystem::exists(in.urdf) || detail::read_text_file(in.urdf) != in.urdf_text;
  }
  in.robot = parse_urdf(in.urdf_text, in.urdf.empty() ? options.from.front() : in.urdf);
  in.frames.add(in.robot);
  return in;
}

/// One of some words: given, asked for, or the first.
std::string one_of(const std::string& given, const char* option, const std::string& asks,
                   const std::vector<std::string>& words) {
  const auto why_not = [&](const std::string& word) -> std::string {
    if (std::find(words.begin(), words.end(), word) != words.end()) return "";
    return fmt::format("'{}' is not one of {}{}", word, fmt::join(words, ", "),
                       did_you_mean(word, words));
  };
  if (const std::string wrong = given.empty() ? "" : why_not(given); !wrong.empty()) {
    throw InputError(fmt::format("{}: {}", option, wrong));
  }
  return ask_unless_given(given, {option, asks, choices(words)}, why_not);
}

/// A number that is needed: given, of the URDF, or asked for.
/// @throws InputError  if it is not positive, or nobody can be asked
double size(const std::optional<double>& given, double in_urdf, const char* option,
            const std::string& asks) {
  if (given && !(*given > 0.0)) throw InputError(fmt::format("{}: is not positive", option));
  if (given || in_urdf > 0.0) return given.value_or(in_urdf);
  if (!on_a_terminal()) {
    throw InputError(fmt::format("{} is required: the URDF does not have it", option));
  }
  const auto number = [](const std::string& text) { return number_from_yaml(text).value_or(0.0); };
  return number(ask({option, asks, {}}, [&](const std::string& text) -> std::string {
    return number(text) > 0.0 && std::isfinite(number(text)) ? "" : "give a number above zero";
  }));
}

std::string base_link(const InitOptions& options, const BaseInput& in) {
  if (!options.base.empty()) {
    Diagnostics diagnostics;
    check_init_link(in.robot, "--base", options.base, diagnostics);
    diagnostics.throw_if_errors();
    return options.base;
  }
  return base_link_of(in.robot, {in.drive.base_frame});
}

/// Where the sensor is on the base, by tf or URDF.
/// @throws InputError  if the link of --sensor is not known
void set_mount(const InitOptions& options, const BaseInput& in, BaseAnswers& answers) {
  const std::string sensor = !options.sensor.empty()  ? options.sensor
                             : answers.seen == "wall" ? in.drive.sensor_frame
                                                      : "";
  if (sensor.empty()) return;
  const auto pose = in.frames.pose(answers.base_link, sensor);
  if (!pose && options.sensor.empty()) return;
  if (!pose) {
    throw InputError(
        fmt::format("--sensor: '{}' {} '{}'{}", sensor,
                    in.robot.has_link(sensor) ? "moves on" : "is not a frame that is fixed on",
                    answers.base_link,
                    in.robot.has_link(sensor) ? "" : did_you_mean(sensor, in.robot.link_names())));
  }
  const auto rounded = [](double x) { return std::round(1e6 * x) / 1e6 + 0.0; };
  answers.mount = {rounded(pose->translation.x()), rounded(pose->translation.y()),
                   rounded(std::atan2(pose->rotation(1, 0), pose->rotation(0, 0)))};
  answers.mount_from = fmt::format("where '{}' is", sensor);
}

/// The answers by options, the recording and questions.
BaseAnswers answer(const InitOptions& options, const BaseInput& in) {
  BaseAnswers answers;
  answers.base_link = base_link(options, in);
  const bool is_recorded = !options.from.empty();
  RecordedBase has;
  has.drives.assign(kBaseDrives.begin(), kBaseDrives.end());
  has.seen.assign(kBaseSeen.begin(), kBaseSeen.end());
  has.has_gyro = true;
  if (is_recorded) has = recorded_base(in.drive.samples);
  if (has.seen.empty() || (has.drives.empty() && !has.has_gyro)) {
    throw InputError(fmt::format(
        "{}: these samples are not of the drive of a base: no {}", options.from.front(),
        has.seen.empty() ? "wall and no tracked pose" : "odometry, wheels or gyroscope"));
  }
  if (is_recorded && has.seen.size() == 2) std::swap(has.seen[0], has.seen[1]);  // it shows more
  if (!has.drives.empty()) {
    answers.drive =
        is_recorded && options.drive.empty()
            ? has.drives.front()
            : one_of(options.drive, "--drive", "What does the base report?", has.drives);
  }
  answers.seen =
      is_recorded && options.seen.empty()
          ? has.seen.front()
          : one_of(options.seen, "--seen",
                   "What shows how it moved: a wall in scans, or a tracked pose?", has.seen);
  answers.has_gyro = has.has_gyro;
  answers.turns = has.turns;
  answers.runs = has.runs;
  answers.sideways = has.sideways;
  answers.steers = has.steers;
  if (is_recorded) {
    say("from the recording: {}{}{}\n", answers.drive.empty() ? "a gyroscope" : answers.drive,
        answers.has_gyro && !answers.drive.empty() ? " and a gyroscope" : "",
        answers.seen == "wall" ? ", a wall" : ", a tracked pose");
    if (has.drives.size() > 1 && options.drive.empty()) {
      say("  it has {}, too: --drive chooses\n",
          fmt::join(has.drives.begin() + 1, has.drives.end(), ", "));
    }
    if (has.seen.size() > 1 && options.seen.empty()) {
      say("  it shows a wall, too: --seen {} chooses\n", has.seen.back());
    }
  }
  const BaseSizes known = sizes_of_urdf(in.robot, in.urdf_text, answers.base_link, answers.drive);
  if (answers.drive == "odometry") {
    answers.sizes.track_width = options.track_width.value_or(0.0);  // the driver's: not the URDF's
  } else if (!answers.drive.empty()) {
    answers.sizes.wheel_radius =
        size(options.wheel_radius, known.wheel_radius, "--wheel-radius",
             "What is the radius of the wheels, metres (1.0: their positions are metres)?");
    if (answers.drive != "tricycle") {
      answers.sizes.track_width = size(options.track_width, known.track_width, "--track-width",
                                       "How far apart are left and right wheels, metres?");
    }
    if (answers.drive != "differential") {
      answers.sizes.wheelbase = size(options.wheelbase, known.wheelbase, "--wheelbase",
                                     "How far apart are the axles, metres?");
    }
  }
  if (is_recorded && !answers.drive.empty() && !has.turns && !has.runs) {
    throw InputError(fmt::format(
        "{}: the base neither turned by a radian nor went straight by 0.3 m; drive turns in place "
        "and straight runs",
        options.from.front()));
  }
  answers.gyro_scale = options.gyro_scale.value_or(0.0);
  set_mount(options, in, answers);
  return answers;
}

}  // namespace

int init_base(const InitOptions& options) {
  if (options.urdfs.size() > 1) throw InputError("--target: base is of one robot: one --urdf");
  std::vector<std::string> inputs = options.urdfs;
  inputs.insert(inputs.end(), options.from.begin(), options.from.end());
  check_output(options.output, inputs, options.force);
  const BaseInput in = read(options);
  if (in.writes_urdf) check_output(in.urdf, inputs, options.force);
  const BaseAnswers answers = answer(options, in);
  check_output(options.output, inputs, options.force);  // it may have appeared meanwhile
  if (in.writes_urdf) {
    write_output(in.urdf, in.urdf_text);
    say("wrote {}: the base alone\n", in.urdf);
  }
  write_output(options.output, initial_base(answers));
  say("wrote {}\n", options.output);
  if (!answers.drive.empty() && !answers.mount && answers.seen == "wall") {
    say("  the place of the laser on the base is not known: fill in x, y, yaw\n");
  }
  InputOptions next{.urdf = in.urdf, .config = options.output, .samples = options.from};
  if (options.from.empty()) next.samples = {"drive.bag"};
  if (in.columns.empty()) {
    say("next: {}\n", calibrate_command(next).str());
    return kDone;
  }
  next.samples = {"samples.yaml"};
  say("next: {} && {}\n", convert_command(options.from.front(), in.columns).str(),
      calibrate_command(next).str());
  return kDone;
}

}  // namespace kinecal::cli
