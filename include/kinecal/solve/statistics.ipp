// Statistics of residuals.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>

#include "kinecal/evaluation/any_evaluator.hpp"
#include "kinecal/solve/statistics.hpp"

namespace kinecal {

KINECAL_INLINE Statistics statistics_of(std::vector<double> norms) {
  if (norms.empty()) return {};
  Statistics s;
  double squares = 0.0;
  for (double norm : norms) {
    squares += norm * norm;
    s.mean += norm;
  }
  const auto n = static_cast<double>(norms.size());
  s.rms = std::sqrt(squares / n);
  s.mean /= n;
  std::sort(norms.begin(), norms.end());
  const std::size_t half = norms.size() / 2;
  s.median = norms.size() % 2 == 1 ? norms[half] : 0.5 * (norms[half - 1] + norms[half]);
  s.max = norms.back();
  return s;
}

KINECAL_INLINE std::vector<std::vector<double>> feature_norms(const AnyProblem& problem,
                                                              ParameterValues values) {
  std::vector<std::vector<double>> norms(static_cast<std::size_t>(problem.num_terms()));
  (void)evaluate(problem, values, nullptr, [&](int t, int, const TermResiduals& residuals) {
    const int size = problem.term(t).feature_size;
    for (Eigen::Index row = 0; row < residuals.residual.size(); row += size) {
      norms[static_cast<std::size_t>(t)].push_back(residuals.residual.segment(row, size).norm());
    }
  });
  return norms;
}

KINECAL_INLINE std::vector<BlockStatistics> block_statistics(const AnyProblem& problem,
                                                             ParameterValues before,
                                                             ParameterValues after) {
  std::vector<BlockStatistics> all;
  const auto norms_before = feature_norms(problem, before);
  const auto norms_after = feature_norms(problem, after);
  for (std::size_t t = 0; t < norms_after.size(); ++t) {
    const Term& term = problem.term(static_cast<int>(t));
    all.push_back({term.name, term.options.type, term.options.unit,
                   static_cast<int>(norms_after[t].size()), statistics_of(norms_before[t]),
                   statistics_of(norms_after[t])});
  }
  TermResiduals residuals;
  for (const PriorTerm& prior : problem.priors()) {
    BlockStatistics& block = all.emplace_back();
    block = {prior.name, prior.options.type, prior.options.unit, problem.num_samples(), {}, {}};
    prior.evaluate(problem.table(), before, nullptr, residuals);
    block.before = statistics_of({residuals.residual.norm()});
    prior.evaluate(problem.table(), after, nullptr, residuals);
    block.after = statistics_of({residuals.residual.norm()});
  }
  return all;
}

}  // namespace kinecal
