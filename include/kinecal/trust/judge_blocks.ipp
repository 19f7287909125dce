// Judging what samples determine of an error block that has parameters of its own and sees no robot beside it: the drive of a
// base, its gyroscope, a magnetometer.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "kinecal/errors/base_motion.hpp"
#include "kinecal/errors/magnetic_field.hpp"
#include "kinecal/text/first_names.hpp"
#include "kinecal/trust/judge.hpp"

namespace kinecal::detail {

/// The free parameters of an error block, by whether a step's samples determine them.
struct BlockParameters {
  std::vector<std::string> open;  ///< not determined
  int determined = 0;
  int scales = 0, determined_scales = 0;  ///< those of unit "1"
};

[[nodiscard]] inline BlockParameters parameters_of_block(const Term& term, const Assessment& step,
                                                         const FreeSet& free,
                                                         const ParameterTable& table) {
  BlockParameters all;
  const std::vector<int>& freed = free.parameters();
  for (const int p : term.parameters) {
    if (std::find(freed.begin(), freed.end(), p) == freed.end()) continue;
    const bool is_determined = std::isfinite(step.deviation(p).value_or(HUGE_VAL));
    const bool is_scale = table[p].unit == "1", is_at_bound = !step.deviation(p).has_value();
    all.determined += is_determined ? 1 : 0;
    all.scales += is_scale ? 1 : 0;
    all.determined_scales += is_scale && is_determined ? 1 : 0;
    if (!is_determined && !is_at_bound) all.open.push_back(table[p].name);
  }
  return all;
}

/// Judges what is not determined, and residuals that are too few to check what is.  A base without any scale is not
/// calibrated, whatever else its samples determine.
inline void judge_blocks(const AnyProblem& problem, const FreeSet& free, const Assessment& step,
                         const ParameterTable& table, Judgement& judgement) {
  constexpr std::int64_t kFewest = 5;  // intervals
  for (int t = 0; t < problem.num_terms(); ++t) {
    const Term& term = problem.term(t);
    const bool is_base = is_base_type(term.options.type);
    if (!is_base && term.options.type != MagneticField::kType) continue;
    const BlockParameters own = parameters_of_block(term, step, free, table);
    const std::string block = "error block '" + term.name + "': ";
    const BlockNoise& noise = step.noise[static_cast<std::size_t>(t)];
    const bool is_none = is_base && own.scales > 0 ? own.determined_scales == 0
                                                   : own.determined == 0 && !own.open.empty();
    if (is_none && !own.open.empty()) {
      judgement.add(Grade::do_not_use,
                    block + "these samples do not determine " + first_names(own.open) +
                        (is_base ? "; do its readings change, and does the base turn and drive "
                                   "straight?"
                                 : "; record while it turns about several axes"),
                    {Remedy::Kind::record});
    } else if (is_base && !own.open.empty()) {
      judgement.add(Grade::use_with_care,
                    block + "these samples do not determine " + first_names(own.open) +
                        "; turn and drive straight, too, or hold what is not needed",
                    {Remedy::Kind::record});
    }
    if (own.determined == 0) continue;
    const std::int64_t rows = noise.features * noise.components;
    if (rows < 2 * own.determined || noise.features < kFewest) {
      judgement.add(rows < 2 * own.determined ? Grade::do_not_use : Grade::use_with_care,
                    block + std::to_string(noise.features) + (is_base ? " interval" : " reading") +
                        (noise.features == 1 ? " is" : "s are") + " too few to check " +
                        std::to_string(own.determined) +
                        (own.determined == 1 ? " parameter" : " parameters") +
                        "; record more samples",
                    {Remedy::Kind::record});
    }
  }
}

}  // namespace kinecal::detail
