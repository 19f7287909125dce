// Fitting frames alone.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <numbers>
#include <optional>
#include <set>
#include <utility>

#include "kinecal/evaluation/parallel.hpp"
#include "kinecal/geometry/ldlt.hpp"
#include "kinecal/solve/fit_frames.hpp"
#include "kinecal/solve/rotation_grid.hpp"

namespace kinecal::detail {

// The fit of frames from one start.

inline constexpr double kNoFit = std::numeric_limits<double>::infinity();

/// Sets the free components of a rotation vector.
inline void set_rotation(const UnknownFrame& frame, const Vector3<double>& vector,
                         Eigen::VectorXd& values) {
  for (std::size_t k = 0; k < 3; ++k) {
    if (frame.axes[3 + k] >= 0) values(frame.axes[3 + k]) = vector(static_cast<int>(k));
  }
}

/// Component k of a grid rotation sets the k-th free axis.
inline void set_grid_rotation(const UnknownFrame& frame, int index, int count,
                              Eigen::VectorXd& values) {
  std::vector<int> free;
  for (std::size_t k = 3; k < 6; ++k) {
    if (frame.axes[k] >= 0) free.push_back(frame.axes[k]);
  }
  const Vector3<double> vector = grid_rotation(index, count, static_cast<int>(free.size()));
  for (std::size_t k = 0; k < free.size(); ++k) values(free[k]) = vector(static_cast<int>(k));
}

/// Limits rotation vectors to length pi: beyond that, derivatives fade.
inline void shorten_rotations(std::span<const UnknownFrame> frames, Eigen::VectorXd& values) {
  for (const UnknownFrame& frame : frames) {
    if (frame.turns()) set_rotation(frame, shortest(rotation_of(frame, values)), values);
  }
}

/// Fits the evaluator's free parameters from one start.
class FrameFit {
 public:
  FrameFit(AnyEvaluator& evaluator, std::span<const UnknownFrame> frames)
      : evaluator_(evaluator), frames_(frames) {
    const FreeSet& free = evaluator.free();
    for (const UnknownFrame& frame : frames) {
      for (std::size_t k = 0; k < 3; ++k) {
        if (free.column(frame.axes[k]) >= 0) translations_.push_back(free.column(frame.axes[k]));
      }
    }
  }

  /// @param values      in: where to start; out: where it ended
  /// @param iterations  the largest number
  /// @returns  the cost; infinite if it is not defined there
  [[nodiscard]] double operator()(Eigen::VectorXd& values, int iterations) {
    NormalEquations at = placed(values);
    const double nothing = kRounding * at.cost;
    double damping = kFirstDamping;
    for (int i = 0; at.cost > nothing && i < iterations && damping < kMostDamping; ++i) {
      Eigen::VectorXd trial = values;
      add_step(at, damping, trial);
      NormalEquations next = placed(trial);
      if (!(next.cost <= at.cost)) {
        damping *= 8.0;
        continue;
      }
      const bool settled = at.cost - next.cost <= kSettled * at.cost;
      values = std::move(trial);
      at = std::move(next);
      if (settled) break;
      damping = std::max(0.1 * damping, kLeastDamping);
    }
    if (!std::isfinite(at.cost)) return kNoFit;
    return at.cost;
  }

 private:
  static constexpr double kFirstDamping = 1e-3, kLeastDamping = 1e-9, kMostDamping = 1e8;
  static constexpr double kSettled = 1e-6;    // of the cost, by one step
  static constexpr double kRounding = 1e-20;  // of the cost at the start

  [[nodiscard]] NormalEquations equations(const Eigen::VectorXd& values) {
    return evaluator_.normal_equations({values.data(), static_cast<std::size_t>(values.size())},
                                       true, Losses::convex);
  }

  /// Moves to the translations of least cost, as far as the cost is quadratic in them: the
  /// rotations then turn the frames about the points, not about an origin that may be far away.
  /// @returns  the normal equations there
  [[nodiscard]] NormalEquations placed(Eigen::VectorXd& values) {
    NormalEquations at = equations(values);
    if (translations_.empty() || !std::isfinite(at.cost)) return at;
    const std::vector<int>& t = translations_;
    Eigen::MatrixXd hessian = at.hessian(t, t);
    hessian.diagonal().array() += kLeastDamping * hessian.diagonal().maxCoeff();
    const Eigen::VectorXd step = Ldlt(hessian).solve(Eigen::VectorXd(-at.gradient(t)));
    Eigen::VectorXd trial = values;
    for (std::size_t k = 0; k < t.size(); ++k) {
      trial(evaluator_.free().parameters()[static_cast<std::size_t>(t[k])]) +=
          step(static_cast<Eigen::Index>(k));
    }
    NormalEquations next = equations(trial);
    if (!(next.cost < at.cost)) return at;
    values = std::move(trial);
    return next;
  }

