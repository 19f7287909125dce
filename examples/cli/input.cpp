// SPDX-License-Identifier: Apache-2.0
#include "input.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <optional>
#include <span>
#include <system_error>

#include "kinecal/config/own_frames.hpp"
#include "kinecal/config/read_config.hpp"
#include "kinecal/files/cameras/set_camera.hpp"
#include "kinecal/files/urdf/read_urdf.hpp"
#include "progress.hpp"
#include "terminal.hpp"

namespace kinecal::cli {
namespace {

/// Runs one reader; an error that makes its file unusable is added to the others.
template <class Read>
auto attempt(Read&& read, Diagnostics& diagnostics) -> std::optional<decltype(read())> {
  try {
    return read();
  } catch (const InputError& e) {
    diagnostics.errors.emplace_back(e.what());
    return std::nullopt;
  }
}

/// True if the configuration may be missing, or free nothing.
bool may_be_open(const InputOptions& options) {
  return options.nothing_free != NothingFree::is_error;
}

/// Reads the configuration; nullopt if the samples are to suggest one, or after an error.
std::optional<Config> read_configuration(const InputOptions& options, Input& input) {
  if (may_be_open(options) && options.config.empty() && options.config_text.empty()) return {};
  return attempt(
      [&] {
        input.texts.config_text =
            options.config.empty() ? options.config_text : detail::read_yaml_text(options.config);
        return parse_config(input.texts.config_text,
                            options.config.empty() ? "the proposed configuration" : options.config,
                            input.diagnostics, options.nothing_free);
      },
      input.diagnostics);
}

}  // namespace

CalibrationOptions calibration_options(const InputOptions& options) {
  CalibrationOptions calibrating;
  calibrating.exclude = options.exclude;
  calibrating.hold = options.hold;
  calibrating.mesh_paths = options.mesh_paths;
  calibrating.search = options.nothing_free == NothingFree::is_error     ? Search::never
                       : options.nothing_free == NothingFree::is_allowed ? Search::always
                                                                         : Search::if_open;
  return calibrating;
}

Recording read_recordings(const std::vector<std::string>& files, Diagnostics& diagnostics) {
  Recording all;
  ProgressLine line;
  std::vector<std::string> before;
  for (const std::string& file : files) {
    std::error_code missing;
    const auto same = [&](const std::string& other) {
      return std::filesystem::equivalent(file, other, missing);
    };
    if (std::any_of(before.begin(), before.end(), same)) {
      diagnostics.warning({file, 0}, "is given twice, so its samples count twice");
    }
    before.push_back(file);
    auto read =
        attempt([&] { return read_recording(file, diagnostics, 0, line.meter()); }, diagnostics);
    if (!read) continue;
    all.samples.insert(all.samples.end(), std::make_move_iterator(read->samples.begin()),
                       std::make_move_iterator(read->samples.end()));
    if (all.urdf.empty()) all.urdf = std::move(read->urdf);
  }
  return all;
}

Input read_files(const InputOptions& options, bool reads_samples) {
  Input input;
  Diagnostics& diagnostics = input.diagnostics;
  InputTexts& texts = input.texts;
  const auto read_robot = [&](const std::string& name, auto&& text) -> std::optional<Robot> {
    texts.urdf = name;
    return attempt(
        [&] {
          texts.urdf_text = text();
          return parse_urdf(texts.urdf_text, texts.urdf);
        },
        diagnostics);
  };
  std::optional<Robot> robot;
  if (!options.urdf.empty()) {
    robot = read_robot(options.urdf, [&] { return read_urdf_text(options.urdf); });
  }
  const std::size_t before = diagnostics.errors.size();
  std::optional<Config> config = read_configuration(options, input);
  const bool is_config_good = diagnostics.errors.size() == before;
  const bool has_own_robot = config && !config->per_sample.empty();
  Recording recording;
  if (reads_samples || (options.urdf.empty() && options.urdf_text.empty() && !has_own_robot)) {
    recording = read_recordings(options.samples, diagnostics);
  }
  input.setup.samples = std::move(recording.samples);
  if (recording.urdf.empty()) recording.urdf = options.urdf_text;
  if (options.urdf.empty() && recording.urdf.empty() && (!config || config->per_sample.empty())) {
    diagnostics.error({"--urdf", 0},
                      options.samples.empty()
                          ? "is required without samples"
                          : "is required, because the samples contain no /robot_description");
  } else if (options.urdf.empty() && !recording.urdf.empty()) {
    robot = read_robot("/robot_description", [&] { return std::move(recording.urdf); });
  }
  for (const std::string& camera : options.cameras) {
    if (!reads_samples) break;
    attempt([&] { return set_camera(input.setup.samples, camera, diagnostics), true; },
            diagnostics);
  }
  if (!robot && options.urdf.empty() && has_own_robot) {  // there is no robot
    robot = read_robot("cameras.urdf", [&] { return urdf_of_cameras(*config); });
  }
  if (!is_config_good &&
      config) {  // blocks of a wrong configuration are left out; the rest is checked against the robot
    for (StepConfig& step : config->steps) step.error_blocks.clear();
  }
  if (!robot) {
    if (diagnostics.errors.empty()) diagnostics.error({texts.urdf, 0}, "cannot be read");
    return input;
  }
  input.setup.robot = *std::move(robot);
  input.setup.config = std::move(config);
  input.setup.urdf = texts.urdf;
  input.setup.urdf_text = texts.urdf_text;
  input.setup.recorded = options.recorded;
  return input;
}

PreparedCalibration read_input(const InputOptions& options, InputTexts& texts) {
  Input input = read_files(options);
  texts = std::move(input.texts);
  const bool has_robot = !input.setup.urdf_text.empty();
  if (has_robot) {
    return prepare(std::move(input.setup), calibration_options(options),
                   std::move(input.diagnostics));
  }
  PreparedCalibration unusable;
  unusable.diagnostics = std::move(input.diagnostics);
  return unusable;
}

ShellCommand input_options(const InputOptions& options) {
  ShellCommand words;
  if (!options.urdf.empty()) words.add_option("--urdf", {options.urdf});
  if (!options.config.empty()) words.add_option("--config", {options.config});
  words.add_option("--samples", options.samples);
  for (const std::string& camera : options.cameras) words.add_option("--camera", {camera});
  return words;
}

ShellCommand calibrate_command(const InputOptions& inputs) {
  return ShellCommand{"kinecal", "calibrate"}
      .add(input_options(inputs))
      .add({"--output", "calibrated"});
}

ShellCommand convert_command(const std::string& table, const std::string& columns) {
  return ShellCommand{"kinecal", "convert", shell_file(table), "samples.yaml"}.add_option(
      "--columns", {columns});
}

void print_or_throw(const Diagnostics& diagnostics) {
  Diagnostics others = diagnostics;
  if (!others.errors.empty()) others.errors.pop_back();
  print(others);
  if (!diagnostics.errors.empty()) throw InputError(diagnostics.errors.back());
}

void print(const Diagnostics& diagnostics) {
  const auto print_each = [](const char* kind, const std::vector<std::string>& messages) {
    constexpr std::size_t kMost = 50;  // a file can cause 100 000 of them
    const std::size_t shown = messages.size() <= kMost + 1 ? messages.size() : kMost;
    for (std::size_t i = 0; i < shown; ++i) {
      say(stderr, "{}: {}\n", kind, with_hanging_lines(messages[i]));
    }
    if (shown < messages.size()) {
      say(stderr, "{}: and {} more {}s\n", kind, messages.size() - shown, kind);
    }
  };
  print_each("note", diagnostics.notes);
  print_each("warning", diagnostics.warnings);
  print_each("error", diagnostics.errors);
  print_each("doubt", diagnostics.doubts);
}

}  // namespace kinecal::cli
