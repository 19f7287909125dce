// Judging the values of parameters: changes that are not plausible, bounds.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <string>

#include "kinecal/trust/judge.hpp"
#include "kinecal/trust/plausible_change.ipp"

namespace kinecal::detail {

/// The change of a parameter; for a ratio 1 + v, relative.
[[nodiscard]] inline double change_of(const Parameter& p) {
  if (p.unit != "1" || !(1.0 + p.initial > 0.0)) return p.value - p.initial;
  return (1.0 + p.value) / (1.0 + p.initial) - 1.0;
}

/// Changes that are not plausible: the worst, by its limits, and how many more.
inline void judge_changes(const CalibrationStep& step, const CalibrationResult& result,
                          Judgement& judgement) {
  const Parameter* worst = nullptr;
  double times = 0.0;
  int others = -1;
  Grade grade = Grade::good;
  for (const int p : step.free.parameters()) {
    const double by = std::abs(change_of(result.table[p]));
    const Limits limits = plausible_change(step, p);
    if (!limits.exceeded(by)) continue;
    ++others;
    grade = std::max(grade, limits.grade(by));
    if (worst != nullptr && !(by / limits.care > times)) continue;
    times = by / limits.care;
    worst = &result.table[p];
  }
  if (worst == nullptr) return;
  const double by = change_of(*worst);
  judgement.add(
      grade, "'" + worst->name + "' changed by " +
                 (worst->unit == "1" ? reading(1e2 * by, "1") + " %" : reading(by, worst->unit)) +
                 (others > 0 ? ", and " + std::to_string(others) +
                                   " more by more than is plausible; are the URDF or initial "
                                   "values wrong, or do these samples not determine them?"
                             : "; is the URDF or its initial value wrong, or do these samples not "
                               "determine it?"));
}

inline void judge_values(const CalibrationStep& step, const CalibrationResult& result,
                         const Assessment& assessment, Judgement& judgement) {
  judge_changes(step, result, judgement);
  for (const int p : assessment.at_bound) {
    judgement.add(Grade::use_with_care, "'" + result.table[p].name + "' ended at its bound " +
                                            reading(result.table[p].value, result.table[p].unit));
  }
}

}  // namespace kinecal::detail
