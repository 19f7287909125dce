// Definitions of identify.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/trust/identify.hpp"

#include <algorithm>
#include <numbers>
#include <set>
#include <stdexcept>
#include <utility>

#include "kinecal/trust/identification.ipp"
#include "kinecal/trust/whole_frames.ipp"

namespace kinecal {

namespace detail {
namespace {

/// Zeros that are a quarter or half turn off, as of servos that were screwed on so: no linearization finds them.
void find_turns(Identification& search, Identified& found) {
  constexpr double kMetres = 0.01, kPixels = 30.0;  // residuals of less are no such error
  constexpr double kThird = 1.0 / 3.0;
  constexpr int kMost = 3;
  for (int n = 0; n < kMost && search.noise() > (search.noise_unit() == "px" ? kPixels : kMetres);
       ++n) {
    std::pair<int, double> best{-1, 0.0};
    double least = kThird * search.noise();
    for (int k = 0; k < static_cast<int>(search.candidates().size()); ++k) {
      const std::vector<int>& own = search.candidates()[static_cast<std::size_t>(k)].columns;
      if (search.candidates()[static_cast<std::size_t>(k)].rank > 0 || own.size() != 1) continue;
      if (search.parameter(own.front()).unit != "rad") continue;
      for (const double turn : {0.5, -0.5, 1.0}) {
        const double by = turn * std::numbers::pi;
        search.begin_with(own.front(), by);
        if (search.solve({}).converged && search.noise() < least) {
          best = {k, by};
          least = search.noise();
        }
        search.begin_with(own.front(), -by);
      }
    }
    if (best.first >= 0) {
      search.begin_with(search.candidates()[static_cast<std::size_t>(best.first)].columns.front(),
                        best.second);
      found.turned.push_back(best);
    }
    found.result = search.solve({});
    if (best.first < 0) return;
  }
}

/// A step, with errors as distances.
[[nodiscard]] IdentifyStep step_in_distances(const Identification& search, const SearchStep& step) {
  const double one = search.distance_of_one();
  return {step.candidate,           one * step.fit.fitted, one * step.fit.held_out,
          one * step.fit.region,    step.certainty,        step.alike,
          one * step.fit.deviation, step.fit.columns,      step.inseparable};
}

Identified run(Identification& search) {
  constexpr int kLinearizations = 12;
  Identified found;
  found.unit = search.unit();
  found.result = search.solve({});
  if (found.result.converged) find_turns(search, found);
  std::set<std::set<int>> seen;
  for (int round = 0; round < kLinearizations && found.result.converged; ++round) {
    const ParameterSearch linear = search.linearized();
    const std::vector<int> base = linear.independent(search.base());
    std::vector<int> chosen = found.chosen;
    linear.run(base, search.candidates(), chosen);
    const std::set<int> now(chosen.begin(), chosen.end());
    const bool stays = now == std::set<int>(found.chosen.begin(), found.chosen.end());
    if (stays || !seen.insert(now).second) break;
    CalibrationResult result = search.solve(chosen);
    if (!result.converged ||
        !search.is_plausible(chosen)) {  // too far for the last solution to be a start
      search.begin_again();
      result = search.solve(chosen);
    }
    if (!result.converged || !search.is_plausible(chosen)) {
      search.begin_again();
      found.result = search.solve(found.chosen);
      break;
    }
    found.chosen = std::move(chosen);
    found.result = std::move(result);
  }
  if (found.result.converged) take_whole_frames(search, found);
  if (!found.result.converged) return found;
  const ParameterSearch linear = search.linearized();
  const std::vector<int> base = linear.independent(search.base());
  found.steps = {step_in_distances(
      search, {.candidate = -1, .fit = linear.fit_of(base, search.candidates(), {})})};
  for (const SearchStep& step : linear.path(base, search.candidates(), found.chosen)) {
    found.steps.push_back(step_in_distances(search, step));
  }
  constexpr int kMostBeyond = 4;
  for (const SearchStep& step :
       linear.beyond(base, search.candidates(), found.chosen, kMostBeyond)) {
    found.beyond.push_back(step_in_distances(search, step));
  }
  return found;
}

/// @throws std::invalid_argument  if the calibration has not one step, or too few samples
void check_search(const Calibration& calibration, std::span<const Sample> samples) {
  if (calibration.steps.size() != 1) {
    throw std::invalid_argument("a search needs a calibration of one step");
  }
  constexpr std::size_t kFewest = 4;
  if (samples.size() < kFewest || are_one_pose(*calibration.steps.front().problem, samples)) {
    throw std::invalid_argument("the samples are of too few poses to hold some out");
  }
}

}  // namespace
}  // namespace detail

Identified most_helpful(Calibration& calibration, std::span<const Sample> samples,
                        const std::vector<int>& base,
                        const std::vector<IdentifyCandidate>& candidates) {
  detail::check_search(calibration, samples);
  detail::Identification search(calibration, samples, base, candidates);
  constexpr std::size_t kMost = 2;
  Identified found;
  found.unit = search.unit();
  for (;;) {
    found.result = search.solve(found.chosen);
    if (!found.result.converged) return found;
    const ParameterSearch linear = search.linearized();
    const std::vector<int> columns = linear.independent(search.base());
    if (found.chosen.size() < kMost &&
        linear.free_one(columns, search.candidates(), found.chosen)) {
      int& last = found.chosen.back();
      last = linear.simplest(columns, search.candidates(), found.chosen, last);
      continue;
    }
    // All at the last solution: there, noise is that of what was found.
    for (std::size_t n = 0; n <= found.chosen.size(); ++n) {
      const std::vector<int> first(found.chosen.begin(),
                                   found.chosen.begin() + static_cast<std::ptrdiff_t>(n));
      SearchStep step{.candidate = n == 0 ? -1 : first.back()};
      step.fit = linear.fit_of(columns, search.candidates(), first);
      found.steps.push_back(detail::step_in_distances(search, step));
    }
    return found;
  }
}

Identified identify(Calibration& calibration, std::span<const Sample> samples,
                    const std::vector<int>& base,
                    const std::vector<IdentifyCandidate>& candidates) {
  detail::check_search(calibration, samples);
  detail::Identification search(calibration, samples, base, candidates);
  return detail::run(search);
}

}  // namespace kinecal
