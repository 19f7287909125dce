// Definitions of identify.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/trust/search/identify.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <numbers>
#include <set>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "kinecal/geometry/median.hpp"
#include "kinecal/trust/held_out.hpp"
#include "kinecal/trust/noise/pose_groups.hpp"
#include "kinecal/trust/plausible_change.hpp"
#include "kinecal/trust/search/parameter_search.hpp"

namespace kinecal {

namespace detail {
namespace {

// The columns of a search for wrong parameters.

/// All columns that some residual depends on: first the base, then those of candidates.
[[nodiscard]] FreeSet all_columns(const AnyProblem& problem, const std::vector<int>& base,
                                  const std::vector<IdentifyCandidate>& candidates) {
  const std::vector<int> touched = problem.touched_parameters();
  std::vector<int> all;
  std::set<int> known;
  const auto add = [&](int p) {
    if (std::binary_search(touched.begin(), touched.end(), p) && known.insert(p).second)
      all.push_back(p);
  };
  for (const int p : base) add(p);
  for (const IdentifyCandidate& candidate : candidates) {
    for (const int p : candidate.parameters) add(p);
  }
  return FreeSet(std::move(all), problem.table().size());
}

// One identification: the problem with all parameters, and where the search stands.

/// One identification: the problem, and where the search stands.
class Identification {
 public:
  Identification(Calibration& calibration, std::span<const Sample> samples,
                 const std::vector<int>& base, const std::vector<IdentifyCandidate>& candidates)
      : calibration_(calibration),
        step_(calibration.steps.front()),
        all_(all_columns(*step_.problem, base, candidates)) {
    std::erase_if(step_.unknown_frames, [&](const UnknownFrame& frame) {  // a mount is a candidate
      return std::find_first_of(base.begin(), base.end(), frame.axes.begin(), frame.axes.end()) ==
             base.end();
    });
    unknown_ = step_.unknown_frames;
    constexpr int kFolds = 10;
    const PoseGroups poses = by_run(pose_groups(*step_.problem, samples), samples);
    poses_.pose = poses.of_sample;
    poses_.fold = folds_of(samples, poses, std::min(kFolds, poses.count));
    poses_.region = pose_regions(*step_.problem, samples, poses);
    for (const int p : base) {
      if (all_.column(p) >= 0) base_.push_back(all_.column(p));
    }
    for (const IdentifyCandidate& candidate : candidates) {
      SearchCandidate& of = columns_.emplace_back();
      of.rank = candidate.rank;
      for (const int p : candidate.parameters) of.columns.push_back(all_.column(p));
      const auto untouched =  // no residual depends on them
          std::remove_if(of.columns.begin(), of.columns.end(), [](int c) { return c < 0; });
      const bool is_kept = candidate.in_part || untouched == of.columns.end();
      of.columns.erase(is_kept ? untouched : of.columns.begin(), of.columns.end());
    }
    whole_ = columns_;
    // Once: each solve begins where the last one ended.
    for (const auto& [parameter, value] : step_.assignments)
      calibration.table[parameter].value = value;
    step_.assignments.clear();
    calibration.begin = initial_ = numbers_of(calibration.table);
    largest_ = smallest_ = Eigen::VectorXd(all_.size());
    for (int c = 0; c < all_.size(); ++c) {
      const int p = index(c);
      largest_(c) = plausible_change(*step_.problem, p).care;
      const bool positive = is_never_negative(*step_.problem, p);
      smallest_(c) = positive ? -calibration.table[p].value : -largest_(c);
    }
    sigmas_.resize(static_cast<std::size_t>(step_.problem->num_terms()), 0.0);
  }

