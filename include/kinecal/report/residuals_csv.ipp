// Writing residuals.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "kinecal/evaluation/evaluate.hpp"
#include "kinecal/report/residuals_csv.hpp"

namespace kinecal {

namespace detail {

/// A name as a cell of a table.
[[nodiscard]] inline std::string csv_cell(const std::string& name) {
  if (name.find_first_of(",\"\n") == std::string::npos) return name;
  std::string all = "\"";
  for (const char c : name) all += c == '"' ? std::string("\"\"") : std::string(1, c);
  return all + "\"";
}

/// A row of residuals.
struct CsvResidual {
  std::string before;  ///< cells up to the feature's place
  FeatureLabel feature;
  std::string after;  ///< cells from the unit
};

}  // namespace detail

KINECAL_INLINE std::string residuals_csv(const Calibration& calibration, const Findings& findings) {
  std::vector<detail::CsvResidual> rows;
  if (!findings.result.steps.empty()) {
    const AnyProblem& problem = *calibration.steps[findings.result.steps.size() - 1].problem;
    const Eigen::VectorXd values = findings.result.table.values();
    const auto visit = [&](int t, int sample, const TermResiduals& residuals) {
      const AnyTerm& term = problem.term(t);
      const int size = term.feature_size();
      const std::string before = fmt::format("{},{},{}", detail::csv_cell(term.name()),
                                             findings.numbers[static_cast<std::size_t>(sample)],
                                             detail::csv_cell(problem.source(sample)));
      for (Eigen::Index row = 0; row < residuals.residual.size(); row += size) {
        const auto r = residuals.residual.segment(row, size);
        std::string after = fmt::format("{},{}", term.options().unit, r.norm());
        for (Eigen::Index i = 0; i < size; ++i) after += fmt::format(",{}", r(i));
        rows.push_back({before, problem.feature(t, sample, row / size), std::move(after)});
      }
    };
    (void)evaluate(problem, {values.data(), static_cast<std::size_t>(values.size())}, nullptr,
                   visit);
  }
  const bool ids = std::any_of(rows.begin(), rows.end(),
                               [](const auto& row) { return row.feature.id.has_value(); });
  std::string text =
      fmt::format("error_block,sample,source,feature,{}unit,distance,residual\n", ids ? "id," : "");
  for (const auto& [before, feature, after] : rows) {
    const std::string id = feature.id ? fmt::format("{}", *feature.id) : "";
    text += fmt::format("{},{},{}{}\n", before, feature.place + 1, ids ? id + "," : "", after);
  }
  return text;
}

}  // namespace kinecal
