// A terminal line with the progress of a long task and its remaining time.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <string>

#include "kinecal/samples/progress_meter.hpp"

namespace kinecal::cli {

/// The text of the line: "reading s.yaml: 40 %, 3 s left".
/// @param fraction  finished, from 0 to 1
/// @param seconds   since the task began
[[nodiscard]] std::string progress_text(double fraction, const std::string& what, double seconds);

/// Shows progress from now on, or not: --quiet.
void set_progress(bool wanted);

/// Whether progress is shown: it is wanted, and standard error is a terminal on which a line can be overwritten.
[[nodiscard]] bool shows_progress();

/// The line.  Overwritten ten times a second and erased at the end; prints nothing unless
/// shows_progress().
class ProgressLine {
 public:
  ProgressLine();
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;
  ~ProgressLine();

  /// Shows what it is called with; it must not be called after the line is gone.
  [[nodiscard]] ProgressMeter meter();

 private:
  using Clock = std::chrono::steady_clock;

  void show(double fraction, const std::string& what);

  bool is_shown_;
  std::string task_;  ///< what was done at the last call
  Clock::time_point begin_, shown_;
  bool is_visible_ = false;
};

}  // namespace kinecal::cli