  [[nodiscard]] const std::vector<SearchCandidate>& candidates() const { return columns_; }
  [[nodiscard]] const std::vector<int>& base() const { return base_; }  ///< columns
  /// Columns of some candidates.
  [[nodiscard]] std::vector<int> columns(const std::vector<int>& chosen) const {
    std::vector<int> all;
    for (const int k : chosen) {
      const std::vector<int>& own = columns_[static_cast<std::size_t>(k)].columns;
      all.insert(all.end(), own.begin(), own.end());
    }
    return all;
  }
  /// The parameter of a column.
  [[nodiscard]] const Parameter& parameter(int column) const {
    return calibration_.table[index(column)];
  }

  /// Leaves out of candidates what the samples do not determine beside the base.
  /// @param linear      at the last solution
  /// @param candidates  those of the search: of what may be freed in part, the parameters that are left
  /// @returns           what the base absorbs, of these and of single parameters
  [[nodiscard]] std::vector<AbsorbedParameters> keep_determined(
      const ParameterSearch& linear, std::vector<IdentifyCandidate>& candidates) {
    const std::vector<int> base = linear.independent(base_);
    std::vector<AbsorbedParameters> all;
    for (std::size_t k = 0; k < candidates.size(); ++k) {
      const std::vector<int>& own = whole_[k].columns;
      const bool in_part = candidates[k].in_part;
      if (!in_part && own.size() > 1) continue;
      const std::vector<int> kept = in_part ? linear.determined(base, own) : std::vector<int>{};
      AbsorbedParameters absorbed{static_cast<int>(k), {}, {}};
      std::set<std::string> by;
      for (const int c : own) {
        if (std::find(kept.begin(), kept.end(), c) != kept.end()) continue;
        const std::set<std::string> owners = absorbing(linear, base, kept, c);
        if (!owners.empty()) absorbed.parameters.push_back(index(c));
        by.insert(owners.begin(), owners.end());
      }
      absorbed.by.assign(by.begin(), by.end());
      if (!by.empty()) all.push_back(std::move(absorbed));
      if (!in_part) continue;
      columns_[k].columns = kept;
      candidates[k].parameters.clear();
      for (const int c : kept) candidates[k].parameters.push_back(index(c));
    }
    return all;
  }

  /// Noise of the first error block at the last solution, and its unit.
  [[nodiscard]] double noise() const { return sigmas_.front(); }
  [[nodiscard]] std::string noise_unit() const { return step_.problem->term(0).options.unit; }

  /// True if no chosen parameter has moved farther than robots are wrong.
  [[nodiscard]] bool is_plausible(const std::vector<int>& chosen) const {
    const std::vector<int> all = columns(chosen);
    return std::all_of(all.begin(), all.end(), [&](int c) {
      const auto p = static_cast<std::size_t>(index(c));
      const double change = values_[p] - initial_[p];
      return change <= largest_(c) && change >= smallest_(c);
    });
  }

  /// Begins with the initial values again, and searches for unknown poses.
  void begin_again() {
    calibration_.begin = initial_;
    step_.unknown_frames = unknown_;
  }
  /// Begins with the values of an earlier result.
  void begin_at(const ParameterTable& table) { calibration_.begin = numbers_of(table); }
  /// begin_again() with another initial value of a candidate's parameter.
  void begin_with(int column, double change) {
    initial_[static_cast<std::size_t>(index(column))] += change;
    begin_again();
  }

  /// Solves with some candidates, from the last solution, until the noise stays.
  CalibrationResult solve(const std::vector<int>& chosen) {
    std::vector<int> free;
    const auto add = [&](const std::vector<int>& columns) {
      for (const int c : columns) free.push_back(index(c));
    };
    add(base_);
    add(columns(chosen));
    CalibrationResult result;
    result.table = calibration_.table;
    for (int p = 0; p < result.table.size(); ++p) {
      double& now = calibration_.begin[static_cast<std::size_t>(p)];
      if (std::find(free.begin(), free.end(), p) == free.end()) {
        now = initial_[static_cast<std::size_t>(p)];
      }
      result.table[p].initial = result.table[p].value;
      result.table[p].value = now;
    }
    constexpr int kSolves = 5;
    for (int round = 0; round < kSolves; ++round) {
      if (free.empty()) {
        result.converged = true;
      } else {
        step_.free = FreeSet(free, calibration_.table.size());
        result = calibrate(calibration_);
        if (!result.converged) return result;
        calibration_.begin = numbers_of(result.table);
        step_.unknown_frames.clear();  // they are known from here on
      }
      values_ = calibration_.begin;
      if (!update_noise()) break;
    }
    return result;
  }

