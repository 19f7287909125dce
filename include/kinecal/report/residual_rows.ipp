// Rows of the table of residuals as text, for residuals_csv.cpp.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

#include "kinecal/samples/sample.hpp"

namespace kinecal::detail {

/// A name as a cell of a table.  One that a spreadsheet would take for a formula gets an apostrophe before it, and so does
/// one that begins with an apostrophe.
[[nodiscard]] inline std::string csv_cell(const std::string& name) {
  const bool is_formula =
      !name.empty() && std::string_view("=+-@\t\r'").find(name[0]) != std::string_view::npos;
  const std::string text = (is_formula ? "'" : "") + name;
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string all = "\"";
  for (const char c : text) all += c == '"' ? std::string("\"\"") : std::string(1, c);
  return all + "\"";
}

/// A row of residuals.
struct CsvResidual {
  std::string before;  ///< cells up to the feature's place
  FeatureLabel feature;
  std::string unit;
  double distance = 0.0;         ///< norm of the residual
  std::vector<double> residual;  ///< as many components as the error block has
};

/// Pads each row to the number of cells in the header.
[[nodiscard]] inline std::string csv_text(const std::vector<CsvResidual>& rows) {
  const bool ids = std::any_of(rows.begin(), rows.end(),
                               [](const auto& row) { return row.feature.id.has_value(); });
  std::size_t most = 1;
  for (const CsvResidual& row : rows) most = std::max(most, row.residual.size());
  std::string text =
      fmt::format("error_block,sample,source,feature,{}unit,distance", ids ? "id," : "");
  for (std::size_t i = 0; i < most; ++i) text += fmt::format(",residual_{}", i + 1);
  text += "\n";
  for (const auto& [before, feature, unit, distance, residual] : rows) {
    const std::string id = feature.id ? fmt::format("{}", *feature.id) : "";
    text += fmt::format("{},{},{}{},{}", before, feature.place + 1, ids ? id + "," : "", unit,
                        distance);
    for (std::size_t i = 0; i < most; ++i) {
      text += i < residual.size() ? fmt::format(",{}", residual[i]) : std::string(",");
    }
    text += "\n";
  }
  return text;
}

}  // namespace kinecal::detail
