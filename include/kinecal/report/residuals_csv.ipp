// Writing residuals.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include "kinecal/evaluation/evaluate.hpp"
#include "kinecal/report/residuals_csv.hpp"

namespace kinecal {

KINECAL_INLINE std::string residuals_csv(const Calibration& calibration, const Findings& findings) {
  std::string text = "error_block,sample,source,feature,unit,distance,residual\n";
  if (findings.result.steps.empty()) return text;
  const AnyProblem& problem = *calibration.steps[findings.result.steps.size() - 1].problem;
  const Eigen::VectorXd values = findings.result.table.values();
  const auto quoted = [](const std::string& name) {
    if (name.find_first_of(",\"\n") == std::string::npos) return name;
    std::string all = "\"";
    for (const char c : name) all += c == '"' ? std::string("\"\"") : std::string(1, c);
    return all + "\"";
  };
  (void)evaluate(problem, {values.data(), static_cast<std::size_t>(values.size())}, nullptr,
                 [&](int t, int sample, const TermResiduals& rows) {
                   const AnyTerm& term = problem.term(t);
                   const int size = term.feature_size();
                   for (Eigen::Index row = 0; row < rows.residual.size(); row += size) {
                     const auto r = rows.residual.segment(row, size);
                     text += fmt::format("{},{},{},{},{},{}", quoted(term.name()),
                                         findings.numbers[static_cast<std::size_t>(sample)],
                                         quoted(problem.source(sample)), row / size + 1,
                                         term.options().unit, r.norm());
                     for (Eigen::Index i = 0; i < size; ++i) text += fmt::format(",{}", r(i));
                     text += "\n";
                   }
                 });
  return text;
}

}  // namespace kinecal
