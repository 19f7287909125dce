// Definitions of explain_fit.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/explain/explain_fit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <numeric>
#include <optional>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "kinecal/config/configured_sensor.hpp"
#include "kinecal/config/doubts/used_joints.hpp"
#include "kinecal/evaluation/parallel.hpp"
#include "kinecal/explain/refit.ipp"
#include "kinecal/geometry/median.hpp"
#include "kinecal/parameters/joint_models/joint_models.hpp"
#include "kinecal/text/first_names.hpp"
#include "kinecal/trust/assess.hpp"
#include "kinecal/trust/judge_files.hpp"

namespace kinecal {

namespace detail {
namespace {

// The scale of points with which samples fit best: a board with larger squares than configured.

/// A fit at another scale of points.
struct ScaledFit {
  double factor = 1.0;
  Refit after;
};

/// The fitted samples at another scale.
[[nodiscard]] std::vector<Sample> with_scaled(const Refits& refits, const Suspect& suspect,
                                              double factor) {
  std::vector<Sample> samples = refits.some();
  for (Sample& sample : samples) suspect.scale(sample, factor);
  return samples;
}

/// A cost without what smaller lengths take off; larger ones need not make residuals larger, and pixels stay pixels.
/// @param factor  of lengths
[[nodiscard]] double in_measured_units(const Refits& refits, double cost, double factor) {
  const double by = refits.are_of_pixels() ? 1.0 : std::min(1.0, factor);
  return cost / (by * by);
}

/// The fit at the best scale, from the best of some far ones where the samples do not fit as they are, by parabolas through three costs over the logarithm of the scale; nullopt if it leaves
/// more than a part of the cost, in units that do not shrink.
[[nodiscard]] std::optional<ScaledFit> scaled_fit(const Refits& refits, const Suspect& suspect,
                                                  const Refit& now, double part) {
  const auto fit = [&](double x) { return refits.with(with_scaled(refits, suspect, std::exp(x))); };
  constexpr double kFirst = 0.1, kFurthest = 1.1, kEnough = 1e-3, kNothing = 1e-6;
  constexpr int kSteps = 8;
  double best = 0.0, step = kFirst;
  Refit at_best = now;
  if (!fits(now)) {  // a board of twice the size is beyond what a parabola shows
    constexpr int kSide = 5;
    std::vector<std::optional<Refit>> afar(2 * kSide + 1);
    const auto at = [&](int i) { return kFurthest * (i - kSide) / kSide; };
    for_each_piece(2 * kSide + 1, number_of_threads(0), [&](int i, int) {
      if (i != kSide) afar[static_cast<std::size_t>(i)] = fit(at(i));
    });
    for (int i = 0; i < 2 * kSide + 1; ++i) {
      std::optional<Refit>& one = afar[static_cast<std::size_t>(i)];
      if (!one || !(in_measured_units(refits, one->cost, std::exp(at(i))) <
                    in_measured_units(refits, at_best.cost, std::exp(best)))) {
        continue;
      }
      best = at(i);
      at_best = *std::move(one);
    }
  }
  for (int i = 0; i < kSteps && step > kEnough; ++i) {
    const auto above = fit(best + step);
    if (!above) return std::nullopt;
    if (i == 0 && std::abs(above->cost - at_best.cost) < kNothing * at_best.cost) {
      return std::nullopt;  // no sample knows it, as where cameras alone see a board
    }
    const auto below = fit(best - step);
    if (!below) return std::nullopt;
    const double curvature = below->cost - 2.0 * at_best.cost + above->cost;
    const double slope = 0.5 * (above->cost - below->cost);
    const double most = 4.0 * step, center = best;
    const double move = curvature > 0.0 ? std::clamp(-slope / curvature * step, -most, most)
                                        : (slope > 0.0 ? -most : most);
    const auto next = fit(center + move);
    const bool is_in_reach = next && std::abs(center + move) <= kFurthest;
    const double reached = step;
    for (const auto& [x, one] : {std::pair(center + reached, &above),
                                 {center - reached, &below},
                                 {center + move, &next}}) {
      if (!*one || std::abs(x) > kFurthest || !((*one)->cost < at_best.cost)) continue;
      best = x;
      at_best = **one;
    }
    if (best == center && !is_in_reach) return std::nullopt;
    if (i == 0 && std::abs(move) < most && at_best.cost > 2.0 * part * now.cost) {
      return std::nullopt;  // the parabola shows well enough that nothing can be gained
    }
    step = std::min(step, std::max(0.1 * step, std::abs(best == center ? move : best - center)));
  }
  if (in_measured_units(refits, at_best.cost, std::exp(best)) >= part * now.cost)
    return std::nullopt;
  return ScaledFit{std::exp(best), std::move(at_best)};
}

/// A configuration that holds the intrinsics and lenses of cameras.
[[nodiscard]] Config with_cameras_held(Config config) {
  std::set<std::string> names;
  for (const ModelConfig& model : models_of(config)) {
    const std::shared_ptr<const AnySensor> sensor = sensor_of(model);
    if (!sensor->delivers(Quantity::pixel)) continue;
    for (const ParameterInfo& info : sensor->parameters()) {
      names.insert(parameter_name(model.param_name, info.name));
    }
  }
  for (StepConfig& step : config.steps) {
    std::erase_if(step.free_params, [&](const auto& free) { return names.contains(free.name); });
  }
  return config;
}

/// True if some step of a configuration frees less than that of another one.
[[nodiscard]] bool frees_less(const Config& config, const Config& than) {
  for (std::size_t s = 0; s < config.steps.size(); ++s) {
    if (config.steps[s].free_params.size() < than.steps[s].free_params.size()) return true;
  }
  return false;
}

/// Scales of points at which the noise is half as large, as sentences.
/// @param scales  suspects that are scales
/// @param most    the cost must fall to this, too
[[nodiscard]] std::vector<std::string> scale_sentences(const Refits& refits, const Refit& now,
                                                       const std::vector<Suspect>& scales,
                                                       double most = HUGE_VAL) {
  constexpr double kHalfNoise = 0.25;
  std::vector<std::string> found;
  for (const Suspect& suspect : scales) {
    const auto scaled = scaled_fit(refits, suspect, now, kHalfNoise);
    if (!scaled || scaled->after.cost > most) continue;
    found.push_back(fmt::format("{}multiplied by {:.4g}, {}", suspect.undone, scaled->factor,
                                fall_of(now, scaled->after)));
  }
  return found;
}

// A scale of points that free lengths absorb: the fit is as good, but all lengths change by one factor.
//
//   Q(s) = sum over lengths of ((d + s v) / u)^2        u^2 = (1.5 mm)^2 + (2.5 +-)^2
//
// with d the change of a length by the calibration, and v what it changes by if points are multiplied by 1 + s:
// by a solve with slightly larger points.  Robots are built to a millimetre or so, each length wrong in its own
// way; so a factor that undoes nearly all of the change is no accident.

/// A free length of the robot that the samples determine.
struct FreeLength {
  std::string name;        ///< of the parameter
  double change = 0.0;     ///< by the calibration, metres
  double deviation = 0.0;  ///< of the parameter, metres
};

/// The translations of joints that have a place in the URDF.
[[nodiscard]] std::vector<FreeLength> free_lengths(const Robot& robot,
                                                   const ParameterTable& solution,
                                                   const Assessment& step) {
  std::vector<FreeLength> lengths;
  for (const Joint& joint : robot.joints()) {
    if (joint.origin.translation.isZero()) continue;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const int p = solution.find(parameter_name(joint.name, kFrameAxes[axis]));
      if (p < 0) continue;
      const std::optional<double> deviation = step.deviation(p);
      if (!deviation || !std::isfinite(*deviation)) continue;
      lengths.push_back({solution[p].name, solution[p].value - solution[p].initial, *deviation});
    }
  }
  return lengths;
}

/// A configuration that frees the zeros of all joints in place of lengths and joint models.  Whole frames are
/// mounts and stay.
[[nodiscard]] Config with_zeros_for_lengths(Config config, const Robot& robot) {
  for (StepConfig& step : config.steps) {
    std::erase_if(step.free_frames, [&](const FreeFrameConfig& frame) {
      const auto is_held = [](bool free) { return !free; };
      return robot.has_joint(frame.name) && moves(robot.joint(frame.name).type) &&
             std::any_of(frame.axes.begin(), frame.axes.end(), is_held);
    });
    std::erase_if(step.free_params, [&](const FreeParamConfig& free) {
      return robot.has_joint(free.name) || joint_model_parameter(robot, free.name);
    });
    for (const Joint* joint : joints_between(config, robot)) {
      if (moves(joint->type) && !joint->mimic)
        step.free_params.push_back({joint->name, step.place});
    }
  }
  return config;
}

/// The root of the mean squared change of lengths, metres.
[[nodiscard]] double mean_change(const std::vector<FreeLength>& lengths,
                                 const ParameterTable& solution) {
  double squares = 0.0;
  for (const FreeLength& length : lengths) {
    const Parameter& p = solution[length.name];
    squares += (p.value - p.initial) * (p.value - p.initial);
  }
  return std::sqrt(squares / static_cast<double>(lengths.size()));
}

/// The factor of points that undoes nearly all changes of lengths, as a sentence; nullopt if none does.
[[nodiscard]] std::optional<std::string> absorbed_scale(const Refits& refits,
                                                        const Suspect& suspect, const Refit& now,
                                                        const std::vector<FreeLength>& lengths) {
  constexpr double kStep = 0.005;
  const auto scaled = refits.with(with_scaled(refits, suspect, 1.0 + kStep));
  if (!scaled) return std::nullopt;
  constexpr double kBuilt = 1.5e-3, kWide = 2.5;  // metres; deviations
  double before = 0.0, slope = 0.0, curvature = 0.0, least_moved = 0.0;
  std::vector<double> moves;
  for (const FreeLength& length : lengths) {
    const double v = (scaled->table[length.name].value - now.table[length.name].value) / kStep;
    const double u = std::hypot(kBuilt, kWide * length.deviation);
    before += length.change * length.change / (u * u);
    slope += length.change * v / (u * u);
    curvature += v * v / (u * u);
    moves.push_back(v / u);
  }
  if (!(curvature > 0.0)) return std::nullopt;
  const double s = -slope / curvature, gain = slope * slope / curvature;
  for (const double move : moves) least_moved = std::max(least_moved, move * move);
  constexpr double kSure = 16.0, kExplained = 0.8, kOfOne = 0.85, kFurthest = 0.6;
  if (gain < kSure || gain < kExplained * before || least_moved > kOfOne * curvature ||
      std::abs(s) > kFurthest) {
    return std::nullopt;
  }
  constexpr double kAsGood = 1.3;
  const auto then = refits.with(with_scaled(refits, suspect, 1.0 + s));
  if (!then || then->cost > kAsGood * now.cost) return std::nullopt;
  return fmt::format(
      "{}multiplied by {:.4g}, the lengths of the robot change by {:.2g} mm (RMS) in place of "
      "{:.2g} "
      "mm, and the samples fit as well",
      suspect.undone, 1.0 + s, 1e3 * mean_change(lengths, then->table),
      1e3 * mean_change(lengths, now.table));
}

// Suspects in a part of the samples: a third of them with the other sign, rows that belong to neighbours here and there.
//
// The samples that agree best are found by concentration: fit, keep those that are nearest, fit again.  At this fit the
// others are evaluated with each suspect undone; if that mends most of them, it is a suspect in these samples.
// Source: Rousseeuw, Van Driessen, Computing LTS Regression for Large Data Sets, 2006.

/// Mean squared weighted residual of each sample; infinite for one that cannot be evaluated.
[[nodiscard]] std::vector<double> sample_squares(const AnyProblem& empty,
                                                 const Eigen::VectorXd& values,
                                                 std::span<const Sample> samples) {
  std::vector<double> squares(samples.size(), HUGE_VAL);
  const auto set = [&](std::size_t first, std::size_t end) {
    const std::unique_ptr<AnyProblem> problem = empty.without_samples();
    std::vector<int> usable;  // numbers of the problem's samples
    for (std::size_t i = first; i < end; ++i) {
      try {
        problem->add_sample(samples[i]);
        usable.push_back(static_cast<int>(i));
      } catch (const SampleError&) {
      }
    }
    const std::vector<double> misfits =
        misfits_of(*problem, {values.data(), static_cast<std::size_t>(values.size())}, usable);
    for (const int i : usable) {
      const auto at = static_cast<std::size_t>(i);
      if (at < misfits.size()) squares[at] = misfits[at] * misfits[at];
    }
    return std::all_of(misfits.begin(), misfits.end(), [](double m) { return std::isfinite(m); });
  };
  if (set(0, samples.size())) return squares;  // else a point of some samples is behind a camera
  for (std::size_t i = 0; i < samples.size(); ++i) set(i, i + 1);
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
[[nodiscard]] std::optional<Concentrated> concentrated_from(const Refits& refits,
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
[[nodiscard]] std::optional<Concentrated> concentrated(const Refits& refits) {
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
[[nodiscard]] bool are_in_runs(const std::vector<std::size_t>& numbers) {
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
[[nodiscard]] Suspect in_samples(const Suspect& suspect, const std::vector<std::size_t>& bad,
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
[[nodiscard]] std::vector<Suspect> suspects_in_part(const Refits& refits,
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

/// What explains a bad fit leaves this part of the cost; what helps leaves that.
constexpr double kExplains = 0.1, kHelps = 0.25;

/// True for samples that were simulated without noise.
[[nodiscard]] bool is_exact(const Refit& fit) {
  return std::all_of(fit.blocks.begin(), fit.blocks.end(), [](const BlockStatistics& block) {
    return block.after.mean < 1e-6;  // metres, pixels, radians
  });
}

/// Suspects that are undone together, and what is left.
struct Explanation {
  std::vector<const Suspect*> suspects;
  Refit after;
  double cost = 0.0;      ///< in units that they do not shrink
  std::string text = {};  ///< how they are undone

  [[nodiscard]] SuspectKind kind() const {
    SuspectKind all = SuspectKind::mistake;
    for (const Suspect* suspect : suspects) all = std::max(all, suspect->kind);
    return all;
  }
};

/// Plausible parameters first, then the lower cost.
[[nodiscard]] bool fits_better(const Explanation* a, const Explanation* b) {
  return std::pair(a->after.implausible > 0, a->cost) <
         std::pair(b->after.implausible > 0, b->cost);
}

/// "with the positions of 'a' and 'b' negated, and with those of ..."
[[nodiscard]] std::string text_of(const std::vector<const Suspect*>& suspects) {
  std::vector<std::string> signs;
  std::string others;
  for (const Suspect* suspect : suspects) {
    if (!suspect->sign_of.empty()) {
      signs.push_back("'" + suspect->sign_of + "'");
    } else {
      others += (others.empty() ? "" : " and ") + suspect->undone;
    }
  }
  if (signs.empty()) return others;
  std::string text = "with the positions of ";
  for (std::size_t i = 0; i < signs.size(); ++i) {
    text += (i == 0 ? "" : i + 1 == signs.size() ? " and " : ", ") + signs[i];
  }
  return text + " negated" + (others.empty() ? "" : " and " + others);
}

/// Weighs suspects.
class Weighing {
 public:
  /// @param held  with the intrinsics of cameras held, which take up a scale, or lead astray; nullptr: none is free
  Weighing(const Refits& refits, const Refits* held, const std::vector<Suspect>& suspects)
      : refits_(refits), held_(held), suspects_(suspects), now_(refits.as_given()) {}

  [[nodiscard]] Explained run(bool combines) {
    if (now_ && is_exact(*now_)) return {};
    Together alone;
    for (const Suspect& suspect : suspects_) {
      suspect.scale ? try_scale(suspect) : alone.push_back({&suspect});
    }
    attempt(alone);
    const bool is_right_as_given = now_ && fits(*now_) && now_->implausible == 0;
    if (combines && !is_explained()) {
      in_part_ = suspects_in_part(refits_, suspects_);
      Together parts;
      for (const Suspect& suspect : in_part_) parts.push_back({&suspect});
      attempt(parts);
      if (!is_right_as_given && !is_explained()) combine();
    }
    Explained explained;
    explained.tried = static_cast<int>(std::ssize(suspects_)) + combined_;
    if (const auto likely = ranked(); !likely.empty()) {
      explained.cause = sentence(likely);
      explained.left = now_ ? likely.front()->cost / now_->cost : 0.0;
    } else if (const Explanation* best = best_of(all_); now_ && best != nullptr) {
      if (best->cost < kHelps * now_->cost && best->after.implausible == 0) {
        explained.helps = best->text + ", " + fall_of(*now_, best->after);
      }
    }
    return explained;
  }

 private:
  using Together = std::vector<std::vector<const Suspect*>>;

  /// Fits with suspects undone, each list by itself.
  void attempt(const Together& lists) { append(refits_, lists, all_); }
  static void append(const Refits& refits, const Together& lists, std::vector<Explanation>& all) {
    std::vector<std::optional<Refit>> fits(lists.size());
    for_each_piece(static_cast<int>(lists.size()), number_of_threads(0), [&](int i, int) {
      fits[static_cast<std::size_t>(i)] = refits.without(lists[static_cast<std::size_t>(i)]);
    });
    for (std::size_t i = 0; i < lists.size(); ++i) {
      if (!fits[i]) continue;
      const double cost = in_measured_units(refits, fits[i]->cost, shrinking(lists[i]));
      all.push_back({lists[i], *std::move(fits[i]), cost, text_of(lists[i])});
    }
  }
  /// Lists in the order of their rough costs; in that of the lists where there is no rough cost.
  [[nodiscard]] static Together by_rough_cost(const Refits& refits, Together lists) {
    std::vector<std::pair<double, std::size_t>> order(lists.size());
    for_each_piece(static_cast<int>(lists.size()), number_of_threads(0), [&](int i, int) {
      const auto at = static_cast<std::size_t>(i);
      const std::optional<double> rough = refits.rough_cost(lists[at]);
      order[at] = {rough ? in_measured_units(refits, *rough, shrinking(lists[at])) : HUGE_VAL, at};
    });
    std::sort(order.begin(), order.end());
    Together sorted;
    for (const auto& [cost, at] : order) sorted.push_back(std::move(lists[at]));
    return sorted;
  }
  /// The factor by which suspects together multiply lengths.
  [[nodiscard]] static double shrinking(const std::vector<const Suspect*>& suspects) {
    double shrinks = 1.0;
    for (const Suspect* suspect : suspects) shrinks *= suspect->shrinks;
    return shrinks;
  }
  void try_scale(const Suspect& suspect) {
    if (!now_) return;
    auto scaled = scaled_fit(refits_, suspect, *now_, kHelps);
    const bool is_found = scaled && fits(scaled->after) && scaled->after.implausible == 0;
    if (!is_found && held_ != nullptr) {
      if (auto of_held = scaled_fit(*held_, suspect, *now_, kHelps)) scaled = std::move(of_held);
    }
    if (!scaled) return;
    const double cost = in_measured_units(refits_, scaled->after.cost, scaled->factor);
    all_.push_back({{&suspect},
                    std::move(scaled->after),
                    cost,
                    suspect.undone + fmt::format("multiplied by {:.4g}", scaled->factor)});
  }

  /// True if nothing is left to explain: the noise is reached, and parameters are plausible.
  [[nodiscard]] bool explains(const Explanation& of) const {
    constexpr double kAsWell = 1.5;  // of the cost, where parameters were implausible
    if (!fits(of.after) || of.after.implausible > 0) return false;
    const double part = of.suspects.front()->scale ? kHelps : kExplains;
    return !now_ || of.cost < (now_->implausible > 0 ? kAsWell : part) * now_->cost;
  }
  [[nodiscard]] bool is_explained() const {
    return std::any_of(all_.begin(), all_.end(),
                       [&](const Explanation& of) { return explains(of); });
  }

  /// Signs together: all combinations of up to eight joints, two and three of more.
  [[nodiscard]] Together signs_together() const {
    constexpr std::size_t kAll = 8, kThree = 3, kMost = 16;
    std::vector<const Suspect*> signs;
    for (const Suspect& suspect : suspects_) {
      if (!suspect.sign_of.empty() && signs.size() < kMost) signs.push_back(&suspect);
    }
    Together lists;
    for (unsigned set = 1; set < (1u << signs.size()); ++set) {
      const auto count = static_cast<std::size_t>(std::popcount(set));
      if (count < 2 || (signs.size() > kAll && count > kThree)) continue;
      std::vector<const Suspect*>& together = lists.emplace_back();
      for (std::size_t i = 0; i < signs.size(); ++i) {
        if ((set >> i & 1u) != 0) together.push_back(signs[i]);
      }
    }
    return lists;
  }
  /// What helps most, each with each other suspect.
  /// @param roughly  in the order of their rough costs: what cannot be solved alone can be half of what is wrong
  /// @param widest   so many of what helps most
  [[nodiscard]] Together extended(const std::vector<Explanation>& all, const Together& roughly,
                                  std::size_t widest) const {
    std::vector<const Explanation*> best;
    for (const Explanation& of : all) best.push_back(&of);
    std::stable_sort(best.begin(), best.end(), fits_better);
    Together begins;
    for (std::size_t i = 0; i < std::min(best.size(), widest / 2); ++i) {
      begins.push_back(best[i]->suspects);
    }
    for (const auto& list : roughly) {
      if (begins.size() == widest) break;
      if (std::find(begins.begin(), begins.end(), list) == begins.end()) begins.push_back(list);
    }
    Together lists;
    std::set<std::vector<const Suspect*>> seen;
    for (const auto& list : begins) {
      for (const Suspect& suspect : suspects_) {
        if (suspect.scale || std::find(list.begin(), list.end(), &suspect) != list.end()) continue;
        std::vector<const Suspect*> together = list;
        together.push_back(&suspect);
        std::vector<const Suspect*> same = together;
        std::sort(same.begin(), same.end());
        if (seen.insert(same).second) lists.push_back(together);
      }
    }
    return lists;
  }
  /// Combinations: sought roughly, the best of them with few samples, and the best of those fitted to all.
  void combine() {
    constexpr std::size_t kFew = 30, kWide = 8, kNarrow = 4, kBest = 8, kFitted = 40;
    const Refits few = refits_.with_at_most(kFew);
    std::vector<Explanation> sought;
    Together alone;
    for (const Suspect& suspect : suspects_) {
      if (!suspect.scale) alone.push_back({&suspect});
    }
    const auto fit_best = [&] {  // the shortest of those that are alike
      std::vector<const Explanation*> best;
      for (const Explanation& of : sought) {
        if (of.suspects.size() > 1) best.push_back(&of);
      }
      std::stable_sort(best.begin(), best.end(), fits_better);
      const auto others = std::find_if(best.begin(), best.end(), [&](const Explanation* of) {
        return of->cost > alike() * best.front()->cost ||
               of->after.implausible > best.front()->after.implausible;
      });
      std::stable_sort(best.begin(), others, [](const auto* a, const auto* b) {
        return std::pair(a->suspects.size(), a->after.strain) <
               std::pair(b->suspects.size(), b->after.strain);
      });
      best.resize(std::min(best.size(), kBest));
      Together lists;
      for (const Explanation* of : best) lists.push_back(of->suspects);
      attempt(lists);
    };
    Together roughly;  // of the last ones that were sought
    const auto seek = [&](Together lists) {
      if (lists.empty()) return;
      combined_ += lists.front().size() > 1 ? static_cast<int>(std::ssize(lists)) : 0;
      roughly = by_rough_cost(few, std::move(lists));
      const std::size_t most = few.is_in_one_step() ? kFitted : roughly.size();
      const auto last = static_cast<std::ptrdiff_t>(std::min(roughly.size(), most));
      append(few, {roughly.begin(), roughly.begin() + last}, sought);
    };
    seek(signs_together());
    fit_best();
    if (is_explained()) return;
    seek(alone);
    for (const std::size_t widest : {kWide, kNarrow}) {
      seek(extended(sought, roughly, widest));
      fit_best();
      if (is_explained()) return;
    }
  }

  [[nodiscard]] static const Explanation* best_of(const std::vector<Explanation>& all) {
    const Explanation* best = nullptr;
    for (const Explanation& of : all) {
      if (best == nullptr || of.cost < best->cost) best = &of;
    }
    return best;
  }
  /// Those that reach the noise and fit as well as the best of them; the simplest first.
  [[nodiscard]] std::vector<const Explanation*> ranked() const {
    std::vector<const Explanation*> likely;
    double least = HUGE_VAL;
    for (const Explanation& of : all_) {
      if (!explains(of)) continue;
      likely.push_back(&of);
      least = std::min(least, of.cost);
    }
    constexpr double kExact = 1e-9;  // of the cost: less is rounding
    if (now_) least = std::max(least, kExact * now_->cost);
    std::erase_if(likely, [&](const Explanation* of) { return of->cost > alike() * least; });
    if (now_ && now_->implausible > 0) {
      std::erase_if(likely, [&](const Explanation* of) { return is_absorbed(*of); });
    }
    constexpr double kMore = 4.0, kSmall = 1.0;  // of the least strain; of plausible changes
    double relaxed = HUGE_VAL;
    for (const Explanation* of : likely) relaxed = std::min(relaxed, of->after.strain);
    std::erase_if(
        likely, [&](const Explanation* of) { return of->after.strain > kMore * relaxed + kSmall; });
    std::stable_sort(likely.begin(), likely.end(), [](const auto* a, const auto* b) {
      return std::tuple(a->suspects.size(), a->kind(), a->cost) <
             std::tuple(b->suspects.size(), b->kind(), b->cost);
    });
    return likely;
  }
  /// True if unknown poses take up the zero that is moved: then it is only another start of the fit.
  [[nodiscard]] bool is_absorbed(const Explanation& of) const {
    constexpr double kSame = 1e-3, kTurn = 0.02;  // of the cost; radians
    const std::string& joint = of.suspects.front()->zero_of;
    if (of.suspects.size() != 1 || joint.empty()) return false;
    const Suspect turned{.undone = {}, .correct = [&](Sample& sample) {
                           if (double* q = position_in(sample, joint)) *q += kTurn;
                         }};
    const auto cost = refits_.cost_of_poses({&turned}, *now_);
    return cost && std::abs(*cost - now_->cost) < kSame * now_->cost;
  }
  /// Ratio of costs that are alike: three standard deviations of the sum of squares of a fit to the noise, whose
  /// residuals err together within a sample.
  [[nodiscard]] double alike() const {
    constexpr double kSure = 3.0, kOfSample = 6.0;
    const double rows = kOfSample * std::max(1.0, static_cast<double>(refits_.some().size()));
    return 1.0 + kSure * std::sqrt(2.0 / rows);
  }

  [[nodiscard]] std::string sentence(const std::vector<const Explanation*>& likely) const {
    constexpr std::size_t kOthers = 2;
    const Explanation& first = *likely.front();
    std::string text =
        first.text + ", " +
        (!now_ ? solved_text(first.after)
         : first.cost < kExplains * now_->cost || first.suspects.front()->scale
             ? fall_of(*now_, first.after)
             : "no parameter changes by more than is plausible, and the samples fit as well");
    std::string others;
    for (std::size_t i = 1; i < likely.size() && i <= kOthers; ++i) {
      others += (i == 1 ? "" : ", or ") + likely[i]->text;
    }
    if (others.empty()) return text;
    return text + "; these samples do not tell it from " + others +
           (likely.size() > kOthers + 1 ? fmt::format(", and {} more", likely.size() - kOthers - 1)
                                        : "");
  }

  const Refits& refits_;
  const Refits* held_;
  const std::vector<Suspect>& suspects_;
  std::vector<Suspect> in_part_;
  std::optional<Refit> now_;
  std::vector<Explanation> all_;
  int combined_ = 0;  ///< combinations that were tried
};

}  // namespace
}  // namespace detail

Explained explain_fit(const Config& config, const Robot& robot, std::span<const Sample> samples,
                      const ExplainOptions& options) {
  const Calibrator solve = options.solve ? options.solve : detail::plain_calibrator();
  const detail::Refits refits(config, robot, samples, solve);
  std::vector<Suspect> suspects = suspects_of(config, robot, refits.some());
  suspects.insert(suspects.end(), options.own.begin(), options.own.end());
  const Config of_held = detail::with_cameras_held(config);
  std::optional<detail::Refits> held;
  if (detail::frees_less(of_held, config)) held.emplace(of_held, robot, samples, solve);
  return detail::Weighing(refits, held ? &*held : nullptr, suspects).run(options.combines);
}

std::vector<std::string> wrong_scales(const Config& config, const Robot& robot,
                                      std::span<const Sample> samples,
                                      const ParameterTable& solution, const Assessment& last) {
  const Calibrator solve = detail::plain_calibrator();
  const detail::Refits refits(config, robot, samples, solve, &solution);
  const std::optional<detail::Refit> now = refits.as_given();
  if (!now || detail::is_exact(*now)) return {};
  std::vector<Suspect> scales = suspects_of(config, robot, refits.some());
  std::erase_if(scales, [](const Suspect& suspect) { return !suspect.scale; });
  if (auto found = detail::scale_sentences(refits, *now, scales); !found.empty()) return found;
  std::vector<std::string> found;
  if (const Config of_held = detail::with_cameras_held(config);
      detail::frees_less(of_held, config)) {
    constexpr double kAsGood = 1.3;
    const detail::Refits held(of_held, robot, samples, solve);
    const std::optional<detail::Refit> then = held.as_given();
    if (then) found = detail::scale_sentences(held, *then, scales, kAsGood * now->cost);
    for (std::string& sentence : found) {
      sentence +=
          " with the intrinsics of cameras as they were given: these samples do not tell the size "
          "of the "
          "target from a focal length; measure the target, or calibrate the camera alone";
    }
    if (!found.empty()) return found;
  }
  const std::vector<detail::FreeLength> lengths = detail::free_lengths(robot, solution, last);
  if (lengths.size() < 2) return {};
  for (const Suspect& suspect : scales) {
    auto scaled = detail::absorbed_scale(refits, suspect, *now, lengths);
    if (scaled) found.push_back(*std::move(scaled));
  }
  if (!found.empty()) return found;
  const Config zeros = detail::with_zeros_for_lengths(config, robot);
  const detail::Refits with_zeros(zeros, robot, samples, solve);
  const std::optional<detail::Refit> then = with_zeros.as_given();
  if (!then) return {};
  std::vector<std::string> names;
  for (const detail::FreeLength& length : lengths) names.push_back(length.name);
  found = detail::scale_sentences(with_zeros, *then, scales);
  for (std::string& sentence : found) {
    sentence += " with zeros in place of " + first_names(names) + ", which may have absorbed it";
  }
  return found;
}

}  // namespace kinecal
