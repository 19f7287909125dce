// Definitions of judge_files.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/trust/judge_files.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "kinecal/evaluation/any_evaluator.hpp"
#include "kinecal/text/reading.hpp"

namespace kinecal::detail {

void judge_misfits(const std::vector<double>& misfits, const std::vector<std::string>& names,
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
                  names[shard] + ": its residuals are " + times + " times those of most files",
                  {Remedy::Kind::mend, "look at " + names[shard] + ", or leave it out"});
  }
}

std::vector<double> misfits_of(const AnyProblem& problem, ParameterValues values,
                               std::span<const int> files) {
  std::vector<double> squares, rows;
  const auto visit = [&](int t, int sample, const TermResiduals& of) {
    const int number = files[static_cast<std::size_t>(sample)];
    if (number < 0) return;
    const auto file = static_cast<std::size_t>(number);
    if (file >= squares.size()) squares.resize(file + 1, 0.0), rows.resize(file + 1, 0.0);
    const double weight = problem.term(t).weight;
    squares[file] += (weight * of.factor.cwiseProduct(of.residual)).squaredNorm();
    rows[file] += static_cast<double>(of.residual.size()) - of.used.sum();
  };
  if (evaluate(problem, values, nullptr, visit)) {  // a point behind a camera
    const auto count = files.empty() ? 0 : *std::max_element(files.begin(), files.end()) + 1;
    return std::vector<double>(static_cast<std::size_t>(std::max(0, count)), HUGE_VAL);
  }
  for (std::size_t file = 0; file < squares.size(); ++file) {
    squares[file] = std::sqrt(squares[file] / std::max(1.0, rows[file]));
  }
  return squares;
}

void judge_files(const ShardAssessment& found, const std::vector<std::string>& names,
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
            "sample",
        {Remedy::Kind::mend});
  }
  for (const auto& [copy, first] : found.copies) {
    judgement.add(Grade::use_with_care,
                  name(copy) + ": has the samples of " + name(first) +
                      "; copies count twice and say nothing new; leave one "
                      "out",
                  {Remedy::Kind::mend, "leave out " + name(copy)});
  }
}

}  // namespace kinecal::detail
