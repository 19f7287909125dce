// The report as text: tables in millimetres, degrees and pixels.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "kinecal/solve/calibrate.hpp"
#include "kinecal/trust/assess.hpp"
#include "kinecal/trust/uncertainty/observability.hpp"

namespace kinecal {

/// A table.  Columns are as wide as their widest cell; the first ones are left-aligned, the others
/// right-aligned.
class TextTable {
 public:
  /// The cells of a row.
  using Row = std::vector<std::string>;

  /// @param left_columns  number of left-aligned columns
  explicit TextTable(Row header, std::size_t left_columns = 1)
      : rows_{std::move(header)}, left_columns_(left_columns) {}

  /// Adds a row with as many cells as the header.
  void add(Row row) { rows_.push_back(std::move(row)); }

  /// The table as lines of text.
  [[nodiscard]] std::string str() const;

 private:
  std::vector<Row> rows_;
  std::size_t left_columns_;
};

/// A residual in its displayed unit: millimetres for "m"; "-" if it is undefined, as behind a
/// camera.
[[nodiscard]] std::string in_reading_unit(double value, const std::string& unit);
/// The name of that unit; "-" for a residual without unit.
[[nodiscard]] std::string reading_unit(const std::string& unit);

/// What a design effect does to the +-; empty if it is one.
[[nodiscard]] std::string design_effect_note(const Assessment& of);

/// Two lines for each step: what it did and why it stopped.
[[nodiscard]] std::string step_lines(const CalibrationResult& result);

/// Time and speed of solving, all steps together:
/// "solving 0.0006 s (4 iterations, 1.2 million samples a second, x86-64-v4)".
[[nodiscard]] std::string solving_text(const CalibrationResult& result);

/// The unobservable parameter combinations of a step, one per line, and the parameters to hold so
/// that none remain; empty if all are observable.
[[nodiscard]] std::string observability_text(const std::string& step,
                                             const Observability& observability,
                                             const ParameterTable& table);

namespace detail {

/// A value in its displayed unit, and the unit: degrees for "rad", mm for "m", % for "1".
[[nodiscard]] std::pair<std::string, std::string> for_people(double value, const std::string& unit);

/// What the axes of a frame's parameters are, for those who meet head_joint_x ... head_joint_c first in a report.
inline constexpr const char* kAxesOfFrames =
    "_x _y _z shift a frame, _a _b _c turn it about its x, y, z (rotation vector)";

}  // namespace detail

}  // namespace kinecal
