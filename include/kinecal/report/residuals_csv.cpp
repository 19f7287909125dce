// Writing residuals.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/report/residuals_csv.hpp"

#include <fmt/format.h>

#include <vector>

#include "kinecal/evaluation/any_evaluator.hpp"
#include "kinecal/report/residual_rows.ipp"

namespace kinecal {

std::string residuals_csv(const Calibration& calibration, const Findings& findings) {
  std::vector<detail::CsvResidual> rows;
  if (!findings.result.steps.empty()) {
    const AnyProblem& problem = *calibration.steps[findings.result.steps.size() - 1].problem;
    const Eigen::VectorXd values = findings.result.table.values();
    const auto visit = [&](int t, int sample, const TermResiduals& residuals) {
      const Term& term = problem.term(t);
      const int size = term.feature_size;
      const auto at = static_cast<std::size_t>(sample);
      const int number = at < findings.numbers.size() ? findings.numbers[at] : sample + 1;
      const std::string before = fmt::format("{},{},{}", detail::csv_cell(term.name), number,
                                             detail::csv_cell(problem.source(sample)));
      for (Eigen::Index row = 0; row < residuals.residual.size(); row += size) {
        const auto r = residuals.residual.segment(row, size);
        rows.push_back({before,
                        problem.feature(t, sample, row / size),
                        term.options.unit,
                        r.norm(),
                        {r.begin(), r.end()}});
      }
    };
    (void)evaluate(problem, {values.data(), static_cast<std::size_t>(values.size())}, nullptr,
                   visit);
  }
  return detail::csv_text(rows);
}

}  // namespace kinecal
