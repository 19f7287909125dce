// Solves from several starts.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <mutex>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "kinecal/evaluation/any_evaluator.hpp"
#include "kinecal/evaluation/parallel.hpp"
#include "kinecal/solve/starts.hpp"

namespace kinecal {

namespace detail {

// Random starts: joints and frames moved within the ranges of starts.hpp.

/// The range of a parameter's random offset; zero for those of sensors and error blocks.
/// @returns  radians or metres, to either side
[[nodiscard]] inline double random_reach(const AnyProblem& problem, int parameter) {
  constexpr double kDegree = std::numbers::pi / 180.0;
  const Parameter& p = problem.table()[parameter];
  const std::string& owner = problem.owners()[static_cast<std::size_t>(parameter)];
  const bool turns = p.unit == "rad";
  if (p.name == owner) {
    return turns ? random_start::kJointDegrees * kDegree : random_start::kJointMetres;
  }
  if (!is_frame_parameter(p.name, owner)) return 0.0;
  return turns ? random_start::kFrameDegrees * kDegree : random_start::kFrameMetres;
}

/// Values with the free joints and frames moved.
/// @param n  number of the start, used as its seed
[[nodiscard]] inline Eigen::VectorXd random_start_near(const AnyProblem& problem,
                                                       const FreeSet& free, Eigen::VectorXd values,
                                                       int n) {
  std::mt19937_64 engine(static_cast<std::uint64_t>(n) + 1);
  engine.discard(16);  // similar seeds give similar first numbers
  for (const int p : free.parameters()) {
    const double unit = static_cast<double>(engine() >> 11) * 0x1p-53;  // the same on all platforms
    values(p) += (2.0 * unit - 1.0) * random_reach(problem, p);
  }
  return values;
}

/// A solve: where it started and ended.
struct Attempt {
  Eigen::VectorXd start, values;
  StepResult result;
};

/// All starts of a step.
class Starts {
 public:
  /// @param unknown  frames whose pose may be anywhere
  Starts(const AnyProblem& problem, const FreeSet& free, const SolveOptions& options,
         const Eigen::VectorXd& from, std::span<const UnknownFrame> unknown)
      : problem_(problem), free_(free), options_(options), from_(from) {
    const auto is_unknown = [&](int p) {
      return std::any_of(unknown.begin(), unknown.end(), [p](const UnknownFrame& frame) {
        return std::find(frame.axes.begin(), frame.axes.end(), p) != frame.axes.end();
      });
    };
    for (const int p : free.parameters()) {
      const bool of_joint =
          problem.robot().has_joint(problem.owners()[static_cast<std::size_t>(p)]);
      if (of_joint && !is_unknown(p)) of_joints_.push_back(p);
    }
    for (const UnknownFrame& frame : unknown) {
      const bool is_found = std::all_of(frame.axes.begin(), frame.axes.end(),
                                        [](int axis) { return axis < 0; });  // before the solve
      if (!frame.has_guess && is_found) summary_.frames.push_back(frame.name);
    }
    const double cost = cost_at(*problem.evaluator(free, options.threads), from);
    if (std::isfinite(cost)) floor_ = kRounding * cost;
  }

  /// Solves from the configured values; of equal results, prefers this one, unless a frame that was
  /// searched for is elsewhere: a camera after half a turn, with negative focal lengths.
  void solve_plain(const Eigen::VectorXd& start, std::span<const UnknownFrame> frames) {
    Attempt plain{start, start, {}};
    if (!solve_plain(plain)) return;
    count(plain);
    const bool elsewhere =
        best_.result.converged && any_turned(frames, false, best_.values, plain.values);
    if (elsewhere ? is_better(plain, best_) : !is_better(best_, plain)) best_ = std::move(plain);
  }

