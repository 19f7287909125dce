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

/// The line.  Overwritten ten times a second and erased at the end; prints nothing if standard
/// error is not a terminal.
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

  bool on_a_terminal_;
  std::string task_;  ///< what was done at the last call
  Clock::time_point begin_, shown_;
  bool is_visible_ = false;
};

}  // namespace kinecal::cli
