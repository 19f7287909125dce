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

/// Begins with zeros that are turned, or back.
void turn(Identification& search, const Turns& turns, double factor) {
  for (const auto& [k, by] : turns) {
    search.begin_with(search.candidates()[static_cast<std::size_t>(k)].columns.front(),
                      factor * by);
  }
}

/// Quarter and half turns of each zero alone.
[[nodiscard]] std::vector<Turns> single_turns(const Identification& search) {
  std::vector<Turns> all;
  for (int k = 0; k < static_cast<int>(search.candidates().size()); ++k) {
    const SearchCandidate& of = search.candidates()[static_cast<std::size_t>(k)];
    if (of.rank > 0 || of.columns.size() != 1) continue;
    if (search.parameter(of.columns.front()).unit != "rad") continue;
    for (const double part : {0.5, -0.5, 1.0}) all.push_back({{k, part * std::numbers::pi}});
  }
  return all;
}

/// Likely turns, all together and each alone; not those of joints that no residual depends on.
[[nodiscard]] std::vector<Turns> likely_turns(const Identification& search, const Turns& likely) {
  Turns together;
  for (const auto& turn : likely) {
    const SearchCandidate& of = search.candidates()[static_cast<std::size_t>(turn.first)];
    if (of.columns.size() == 1) together.push_back(turn);
  }
  std::vector<Turns> all;
  if (together.size() > 1) all.push_back(together);
  for (const auto& turn : together) all.push_back({turn});
  return all;
}

/// The turns after which the noise is least; empty if it is not below `most` after any.
[[nodiscard]] Turns best_turns(Identification& search, const std::vector<Turns>& tried,
                               double most) {
  Turns best;
  for (const Turns& turns : tried) {
    turn(search, turns, 1.0);
    if (search.solve({}).converged && search.noise() < most) {
      best = turns;
      most = search.noise();
    }
    turn(search, turns, -1.0);
  }
  return best;
}

/// Solves with zeros that are a quarter or half turn off, as of servos that were screwed on so: no linearization
/// finds them, and with them a camera may see nothing at the start.
void find_turns(Identification& search, const Turns& likely, Identified& found) {
  constexpr double kMetres = 0.01, kPixels = 30.0;  // residuals of less are no such error
  constexpr double kThird = 1.0 / 3.0;
  constexpr int kMost = 3;
  const double enough = search.noise_unit() == "px" ? kPixels : kMetres;
  for (int n = 0; n < kMost; ++n) {
    const bool starts = found.result.converged;
    if (starts && search.noise() <= enough) return;
    const double most = starts ? kThird * search.noise() : enough;
    Turns best;
    if (n == 0) best = best_turns(search, likely_turns(search, likely), most);
    if (best.empty()) best = best_turns(search, single_turns(search), most);
    turn(search, best, 1.0);
    found.turned.insert(found.turned.end(), best.begin(), best.end());
    if (best.empty()) search.begin_again();
    found.result = search.solve({});
    if (best.empty()) return;
  }
}

/// A step, with errors as distances.
[[nodiscard]] IdentifyStep step_in_distances(const Identification& search, const SearchStep& step) {
  const double one = search.distance_of_one();
  return {step.candidate,           one * step.fit.fitted, one * step.fit.held_out,
          one * step.fit.region,    step.certainty,        step.alike,
          one * step.fit.deviation, step.fit.columns,      step.inseparable};
}

/// Linearizes at the solution, where frames lose what the samples do not determine; solves again if one of those found
/// did.
[[nodiscard]] ParameterSearch linearize(Identification& search,
                                        std::vector<IdentifyCandidate>& candidates,
                                        Identified& found) {
  ParameterSearch linear = search.linearized();
  const std::vector<int> before = search.columns(found.chosen);
  found.absorbed = search.keep_determined(linear, candidates);
  if (search.columns(found.chosen) == before) return linear;
  found.result = search.solve(found.chosen);
  return search.linearized();
}

Identified run(Identification& search, std::vector<IdentifyCandidate>& candidates,
               const Turns& likely) {
  constexpr int kLinearizations = 12;
  Identified found;
  found.unit = search.unit();
  found.result = search.solve({});
  find_turns(search, likely, found);
  std::set<std::set<int>> seen;
  for (int round = 0; round < kLinearizations && found.result.converged; ++round) {
    const ParameterSearch linear = linearize(search, candidates, found);
    if (!found.result.converged) break;
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
                        const std::vector<int>& base, std::vector<IdentifyCandidate>& candidates) {
  detail::check_search(calibration, samples);
  detail::Identification search(calibration, samples, base, candidates);
  constexpr std::size_t kMost = 2;
  constexpr ParameterSearch::Evidence kOfAdvice{0.2, 1.0};  // sixteen views show a wrong lens
  Identified found;
  found.unit = search.unit();
  for (;;) {
    found.result = search.solve(found.chosen);
    if (!found.result.converged) return found;
    const ParameterSearch linear = detail::linearize(search, candidates, found);
    const std::vector<int> columns = linear.independent(search.base());
    if (found.chosen.size() < kMost &&
        linear.free_one(columns, search.candidates(), found.chosen, kOfAdvice)) {
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
                    const std::vector<int>& base, std::vector<IdentifyCandidate>& candidates,
                    const Turns& likely) {
  detail::check_search(calibration, samples);
  detail::Identification search(calibration, samples, base, candidates);
  return detail::run(search, candidates, likely);
}

}  // namespace kinecal