  /// Searches for the poses of frames and solves from the best few fits.
  /// @returns  true if one of these solves converged
  bool search(const AnyProblem& excerpt, std::span<const UnknownFrame> frames,
              const Eigen::VectorXd& from) {
    summary_.frames.clear();
    for (const UnknownFrame& frame : frames) {
      if (frame.turns()) (frame.has_guess ? summary_.given : summary_.frames).push_back(frame.name);
    }
    std::vector<Eigen::VectorXd> starts;
    const auto evaluator = problem_.evaluator(free_, options_.threads);
    double least = 0.0;
    const FrameFits fits = fit_frames(excerpt, frames, from, options_.threads, options_.search);
    summary_.starts += fits.starts;
    for (const FittedFrames& fit : fits.minima) {
      if (starts.empty()) least = fit.cost;
      if (starts.size() == options_.search.finished || fit.cost > kWorthFinishing * least + floor_)
        break;
      if (std::isfinite(cost_at(*evaluator, fit.values))) starts.push_back(fit.values);
    }
    solve_all(starts);
    return best_.result.converged;
  }

  /// Solves from random starts around that of the best solve so far.
  void solve_random() {
    summary_.random_starts = options_.random_starts;
    const Eigen::VectorXd from =
        best_.result.converged ? best_.start : Eigen::VectorXd(best_.values);
    std::vector<Eigen::VectorXd> starts;
    for (int n = 0; n < options_.random_starts; ++n)
      starts.push_back(random_start_near(problem_, free_, from, n));
    solve_all(starts);
  }

  /// True if the best solve so far casts doubt on the given poses.
  [[nodiscard]] bool ended_badly(std::span<const UnknownFrame> frames,
                                 const Eigen::VectorXd& from) const {
    return !best_.result.converged || any_turned(frames, true, from, best_.values) ||
           bent_parts(best_.values) > 0;
  }

  /// The result and, if usable, its values.
  [[nodiscard]] StepResult finish(Eigen::VectorXd& values, double seconds) {
    StepResult result = std::move(best_.result);
    values = std::move(best_.values);
    summary_.seconds = seconds;
    for (std::size_t i = 0; result.converged && i < summary_.minima.size(); ++i) {
      const FoundMinimum& minimum = summary_.minima[i];
      if (result.final_cost > minimum.cost * (1.0 + kSameCost) + floor_) continue;
      summary_.taken = static_cast<int>(i);
      break;
    }
    if (!summary_.searched()) summary_ = {.frames = std::move(summary_.frames)};
    result.starts = std::move(summary_);
    return result;
  }

 private:
  static constexpr double kRounding = 1e-16;  // of the cost at the start

  [[nodiscard]] static double cost_at(AnyEvaluator& evaluator, const Eigen::VectorXd& values) {
    const std::span<const double> all(values.data(), static_cast<std::size_t>(values.size()));
    return evaluator.normal_equations(all, false).cost;
  }

  /// @returns  false if it gave up because it does not come near a minimum that a search found: a
  ///           solve that goes astray takes a hundred times as long
  [[nodiscard]] bool solve_plain(Attempt& plain) const {
    constexpr int kTrial = 25;         // iterations
    constexpr double kFarAbove = 2.0;  // times the cost found by the search
    if (best_.result.converged && options_.max_num_iterations > kTrial) {
      SolveOptions trial = options_;
      trial.max_num_iterations = kTrial;
      Eigen::VectorXd values = plain.start;
      const StepResult result = solve(problem_, free_, values, trial);
      const bool may_go_on = result.iterations >= kTrial;
      if (may_go_on && result.final_cost > kFarAbove * best_.result.final_cost + floor_)
        return false;
      if (!may_go_on) {
        plain.values = std::move(values);
        plain.result = result;
        return true;
      }
    }
    plain.result = solve(problem_, free_, plain.values, options_);
    return true;
  }

  void count(const Attempt& attempt) {
    if (attempt.result.converged) {
      add_minimum(summary_, attempt.result.final_cost, floor_);
    } else {
      ++summary_.failed;
    }
  }

