// SPDX-License-Identifier: Apache-2.0
#include "input.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <optional>
#include <span>
#include <system_error>

#include "kinecal/config/assemble.hpp"
#include "kinecal/config/doubts/find_doubts.hpp"
#include "kinecal/config/doubts/used_joints.hpp"
#include "kinecal/config/hold_parameters.hpp"
#include "kinecal/config/own_frames.hpp"
#include "kinecal/config/read_config.hpp"
#include "kinecal/files/cameras/set_camera.hpp"
#include "kinecal/files/urdf/read_urdf.hpp"
#include "kinecal/tools/cameras/later_cameras.hpp"
#include "kinecal/tools/cameras/prepare_cameras.hpp"
#include "kinecal/tools/identify/open_config.hpp"
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

/// The samples without those that the user excludes.
std::vector<Sample> used_samples(const std::vector<Sample>& samples,
                                 const std::vector<int>& exclude) {
  std::vector<Sample> used;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const auto number = static_cast<int>(i) + 1;
    if (std::find(exclude.begin(), exclude.end(), number) == exclude.end()) {
      used.push_back(samples[i]);
    }
  }
  return used;
}

/// What a search begins with: the unknown poses are free, and a note says that there is a search.
void leave_open(Input& input, const InputOptions& options) {
  input.is_searched = true;
  if (options.nothing_free == NothingFree::without_lists) {
    input.diagnostics.notes.push_back(
        (options.config.empty() ? "there is no --config; the samples suggest one"
                                : options.config + ": nothing is free") +
        ": what these samples support is searched for, as 'kinecal identify' does");
  }
  if (input.config.steps.size() == 1 && frees_nothing(input.config)) {
    free_unknown_poses(input.config, input.robot, input.samples);
  }
}

/// True if a lens is to be found.
bool searches_lenses(const Config& config) {
  const std::vector<ModelConfig> models = detail::models_of(config);
  return std::any_of(models.begin(), models.end(),
                     [](const ModelConfig& model) { return model.lens == kAnyLens; });
}

/// True if a configuration leaves open where cameras or targets begin, or lenses.
bool leaves_open(const Config& config) {
  return !config.per_sample.empty() || searches_lenses(config);
}

/// What configuration and samples leave open about cameras: as the first file has it, or by these samples.
bool prepare(Input& input, const Input* first) {
  input.decides_cameras = leaves_open(input.config);
  if (first == nullptr || !first->decides_cameras) {
    return prepare_cameras(input.robot, input.config, input.samples, input.diagnostics);
  }
  input.config = first->config;
  input.robot = first->robot;
  return prepare_later_cameras(input.robot, input.config, first->samples, input.samples,
                               input.diagnostics);
}

}  // namespace

void assemble_input(Input& input, const InputOptions& options) {
  input.calibration = assemble(input.config, input.robot, input.samples, input.diagnostics);
  const auto doubt = [&](std::span<const Sample> samples) {
    find_doubts({input.config, input.robot, input.urdf_text, input.urdf, samples, input.calibration,
                 options.recorded, options.is_part},
                input.diagnostics);
  };
  if (options.exclude.empty()) {
    doubt(input.samples);
  } else {
    doubt(used_samples(input.samples, options.exclude));
  }
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

Input read_input(const InputOptions& options, const Input* first) {
  Input input;
  Diagnostics& diagnostics = input.diagnostics;
  const auto read_robot = [&](auto&& text) {
    return attempt(
        [&] {
          input.urdf_text = text();
          return parse_urdf(input.urdf_text, input.urdf);
        },
        diagnostics);
  };
  input.urdf = options.urdf;
  std::optional<Robot> robot;
  if (!options.urdf.empty()) {
    robot = read_robot([&] { return read_urdf_text(options.urdf); });
  }
  const std::size_t before = diagnostics.errors.size();
  const bool may_be_open = options.nothing_free != NothingFree::is_error;
  const bool is_proposed = may_be_open && options.config.empty() && options.config_text.empty();
  const auto read_configuration = [&]() -> std::optional<Config> {
    return attempt(
        [&] {
          input.config_text =
              options.config.empty() ? options.config_text : detail::read_yaml_text(options.config);
          return parse_config(
              input.config_text,
              options.config.empty() ? "the proposed configuration" : options.config, diagnostics,
              options.nothing_free);
        },
        diagnostics);
  };
  std::optional<Config> configuration;
  if (!is_proposed) configuration = read_configuration();
  const bool configuration_is_good = diagnostics.errors.size() == before;
  const bool is_open =
      may_be_open && (is_proposed || options.nothing_free == NothingFree::is_allowed ||
                      (configuration && frees_nothing(*configuration)));
  const bool waits =
      configuration && searches_lenses(*configuration);  // what is free is not known yet
  if (configuration && !is_open && !waits) {
    hold_parameters(*configuration, options.hold, diagnostics);
  }
  Recording recording = read_recordings(options.samples, diagnostics);
  input.samples = std::move(recording.samples);
  if (recording.urdf.empty()) recording.urdf = options.urdf_text;
  const bool needs_urdf = !configuration || configuration->per_sample.empty();
  if (options.urdf.empty() && recording.urdf.empty() && needs_urdf) {
    diagnostics.error({"--urdf", 0},
                      options.samples.empty()
                          ? "is required without samples"
                          : "is required, because the samples contain no /robot_description");
  } else if (options.urdf.empty() && !recording.urdf.empty()) {
    input.urdf = "/robot_description";
    robot = read_robot([&] { return std::move(recording.urdf); });
  }
  for (const std::string& camera : options.cameras) {
    attempt([&] { return set_camera(input.samples, camera, diagnostics), true; }, diagnostics);
  }
  if (!robot && options.urdf.empty() && configuration && !configuration->per_sample.empty()) {
    input.urdf = "cameras.urdf";  // there is no robot
    robot = read_robot([&] { return urdf_of_cameras(*configuration); });
  }
  if (robot && is_proposed && diagnostics.errors.size() == before) {
    configuration =
        attempt([&] { return config_from_samples(*robot, input.samples); }, diagnostics);
  }
  if (!robot || !configuration) return input;
  input.robot = *robot;
  input.config = *configuration;
  if (diagnostics.errors.size() == before) {
    if (options.recorded == Recorded::before) {
      add_rising(rising_of(input.urdf_text, input.urdf), input.samples);
    }
    if (!prepare(input, first)) return input;
    if (waits && !is_open && first == nullptr) {
      hold_parameters(input.config, options.hold, diagnostics);
      if (diagnostics.errors.size() != before) return input;
    }
    is_open ? leave_open(input, options) : assemble_input(input, options);
    return input;
  }
  // Blocks of a wrong configuration are left out; the rest is still checked against the robot.
  if (!configuration_is_good) {
    for (StepConfig& step : configuration->steps) step.error_blocks.clear();
  }
  (void)assemble(*configuration, *robot, {}, diagnostics);
  return input;
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
    for (const std::string& message : messages) {
      say(stderr, "{}: {}\n", kind, with_hanging_lines(message));
    }
  };
  print_each("note", diagnostics.notes);
  print_each("warning", diagnostics.warnings);
  print_each("error", diagnostics.errors);
  print_each("doubt", diagnostics.doubts);
}

}  // namespace kinecal::cli
