// The input of a calibration, read from the user's files; all errors are reported at once.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "commands.hpp"
#include "kinecal/config/config.hpp"
#include "kinecal/files/diagnostics.hpp"
#include "kinecal/files/recordings/read_recording.hpp"
#include "kinecal/solve/calibrate.hpp"

namespace kinecal::cli {

/// Everything that a calibration needs.
struct Input {
  Robot robot;
  Config config;
  std::string urdf;              ///< name of the URDF in messages: its file or topic
  std::string urdf_text;         ///< its content
  std::string config_text;       ///< content of the configuration
  std::string found_config;      ///< the one that frees what a search found; empty: there was none
  bool decides_cameras = false;  ///< finds lenses and where cameras begin, for later files, too
  bool is_searched = false;      ///< what is free is searched for: nothing is assembled yet
  std::vector<Sample> samples;
  Calibration calibration;
  Diagnostics diagnostics;
};

/// Reads and assembles everything; errors go to Input::diagnostics.
/// @param first  of several files: what it has decided about cameras holds for the others; nullptr: this is the first
[[nodiscard]] Input read_input(const InputOptions& options, const Input* first = nullptr);

/// Assembles what was read, and doubts it: for an input whose free parameters were searched for.
void assemble_input(Input& input, const InputOptions& options);

/// Reads samples from several files of any format, and the URDF from the first that has one.  Errors
/// go to the diagnostics.
[[nodiscard]] Recording read_recordings(const std::vector<std::string>& files,
                                        Diagnostics& diagnostics);

/// The options that name the same inputs: --urdf robot.urdf --config calibrate.yaml --samples a.yaml b.yaml.
[[nodiscard]] ShellCommand input_options(const InputOptions& options);

/// The calibration of these inputs, into the folder "calibrated".
[[nodiscard]] ShellCommand calibrate_command(const InputOptions& inputs);

/// The conversion of a table into samples.yaml.
/// @param columns  file of their meaning
[[nodiscard]] ShellCommand convert_command(const std::string& table, const std::string& columns);

/// Prints warnings, doubts and errors to the standard error stream.
void print(const Diagnostics& diagnostics);

/// Prints it, but throws the last error, which the program then prints.
void print_or_throw(const Diagnostics& diagnostics);

}  // namespace kinecal::cli