  /// Linearized at the solution; candidates begin with their initial values, so what they explain is in the residuals.
  [[nodiscard]] ParameterSearch linearized() const {
    const auto evaluator = step_.problem->evaluator(all_, 1);
    const int n = all_.size();
    const Coordinates plain{Eigen::MatrixXd::Identity(n, n), Eigen::MatrixXd(n, 0),
                            Eigen::VectorXd::Zero(n), Eigen::VectorXd::Ones(n)};
    LinearFit fit = linear_rows(*evaluator, values_, plain);
    Eigen::VectorXd back = Eigen::VectorXd::Zero(n);
    for (const SearchCandidate& candidate : columns_) {
      for (const int c : candidate.columns) {
        const auto p = static_cast<std::size_t>(index(c));
        back(c) = initial_[p] - values_[p];
      }
    }
    fit.residual += fit.jacobian * back;
    fit.prior_gradient += fit.prior_hessian * back;
    return {fit, poses_, largest_, smallest_};
  }

  /// A weighted residual of 1 as a distance of the error block; of several blocks 1, as errors are in units of noise.
  [[nodiscard]] double distance_of_one() const {
    const Term& only = step_.problem->term(0);
    return sigmas_.size() > 1 ? 1.0 : std::sqrt(only.feature_size) / only.weight;
  }
  /// The unit of such distances.
  [[nodiscard]] std::string unit() const { return sigmas_.size() > 1 ? "1" : noise_unit(); }

 private:
  [[nodiscard]] static std::vector<double> numbers_of(const ParameterTable& table) {
    const Eigen::VectorXd values = table.values();
    return {values.begin(), values.end()};
  }
  [[nodiscard]] int index(int column) const {
    return all_.parameters()[static_cast<std::size_t>(column)];
  }

  /// The owners of those base columns that explain a column beside others; empty: they do not.
  /// @param others  columns of the same candidate
  [[nodiscard]] std::set<std::string> absorbing(const ParameterSearch& linear,
                                                const std::vector<int>& base,
                                                const std::vector<int>& others, int column) const {
    const auto owner = [&](int c) -> const std::string& {
      return step_.problem->owners()[static_cast<std::size_t>(index(c))];
    };
    const auto is_explained = [&](const auto& is_used) {
      std::vector<int> by = others;
      std::copy_if(base.begin(), base.end(), std::back_inserter(by), is_used);
      return linear.explains(by, column);
    };
    const auto all = [](int) { return true; };
    const auto none = [](int) { return false; };
    if (!is_explained(all) || is_explained(none)) return {};
    std::set<std::string> owners, needed, enough;
    for (const int c : base) owners.insert(owner(c));
    for (const std::string& of : owners) {
      if (!is_explained([&](int c) { return owner(c) != of; })) needed.insert(of);
      if (is_explained([&](int c) { return owner(c) == of; })) enough.insert(of);
    }
    return !enough.empty() ? enough : !needed.empty() ? needed : owners;
  }

