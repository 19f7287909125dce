// The input of a calibration, read from the user's files; all errors are reported at once.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "commands.hpp"
#include "kinecal/files/diagnostics.hpp"
#include "kinecal/files/recordings/read_recording.hpp"
#include "kinecal/procedure/calibrate_robot.hpp"

namespace kinecal::cli {

/// The files of a calibration, as text.
struct InputTexts {
  std::string urdf;               ///< name of the URDF in messages: its file or topic
  std::string urdf_text;          ///< its content
  std::string config_text;        ///< content of the configuration
  std::string found_config = {};  ///< the one that frees what a search found; empty: there was none
};

/// Everything that a calibration needs.
struct Input {
  InputTexts texts;
  CalibrationSetup setup = {};   ///< without robot or configuration after an error
  Diagnostics diagnostics = {};  ///< of its readers
};

/// How the options calibrate.
[[nodiscard]] CalibrationOptions calibration_options(const InputOptions& options);

/// Reads all files; errors go to Input::diagnostics.
/// @param reads_samples  false: the samples are read later, file by file
[[nodiscard]] Input read_files(const InputOptions& options, bool reads_samples = true);

/// Reads all files and prepares the calibration.
/// @param texts  out
[[nodiscard]] PreparedCalibration read_input(const InputOptions& options, InputTexts& texts);

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
