// The procedure of calibrate_robot.hpp for a log: recordings in many files that need not fit in memory.
//
// Judged on a draw of it: up to some thousand samples, evenly from all files, decide what a setup leaves open,
// where the solution starts, which causes, patterns, drifts and bad captures there are, and the error on held-out poses.
// Solved on everything: solution, +- and noise are sums over the samples of all files that the draw's rule does not
// leave out.  A log that the draw holds whole is calibrated at once.
//
// Files are taken in the order in which they were recorded, or by name where times are unknown: the order in which they are
// given does not matter, nor does the number of processes.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "kinecal/procedure/calibrate_robot.hpp"
#include "kinecal/solve/shards.hpp"

namespace kinecal {

/// A log: samples in files.
struct RecordedLog {
  std::vector<std::string> names = {};  ///< of the files, for messages
  /// Reads the samples of a file, from 0.
  /// @throws InputError  if it cannot
  std::function<std::vector<Sample>(int file)> read = {};
  /// Numbers of all files, in the order given: computed here where it is empty, else shared by processes.
  ShardExchange exchange = {};
};

/// A log that is ready to be solved.
struct PreparedLog {
  PreparedCalibration draw = {};  ///< of the samples drawn
  RecordedLog log = {};
  std::optional<Config> given = {};  ///< the configuration before it was prepared
  std::vector<int> order = {};       ///< files in the order in which they were recorded
  std::vector<int> numbers = {};     ///< of each sample drawn: its number in the log, from 1
  std::int64_t samples = 0;          ///< of all files
  /// Samples by file, as they were read; empty if they are too many to keep.
  std::map<int, std::vector<Sample>> kept = {};

  /// True if the draw holds all samples.
  [[nodiscard]] bool is_whole() const { return std::ssize(draw.samples) == samples; }
};

/// Draws samples of a log, and prepares the calibration of the draw: see prepare().
/// @param setup    its samples are ignored
/// @param options  `exclude` has no effect
/// @throws InputError  if a file cannot be read
[[nodiscard]] PreparedLog prepare_log(CalibrationSetup setup, RecordedLog log,
                                      const CalibrationOptions& options = {});

/// Calibrates with all samples, and judges.
/// @returns  the setup and samples of the draw; numbers of samples are those in the log
/// @throws InputError  as calibrate_robot(); if samples of some file are wrong
[[nodiscard]] CalibratedRobot calibrate_log(PreparedLog log,
                                            const CalibrationOptions& options = {});

}  // namespace kinecal
