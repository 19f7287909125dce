// Suspects in a part of the samples: a third of them with the other sign, rows that belong to neighbours here and there.
//
// The samples that agree best are found by concentration: fit, keep those that are nearest, fit again.  At this fit the
// others are evaluated with each suspect undone; if that mends most of them, it is a suspect in these samples.
// Source: Rousseeuw, Van Driessen, Computing LTS Regression for Large Data Sets, 2006.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numeric>
#include <optional>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "kinecal/evaluation/parallel.hpp"
#include "kinecal/explain/refit.ipp"
#include "kinecal/geometry/median.hpp"
#include "kinecal/trust/judge_files.hpp"

namespace kinecal::detail {

/// Mean squared weighted residual of each sample; infinite for one that cannot be evaluated.
[[nodiscard]] inline std::vector<double> sample_squares(const AnyProblem& empty,
                                                        const Eigen::VectorXd& values,
                                                        std::span<const Sample> samples) {
  const std::unique_ptr<AnyProblem> problem = empty.without_samples();
  std::vector<double> squares(samples.size(), HUGE_VAL);
  std::vector<int> usable;  // numbers of the problem's samples
  for (std::size_t i = 0; i < samples.size(); ++i) {
    try {
      problem->add_sample(samples[i]);
      usable.push_back(static_cast<int>(i));
    } catch (const SampleError&) {
    }
  }
  const std::vector<double> misfits =
      misfits_of(*problem, {values.data(), static_cast<std::size_t>(values.size())}, usable);
  for (const int i : usable) {
    const double misfit = misfits[static_cast<std::size_t>(i)];
    squares[static_cast<std::size_t>(i)] = misfit * misfit;
  }
  return squares;
}

/// The samples that agree best, fitted.
struct Concentrated {
  Eigen::VectorXd values;
  std::vector<double> squares;    ///< of each sample
  std::vector<std::size_t> kept;  ///< samples that agree best, by number
  double typical = 0.0;           ///< median of the squares among them
  bool fits_well = false;         ///< they fit as samples without mistakes do
};

/// Fits some samples, then repeatedly the share that agrees best.
/// @param chosen  to begin with, by number
/// @param free    parameters
/// @param steps   so many fits
[[nodiscard]] inline std::optional<Concentrated> concentrated_from(const Refits& refits,
                                                                   std::vector<std::size_t> chosen,
                                                                   const FreeSet& free, int steps) {
  constexpr double kKept = 0.6;
  const std::vector<Sample>& samples = refits.some();
  const auto kept = static_cast<std::size_t>(kKept * static_cast<double>(samples.size()));
  std::optional<Concentrated> now;
  for (int step = 0; step < steps; ++step) {
    const auto fit = refits.of(chosen, free);
    if (!fit) break;
    Concentrated next{fit->table.values(), {}, {}, 0.0, step > 0 && fits(*fit)};
    next.squares = sample_squares(refits.problem(), next.values, samples);
    next.kept.resize(samples.size());
    std::iota(next.kept.begin(), next.kept.end(), 0u);
    std::stable_sort(next.kept.begin(), next.kept.end(), [&](std::size_t a, std::size_t b) {
      return next.squares[a] < next.squares[b];
    });
    next.kept.resize(kept);
    std::vector<double> of_kept;
    for (const std::size_t i : next.kept) of_kept.push_back(next.squares[i]);
    next.typical = median_of(std::move(of_kept));
    chosen = next.kept;
    now = std::move(next);
  }
  return now;
}

/// Fits the 60 percent of the samples that agree best, from starts of as few samples as determine the unknown poses: more
/// parameters need more samples, of which some are bad.  nullopt if they fit no better than bad samples do.
[[nodiscard]] inline std::optional<Concentrated> concentrated(const Refits& refits) {
  constexpr int kStarts = 60, kFirst = 2, kThen = 4;
  constexpr std::size_t kFewest = 10, kBest = 4;
  const std::size_t count = refits.some().size();
  if (!refits.is_assembled()) return std::nullopt;
  const FreeSet unknown = refits.unknown(), all = refits.free();
  if (count < std::max(kFewest, refits.fewest(all))) return std::nullopt;
  std::vector<std::optional<Concentrated>> starts(kStarts);
  for_each_piece(kStarts, number_of_threads(0), [&](int start, int) {
    std::mt19937 random(static_cast<unsigned>(start));
    std::vector<std::size_t> chosen(count);
    std::iota(chosen.begin(), chosen.end(), 0u);
    if (start > 0) {
      std::shuffle(chosen.begin(), chosen.end(), random);
      chosen.resize(std::min(count, refits.fewest(unknown)));
    }
    starts[static_cast<std::size_t>(start)] = concentrated_from(refits, chosen, unknown, kFirst);
  });
  std::erase_if(starts, [](const auto& start) { return !start.has_value(); });
  std::stable_sort(starts.begin(), starts.end(),
                   [](const auto& a, const auto& b) { return a->typical < b->typical; });
  starts.resize(std::min(starts.size(), kBest));
  std::optional<Concentrated> best;
  for (const auto& start : starts) {
    auto end = concentrated_from(refits, start->kept, all, kThen);
    if (end && end->fits_well && (!best || end->typical < best->typical)) best = std::move(end);
  }
  return best;
}

/// True if most of some numbers are next to another one of them.
[[nodiscard]] inline bool are_in_runs(const std::vector<std::size_t>& numbers) {
  std::size_t beside = 0;
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    const bool before = i > 0 && numbers[i - 1] + 1 == numbers[i];
    const bool after = i + 1 < numbers.size() && numbers[i] + 1 == numbers[i + 1];
    beside += before || after ? 1 : 0;
  }
  return 2 * beside > numbers.size();
}

