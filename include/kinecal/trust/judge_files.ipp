// Files that do not go with the others: for judge_shards.cpp.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdio>
#include <string>
#include <vector>

#include "kinecal/text/reading.hpp"
#include "kinecal/trust/assess_shards.hpp"
#include "kinecal/trust/judge.hpp"

namespace kinecal::detail {

/// Files whose residuals are larger than those of the others.
inline void judge_misfits(const std::vector<double>& misfits, const std::vector<std::string>& names,
                          Judgement& judgement) {
  constexpr double kMuch = 2.0;
  if (misfits.size() < 3) return;
  std::vector<double> sorted = misfits;
  std::sort(sorted.begin(), sorted.end());
  const double median = sorted[sorted.size() / 2];
  for (std::size_t shard = 0; shard < misfits.size(); ++shard) {
    if (misfits[shard] <= kMuch * median) continue;
    char times[48];
    (void)std::snprintf(times, sizeof times, "%.1f", misfits[shard] / median);
    judgement.add(Grade::use_with_care,
                  names[shard] + ": its residuals are " + times + " times those of most files");
  }
}

/// Judges what the samples of each file show by themselves.
/// @param names  of the files
inline void judge_files(const ShardAssessment& found, const std::vector<std::string>& names,
                        Judgement& judgement) {
  judge_misfits(found.misfits, names, judgement);
  const auto name = [&](int shard) { return names[static_cast<std::size_t>(shard)]; };
  for (const FarFeature& far : found.far) {  // a fit of this file would leave out its sample
    char times[48];
    (void)std::snprintf(times, sizeof times, "%.0f times the noise", far.times);
    judgement.add(
        Grade::use_with_care,
        name(far.shard) + ": a feature of error block '" + far.block + "' is " +
            reading(far.distance, far.unit) + " off, " + times +
            ", and decides a part of the result: kinecal calibrate of this file names its "
            "sample");
  }
  for (const auto& [copy, first] : found.copies) {
    judgement.add(Grade::use_with_care, name(copy) + ": has the samples of " + name(first) +
                                            "; copies count twice and say nothing new; leave one "
                                            "out");
  }
}

}  // namespace kinecal::detail