  /// Sets the noise of each error block to what the median residual shows.
  /// @returns  whether one has changed
  bool update_noise() {
    AnyProblem& problem = *step_.problem;
    std::vector<std::vector<double>> residuals(sigmas_.size());
    (void)evaluate(problem, values_, nullptr, [&](int t, int, const TermResiduals& of) {
      for (Eigen::Index i = 0; i < of.residual.size(); ++i) {
        if (of.residual(i) != 0.0)
          residuals[static_cast<std::size_t>(t)].push_back(std::abs(of.residual(i)));
      }
    });
    constexpr double kOfMedian = 1.4826, kSame = 0.05;
    bool changed = false;
    for (std::size_t t = 0; t < sigmas_.size(); ++t) {
      std::vector<double>& all = residuals[t];
      if (all.empty()) continue;
      const double sigma =
          std::max(kOfMedian * median_of(std::move(all)), std::numeric_limits<double>::min());
      if (std::abs(sigma - sigmas_[t]) <= kSame * sigma) continue;
      sigmas_[t] = sigma;
      step_.set_sigma(static_cast<int>(t), sigma);
      changed = true;
    }
    return changed;
  }

  Calibration& calibration_;
  CalibrationStep& step_;
  FreeSet all_;
  std::vector<UnknownFrame> unknown_;
  std::vector<SearchCandidate> whole_;    ///< with all parameters that residuals depend on
  std::vector<SearchCandidate> columns_;  ///< with those that are freed
  std::vector<int> base_;
  SearchPoses poses_;
  Eigen::VectorXd largest_, smallest_;  ///< plausible changes, by column
  std::vector<double> initial_, sigmas_, values_;
};

// Whole frames in place of several of their parameters.

/// The chosen candidates with a whole frame in place of those that have part of it, or that it leaves undetermined.
[[nodiscard]] std::vector<int> with_frame(const ParameterSearch& linear,
                                          const Identification& search, int frame,
                                          const std::vector<int>& chosen) {
  const auto columns = [&](int k) {
    return search.candidates()[static_cast<std::size_t>(k)].columns;
  };
  const std::vector<int> base = linear.independent(search.base()), of_frame = columns(frame);
  std::vector<int> with = {frame};
  for (const int k : chosen) {
    const std::vector<int> own = columns(k);
    if (std::find_first_of(own.begin(), own.end(), of_frame.begin(), of_frame.end()) != own.end())
      continue;
    with.push_back(k);
    if (!std::isfinite(linear.fit_of(base, search.candidates(), with).held_out)) with.pop_back();
  }
  return with;
}

/// Takes a whole frame in place of several parameters, where that frees no more and poses held out are predicted as
/// well: how a head or an arm is mounted is one cause, not five.  At a solution with it, as mounts are far off.
void take_whole_frames(Identification& search, Identified& found) {
  constexpr int kMount = 1;  // rank
  constexpr double kAsWell = 1.01;
  const auto all = static_cast<int>(search.candidates().size());
  for (int frame = 0; frame < all && found.chosen.size() > 1; ++frame) {
    const bool is_chosen =
        std::find(found.chosen.begin(), found.chosen.end(), frame) != found.chosen.end();
    const SearchCandidate& mount = search.candidates()[static_cast<std::size_t>(frame)];
    if (is_chosen || mount.rank != kMount || mount.columns.empty()) continue;
    const auto fit = [&](const ParameterSearch& linear, const std::vector<int>& chosen) {
      SearchFit of = linear.fit_of(linear.independent(search.base()), search.candidates(), chosen);
      of.held_out *= search.distance_of_one();
      return of;
    };
    const ParameterSearch now = search.linearized();
    const SearchFit before = fit(now, found.chosen);
    std::vector<int> with = with_frame(now, search, frame, found.chosen);
    CalibrationResult result = search.solve(with);
    if (result.converged) {
      const ParameterSearch linear = search.linearized();
      linear.run(linear.independent(search.base()), search.candidates(), with);
      result = search.solve(with);
    }
    if (result.converged && search.is_plausible(with) && with.size() < found.chosen.size()) {
      const SearchFit after = fit(search.linearized(), with);
      if (after.columns <= before.columns && after.held_out <= kAsWell * before.held_out) {
        found.chosen = std::move(with);
        found.result = std::move(result);
        continue;
      }
    }
    search.begin_at(found.result.table);
    found.result = search.solve(found.chosen);
  }
}

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