/// A suspect in some of the drawn samples.
/// @param bad  their numbers among the drawn ones
[[nodiscard]] inline Suspect in_samples(const Suspect& suspect, const std::vector<std::size_t>& bad,
                                        const Refits& refits) {
  std::vector<std::size_t> numbers;
  for (const std::size_t i : bad) numbers.push_back(refits.draw()[i]);
  Suspect part{.undone = fmt::format("{} in {} of {} samples, of which the first is {}",
                                     suspect.undone, bad.size(), refits.some().size(),
                                     place_of(refits.some(), bad.front()).str()),
               .kind = suspect.kind};
  part.correct_all = [suspect, numbers](std::vector<Sample>& samples) {
    std::vector<Sample> changed = samples;
    if (suspect.correct_all) suspect.correct_all(changed);
    if (suspect.correct) std::for_each(changed.begin(), changed.end(), suspect.correct);
    for (const std::size_t i : numbers) samples[i] = changed[i];
  };
  return part;
}

/// Suspects in a part of the samples: those that mend most of the samples which do not agree with the others.
[[nodiscard]] inline std::vector<Suspect> suspects_in_part(const Refits& refits,
                                                           const std::vector<Suspect>& suspects) {
  // The typical one is the median of the best 60 percent: noise alone reaches ten times that.
  constexpr double kBad = 50.0, kMended = 25.0, kMost = 0.8, kFewestPart = 0.03, kMuchBetter = 0.01;
  std::vector<Suspect> found, of_rows;
  const auto agreed = concentrated(refits);
  if (!agreed) return found;
  std::vector<std::size_t> bad;
  for (std::size_t i = 0; i < agreed->squares.size(); ++i) {
    if (agreed->squares[i] > kBad * agreed->typical) bad.push_back(i);
  }
  const auto fewest = static_cast<std::size_t>(
      std::max(3.0, kFewestPart * static_cast<double>(agreed->squares.size())));
  if (bad.size() < fewest) return found;
  for (const Suspect& suspect : suspects) {
    if (!suspect.correct && !suspect.correct_all) continue;
    const std::vector<double> squares =
        sample_squares(refits.problem(), agreed->values, refits.corrected({&suspect}));
    std::vector<std::size_t> mended;  // and those that are much better so
    std::size_t right = 0, broken = 0;
    for (std::size_t i = 0; i < squares.size(); ++i) {
      const bool was_bad = agreed->squares[i] > kBad * agreed->typical;
      const bool is_right = was_bad && squares[i] < kMended * agreed->typical;
      if (is_right) ++right;
      if (is_right || (was_bad && squares[i] < kMuchBetter * agreed->squares[i])) {
        mended.push_back(i);
      }
      if (!was_bad && squares[i] > kBad * agreed->typical) ++broken;
    }
    if (static_cast<double>(right) < kMost * static_cast<double>(bad.size())) continue;
    // What leaves right samples right tells nothing: the joints of a neighbour that touches the same point.
    if (2 * broken < squares.size() - bad.size()) continue;
    (suspect.correct_all ? of_rows : found).push_back(in_samples(suspect, mended, refits));
  }
  // A neighbour's row makes a wrong one right, whatever is wrong with it; where rows are shifted, neighbours are wrong, too.
  if (found.empty() && are_in_runs(bad)) found = std::move(of_rows);
  return found;
}

}  // namespace kinecal::detail
