// Definitions of identify.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/trust/identify.hpp"

#include <algorithm>
#include <limits>
#include <numbers>
#include <set>
#include <stdexcept>
#include <utility>

#include "kinecal/trust/identification.ipp"

namespace kinecal {

namespace detail {
namespace {

[[nodiscard]] IdentifyStep written(const SearchStep& step) {
  return {step.candidate,  step.fit.fitted, step.fit.held_out,
          step.fit.region, step.certainty,  step.alike};
}

/// Zeros that are a quarter or half turn off, as of servos that were screwed on so: no linearization finds them.
void find_turns(Identification& search, Identified& found) {
  constexpr double kMetres = 0.01, kPixels = 30.0;  // residuals of less are no such error
  constexpr double kThird = 1.0 / 3.0;
  constexpr int kMost = 3;
  for (int n = 0; n < kMost && search.noise() > (found.unit == "px" ? kPixels : kMetres); ++n) {
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

Identified run(Identification& search, const std::string& unit) {
  constexpr int kLinearizations = 12;
  Identified found;
  found.unit = unit;
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
  if (!found.result.converged) return found;
  const ParameterSearch linear = search.linearized();
  const std::vector<int> base = linear.independent(search.base());
  found.steps = {written({.candidate = -1, .fit = linear.fit_of(base)})};
  for (const SearchStep& step : linear.path(base, search.candidates(), found.chosen)) {
    found.steps.push_back(written(step));
  }
  return found;
}

}  // namespace
}  // namespace detail

namespace detail {
namespace {

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

std::vector<IdentifyStep> most_helpful(Calibration& calibration, std::span<const Sample> samples,
                                       const std::vector<int>& base,
                                       const std::vector<IdentifyCandidate>& candidates) {
  detail::check_search(calibration, samples);
  detail::Identification search(calibration, samples, base, candidates);
  constexpr std::size_t kMost = 2;
  std::vector<IdentifyStep> steps;
  std::vector<int> chosen;
  while (search.solve(chosen).converged) {
    const ParameterSearch linear = search.linearized();
    const std::vector<int> columns = linear.independent(search.base());
    const std::vector<SearchStep> path = linear.path(columns, search.candidates(), chosen);
    if (path.empty()) {
      steps.push_back(detail::written({.candidate = -1, .fit = linear.fit_of(columns)}));
    } else {
      const auto last = std::find_if(path.begin(), path.end(), [&](const SearchStep& step) {
        return step.candidate == chosen.back();
      });
      IdentifyStep& step = steps.emplace_back(detail::written(*last));
      const SearchFit all = path.back().fit;  // with what was found before it
      step.fitted = all.fitted;
      step.held_out = all.held_out;
      step.region = all.region;
    }
    if (chosen.size() == kMost) return steps;
    linear.free_one(columns, search.candidates(), chosen);
    linear.name_simply(columns, search.candidates(), chosen);
    if (chosen.size() + 1 == steps.size()) return steps;
  }
  return steps;
}

Identified identify(Calibration& calibration, std::span<const Sample> samples,
                    const std::vector<int>& base,
                    const std::vector<IdentifyCandidate>& candidates) {
  detail::check_search(calibration, samples);
  detail::Identification search(calibration, samples, base, candidates);
  const AnyProblem& problem = *calibration.steps.front().problem;
  return detail::run(search, problem.num_terms() == 1 ? problem.term(0).options.unit : "1");
}

}  // namespace kinecal