  /// Solves in parallel and keeps the best; of equals, the first.
  void solve_all(const std::vector<Eigen::VectorXd>& starts) {
    const int n = static_cast<int>(starts.size());
    std::vector<Attempt> attempts(starts.size());
    SolveOptions options = options_;
    options.threads = 1;
    options.progress = {};
    std::mutex one_at_a_time;
    int done = 0;
    for_each_piece(n, number_of_threads(options_.threads), [&](int i, int) {
      Attempt& attempt = attempts[static_cast<std::size_t>(i)];
      attempt.start = attempt.values = starts[static_cast<std::size_t>(i)];
      attempt.result = solve(problem_, free_, attempt.values, options);
      if (!options_.meter) return;
      const std::lock_guard lock(one_at_a_time);
      options_.meter(static_cast<double>(++done) / n, "solving from several starts");
    });
    for (Attempt& attempt : attempts) {
      count(attempt);
      if (is_better(attempt, best_)) best_ = std::move(attempt);
    }
  }

  /// How many parameters of joints say that the robot is not the one of the URDF: turned by more than 45 degrees or
  /// moved by more than 0.1 m, as in the mirror image of the right minimum.
  [[nodiscard]] int bent_parts(const Eigen::VectorXd& values) const {
    constexpr double kTurned = std::numbers::pi / 4.0, kMoved = 0.1;
    return static_cast<int>(std::count_if(of_joints_.begin(), of_joints_.end(), [&](int p) {
      const std::string& unit = problem_.table()[p].unit;
      const double by = std::abs(values(p) - from_(p));
      return (unit == "rad" && by > kTurned) || (unit == "m" && by > kMoved);
    }));
  }

  /// True if noise may have decided which of two costs is lower: chi-square differs by less than it scatters, or by
  /// less than what any model lacks.
  [[nodiscard]] bool are_alike(const StepResult& a, const StepResult& b) const {
    constexpr double kChance = 12.0, kLacks = 0.02;
    const double less = std::min(a.final_cost, b.final_cost),
                 by = std::abs(a.final_cost - b.final_cost);
    const double freedom = std::max(1.0, static_cast<double>(a.num_residuals - a.num_parameters));
    return by <= std::max(kChance / freedom, kLacks) * less + floor_;
  }

  /// True for the lower cost; of costs that are alike, for the robot that is nearer to its URDF.
  [[nodiscard]] bool is_better(const Attempt& one, const Attempt& other) const {
    const StepResult &a = one.result, &b = other.result;
    if (a.converged != b.converged) return a.converged;
    if (!a.converged) return false;
    const int bent = bent_parts(one.values), bent_other = bent_parts(other.values);
    if (bent != bent_other && are_alike(a, b)) return bent < bent_other;
    return a.final_cost < b.final_cost * (1.0 - kSameCost) - floor_;
  }

  const AnyProblem& problem_;
  const FreeSet& free_;
  const SolveOptions& options_;
  Eigen::VectorXd from_;        ///< of all parameters: the configured values
  std::vector<int> of_joints_;  ///< free parameters of joints whose place is known
  StartSummary summary_;
  Attempt best_;
  double floor_ = 0.0;  ///< costs below are rounding
};

}  // namespace detail

KINECAL_INLINE StepResult solve_from_starts(const AnyProblem& problem, const FreeSet& free,
                                            Eigen::VectorXd& values, const SolveOptions& options,
                                            std::span<const UnknownFrame> unknown,
                                            const AnyProblem* excerpt) {
  const auto begin = std::chrono::steady_clock::now();
  const Eigen::VectorXd from = values;
  const AnyProblem& few = excerpt != nullptr ? *excerpt : problem;
  detail::Starts starts(problem, free, options, from, unknown);
  std::vector<UnknownFrame> without_guess;
  std::copy_if(unknown.begin(), unknown.end(), std::back_inserter(without_guess),
               [](const UnknownFrame& frame) { return !frame.has_guess; });
  const bool searched = detail::any_turns(without_guess) && starts.search(few, without_guess, from);
  if (options.search.plain || !searched) starts.solve_plain(from, unknown);
  if (without_guess.size() < unknown.size() && starts.ended_badly(unknown, from)) {
    starts.search(few, unknown, from);
  }
  if (options.random_starts > 0) starts.solve_random();
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - begin;
  return starts.finish(values, seconds.count());
}

}  // namespace kinecal