  void add_step(const NormalEquations& at, double damping, Eigen::VectorXd& values) const {
    constexpr double kFloor = 1e-9;  // of the largest: a direction without curvature stays
    Eigen::MatrixXd damped = at.hessian;
    const double floor = kFloor * damped.diagonal().maxCoeff();
    damped.diagonal() += damping * damped.diagonal().cwiseMax(floor);
    const Eigen::VectorXd step = Ldlt(damped).solve(Eigen::VectorXd(-at.gradient));
    const std::vector<int>& columns = evaluator_.free().parameters();
    for (std::size_t c = 0; c < columns.size(); ++c) {
      values(columns[c]) += step(static_cast<Eigen::Index>(c));
    }
    shorten_rotations(frames_, values);
  }

  AnyEvaluator& evaluator_;
  std::span<const UnknownFrame> frames_;
  std::vector<int> translations_;  ///< columns
};

[[nodiscard]] inline Eigen::VectorXd vector_of(ParameterValues values) {
  return Eigen::Map<const Eigen::VectorXd>(values.data(), std::ssize(values));
}

inline constexpr int kGrid = 300;  // rotations of the finest grid

KINECAL_INLINE UnknownFrame unknown_frame(const std::string& name, const ParameterTable& table,
                                          const FreeSet& free, bool has_guess) {
  UnknownFrame frame{.name = name, .has_guess = has_guess};
  for (std::size_t k = 0; k < 6; ++k) {
    const int parameter = table.find(parameter_name(name, kFrameAxes[k]));
    if (free.column(parameter) >= 0) frame.axes[k] = parameter;
  }
  return frame;
}

KINECAL_INLINE Vector3<double> rotation_of(const UnknownFrame& frame,
                                           const Eigen::VectorXd& values) {
  Vector3<double> vector = Vector3<double>::Zero();
  for (std::size_t k = 0; k < 3; ++k) {
    if (frame.axes[3 + k] >= 0) vector(static_cast<int>(k)) = values(frame.axes[3 + k]);
  }
  return vector;
}

KINECAL_INLINE double turn_between(const UnknownFrame& frame, const Eigen::VectorXd& from,
                                   const Eigen::VectorXd& to) {
  const Matrix3<double> turn =
      exp(rotation_of(frame, from)).transpose() * exp(rotation_of(frame, to));
  return log(turn).norm();
}

KINECAL_INLINE bool any_turned(std::span<const UnknownFrame> frames, bool has_guess,
                               const Eigen::VectorXd& from, const Eigen::VectorXd& to) {
  constexpr double kLikely = std::numbers::pi / 6.0;
  return std::any_of(frames.begin(), frames.end(), [&](const UnknownFrame& frame) {
    return frame.has_guess == has_guess && turn_between(frame, from, to) > kLikely;
  });
}

/// True if two fits ended at the same minimum.
[[nodiscard]] inline bool same_fit(const FittedFrames& a, const FittedFrames& b,
                                   std::span<const UnknownFrame> frames) {
  constexpr double kEqual = 1e-5, kClose = 1e-2;  // relative
  constexpr double kSameWay = 0.2;                // radians
  const double more = std::max(a.cost, b.cost), difference = std::abs(a.cost - b.cost);
  if (difference <= kEqual * more) return true;
  return difference <= kClose * more &&
         std::all_of(frames.begin(), frames.end(), [&](const UnknownFrame& frame) {
           return turn_between(frame, a.values, b.values) < kSameWay;
         });
}

/// Distinct fits, lowest cost first; of equal ones, that of the earliest start.
[[nodiscard]] inline std::vector<FittedFrames> distinct(std::vector<FittedFrames> fits,
                                                        std::span<const UnknownFrame> frames) {
  std::stable_sort(fits.begin(), fits.end(),
                   [](const auto& a, const auto& b) { return a.cost < b.cost; });
  std::vector<FittedFrames> all;
  for (FittedFrames& fit : fits) {
    if (!std::isfinite(fit.cost)) break;
    const auto same = std::find_if(all.begin(), all.end(), [&](const FittedFrames& known) {
      return same_fit(known, fit, frames);
    });
    if (same == all.end()) {
      all.push_back(std::move(fit));
    } else {
      same->starts += fit.starts;
    }
  }
  return all;
}

KINECAL_INLINE bool any_turns(std::span<const UnknownFrame> frames) {
  return std::any_of(frames.begin(), frames.end(),
                     [](const UnknownFrame& frame) { return frame.turns(); });
}

/// The values of a start.  A round takes every n-th rotation of a finer grid, which is still even.
/// Each frame walks the grid with its own stride, so combinations of several frames are spread,
/// too.
/// @param index  in that grid
[[nodiscard]] inline Eigen::VectorXd start_values(std::span<const UnknownFrame> frames, int index,
                                                  Eigen::VectorXd values) {
  constexpr std::array<int, 4> kStrides = {1, 89, 47, 161};  // share no factor with the count
  std::size_t turning = 0;
  for (const UnknownFrame& frame : frames) {
    if (!frame.turns()) continue;
    const int stride = kStrides[turning++ % kStrides.size()];
    set_grid_rotation(frame, index * stride % kGrid, kGrid, values);
  }
  return values;
}

using Evaluators = std::vector<std::unique_ptr<AnyEvaluator>>;

/// Continues fits, one per evaluator at a time.
inline void go_on(std::vector<FittedFrames>& fits, int iterations, Evaluators& evaluators,
                  std::span<const UnknownFrame> frames) {
  const int threads = static_cast<int>(evaluators.size());
  for_each_piece(static_cast<int>(fits.size()), threads, [&](int i, int thread) {
    FrameFit fit(*evaluators[static_cast<std::size_t>(thread)], frames);
    FittedFrames& at = fits[static_cast<std::size_t>(i)];
    at.cost = fit(at.values, iterations);
  });
}

/// One round of starts.  After a few iterations, only the best continue: the others would take most
/// of the time.
[[nodiscard]] inline std::vector<FittedFrames> fit_round(Evaluators& evaluators,
                                                         std::span<const UnknownFrame> frames,
                                                         const Eigen::VectorXd& values, int round,
                                                         const PoseSearch& search) {
  constexpr int kMost = 40;  // iterations
  std::vector<FittedFrames> fits;
  const int starts = any_turns(frames) ? search.starts : 1, step = kGrid / starts;
  for (int start = 0; start < starts; ++start) {
    fits.push_back({0.0, start_values(frames, step * start + round, values), 1});
  }
  go_on(fits, search.first, evaluators, frames);
  std::stable_sort(fits.begin(), fits.end(),
                   [](const auto& a, const auto& b) { return a.cost < b.cost; });
  fits.resize(std::min(fits.size(), search.kept));
  go_on(fits, kMost, evaluators, frames);
  return fits;
}

KINECAL_INLINE std::vector<SearchStage> search_stages(const AnyProblem& excerpt,
                                                      std::span<const UnknownFrame> frames) {
  std::vector<std::set<std::size_t>> of_term(static_cast<std::size_t>(excerpt.num_terms()));
  for (std::size_t t = 0; t < of_term.size(); ++t) {
    const std::vector<int> touched = excerpt.touched_parameters(static_cast<int>(t));
    for (std::size_t f = 0; f < frames.size(); ++f) {
      const auto& axes = frames[f].axes;
      const bool is_needed = std::any_of(axes.begin(), axes.end(), [&](int axis) {
        return axis >= 0 && std::binary_search(touched.begin(), touched.end(), axis);
      });
      if (is_needed) of_term[t].insert(f);
    }
  }
  std::vector<SearchStage> stages;
  std::set<std::size_t> known;
  const auto is_known = [&](std::size_t f) { return known.contains(f); };
  const auto add = [&](const std::set<std::size_t>& needed) {
    SearchStage& stage = stages.emplace_back();
    for (const std::size_t f : needed) {
      if (!is_known(f)) stage.frames.push_back(frames[f]);
    }
    const std::set<std::size_t> before = known;
    known.insert(needed.begin(), needed.end());
    for (std::size_t t = 0; t < of_term.size(); ++t) {
      const std::set<std::size_t>& of = of_term[t];
      const bool is_new =
          std::any_of(of.begin(), of.end(), [&](auto f) { return !before.contains(f); });
      if (is_new && std::all_of(of.begin(), of.end(), is_known))
        stage.terms.push_back(static_cast<int>(t));
    }
  };
  for (;;) {
    std::optional<std::size_t> next;
    std::pair<std::ptrdiff_t, int> least;  // unknown frames, and fewer than no samples
    for (std::size_t t = 0; t < of_term.size(); ++t) {
      const int term = static_cast<int>(t);
      const auto open = std::count_if(of_term[t].begin(), of_term[t].end(),
                                      [&](std::size_t f) { return !is_known(f); });
      if (open == 0 || excerpt.term(term).sensors.size() < 2) continue;  // a plane is no pose
      const std::pair<std::ptrdiff_t, int> now(open, -excerpt.samples_of(term));
      if (next && now >= least) continue;
      next = t;
      least = now;
    }
    if (!next) break;
    add(of_term[*next]);
  }
  if (stages.size() < 2 || known.size() < frames.size()) {
    return {{{frames.begin(), frames.end()}, {}}};
  }
  return stages;
}

/// Fits the frames of a stage.
/// @param values  of all parameters: where the others are
[[nodiscard]] inline FrameFits fit_stage(const AnyProblem& excerpt, const SearchStage& stage,
                                         const Eigen::VectorXd& values, int threads,
                                         const PoseSearch& search) {
  constexpr int kOftenEnough = 5;
  FrameFits all;
  std::vector<int> columns;
  for (const UnknownFrame& frame : stage.frames) {
    std::copy_if(frame.axes.begin(), frame.axes.end(), std::back_inserter(columns),
                 [](int parameter) { return parameter >= 0; });
  }
  const FreeSet free(columns, excerpt.table().size());
  Evaluators evaluators(
      static_cast<std::size_t>(std::min(number_of_threads(threads), search.starts)));
  for (auto& evaluator : evaluators) evaluator = excerpt.evaluator(free, 1, stage.terms);
  for (int round = 0; round < search.rounds; ++round) {
    std::vector<FittedFrames> fits = fit_round(evaluators, stage.frames, values, round, search);
    all.starts += any_turns(stage.frames) ? search.starts : 1;
    std::move(fits.begin(), fits.end(), std::back_inserter(all.minima));
    all.minima = distinct(std::move(all.minima), stage.frames);
    if (!any_turns(stage.frames)) break;
    if (!all.minima.empty() && all.minima.front().starts >= kOftenEnough) break;
  }
  return all;
}

KINECAL_INLINE FrameFits fit_frames(const AnyProblem& excerpt, std::span<const UnknownFrame> frames,
                                    const Eigen::VectorXd& values, int threads,
                                    const PoseSearch& search) {
  if (!any_turns(frames)) return {};
  const std::vector<SearchStage> stages = search_stages(excerpt, frames);
  FrameFits all = fit_stage(excerpt, stages.front(), values, threads, search);
  if (stages.size() == 1 || all.minima.empty()) return all;
  const double worth = kWorthFinishing * all.minima.front().cost;
  std::erase_if(all.minima, [&](const FittedFrames& fit) { return fit.cost > worth; });
  all.minima.resize(std::min(all.minima.size(), search.finished));
  const auto evaluator = excerpt.evaluator(FreeSet({}, excerpt.table().size()), threads);
  for (FittedFrames& fit : all.minima) {
    for (std::size_t s = 1; s < stages.size() && std::isfinite(fit.cost); ++s) {
      const FrameFits next = fit_stage(excerpt, stages[s], fit.values, threads, search);
      all.starts += next.starts;
      fit.cost = next.minima.empty() ? kNoFit : next.minima.front().cost;
      if (!next.minima.empty()) fit.values = next.minima.front().values;
    }
    if (!std::isfinite(fit.cost)) continue;
    const std::span<const double> at(fit.values.data(),
                                     static_cast<std::size_t>(fit.values.size()));
    fit.cost = evaluator->normal_equations(at, false, Losses::convex).cost;
  }
  all.minima = distinct(std::move(all.minima), frames);
  return all;
}

KINECAL_INLINE double cost_of_frames(const AnyProblem& excerpt,
                                     std::span<const UnknownFrame> frames, ParameterValues values,
                                     const PoseSearch& search) {
  const FrameFits fits = fit_frames(excerpt, frames, vector_of(values), 1, search);
  return fits.minima.empty() ? std::numeric_limits<double>::infinity() : fits.minima.front().cost;
}

KINECAL_INLINE double cost_after(AnyEvaluator& evaluator, ParameterValues values, int iterations) {
  Eigen::VectorXd at = vector_of(values);
  return FrameFit(evaluator, {})(at, iterations);
}

}  // namespace kinecal::detail
