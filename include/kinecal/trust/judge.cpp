// Judging calibrations.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/trust/judge.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>

#include "kinecal/trust/captures/ruined.hpp"
#include "kinecal/trust/judge_blocks.ipp"
#include "kinecal/trust/judge_noise.hpp"
#include "kinecal/trust/judge_places.ipp"
#include "kinecal/trust/judge_values.hpp"
#include "kinecal/trust/plausible_change.hpp"

namespace kinecal {

namespace detail {
namespace {

// Judging lenses.

/// A lens that folds over where features are is no result; beyond them it is one for the places where features are.
void judge_folds(const Assessment& step, Judgement& judgement) {
  for (const FoldedLens& fold : step.folded) {
    char radii[128];
    (void)std::snprintf(radii, sizeof radii,
                        "%.0f px from the center; its corners are at %.0f px, the farthest "
                        "feature at %.0f px",
                        fold.radius, fold.corner, fold.farthest);
    judgement.add(fold.is_among_features() ? Grade::do_not_use : Grade::use_with_care,
                  "the lens of '" + fold.sensor + "' folds over inside the image, " + radii +
                      (fold.is_among_features()
                           ? "; give it another model ('lens: auto' finds it)"
                           : "; do not use it beyond these, record features up to the corners, or "
                             "hold its last coefficients"),
                  {Remedy::Kind::mend});
  }
}

/// Views that are too few, or too much alike, for intrinsics: only where each sample has a pose of its own, so that
/// nothing else tells of the camera.  Their +- say nothing then: they come from these few.
void judge_views(const Assessment& step, const ParameterTable& table, Judgement& judgement) {
  constexpr double kOwn = 5.0;                      // residuals of a sample, of the six of a pose
  constexpr std::int64_t kFewest = 3, kEnough = 8;  // views
  if (!(step.used > kOwn * static_cast<double>(step.samples))) return;
  for (const int p : step.parameters) {
    const std::string& name = table[p].name;
    if (!name.ends_with("_fx")) continue;
    const std::string camera = name.substr(0, name.size() - 3);
    const auto map = std::find_if(step.maps.begin(), step.maps.end(),
                                  [&](const ProjectionMap& of) { return of.sensor == camera; });
    const bool is_mapped = map != step.maps.end() && map->focal() != nullptr;
    if (step.views < kEnough) {
      const std::string different = step.views < step.samples ? " different" : "";
      judgement.add(step.views < kFewest ? Grade::do_not_use : Grade::use_with_care,
                    std::to_string(step.views) + different +
                        (step.views == 1 ? " view is" : " views are") +
                        " too few for the lens of '" + camera +
                        "', and their +- mean little; take 20, tilted by 30 degrees to all sides",
                    {Remedy::Kind::record});
    }
    // Of the length that was found, not of the one that it began with.
    const double deviation = is_mapped
                                 ? map->focal_deviation()
                                 : step.deviation(p).value_or(0.0) / std::abs(1.0 + table[p].value);
    if (deviation > ProjectionMap::kKnownFocal) {  // infinite, if not at all
      judgement.add(
          Grade::do_not_use,
          "these views do not tell the focal length of '" + camera + "'" +
              (std::isfinite(deviation) ? " (+- " + reading(1e2 * deviation, "1") + " %)" : "") +
              ": tilt the target by 30 degrees to all sides",
          {Remedy::Kind::record});
    } else if (!is_mapped) {
      continue;
    } else if (const CameraNumber& focal = *map->focal(); focal.name == ProjectionMap::kAxisFocal) {
      judgement.add(Grade::use_with_care,
                    "fx of '" + camera +
                        "' and the coefficients of its lens make up for each other: only its focal "
                        "length at the axis, " +
                        std::to_string(std::lround(focal.value)) + " +- " +
                        reading(*focal.deviation, "px") +
                        ", is known; give it a lens with fewer coefficients ('lens: auto')",
                    {Remedy::Kind::mend});
    } else if (!map->is_known() && std::isfinite(map->deviations()[1])) {
      judgement.add(Grade::use_with_care,
                    "a pixel of '" + camera + "' is known to " +
                        reading(map->deviations()[1], "px") +
                        " only where features are; record more views, tilted by 30 degrees to all "
                        "sides, or free fewer coefficients",
                    {Remedy::Kind::record});
    }
  }
}

/// What samples do not determine of a camera may move its pixels.
void judge_pixels(const Assessment& step, Judgement& judgement) {
  for (const ProjectionMap& map : step.maps) {
    if (std::isfinite(map.deviations()[1])) continue;
    judgement.add(Grade::use_with_care,
                  "these samples do not determine the pixels of '" + map.sensor +
                      "', not even where features are; record poses that differ more, or free "
                      "fewer of its parameters",
                  {Remedy::Kind::record});
  }
}

/// Halves of the samples that put pixels apart, and residuals that depend on the place in the image.  Only if each sample
/// has a pose of its own: else a robot that errs in some poses looks alike, because poses and places go together.
void judge_projection(const Assessment& step, Judgement& judgement) {
  if (!(step.used > 0.0)) return;
  constexpr double kChance = 0.01, kPart = 0.35, kSmallChance = 1e-3, kTimes = 2.5, kPixels = 0.1;
  const std::string cause =
      ": its lens has a shape that its model does not have, or the target has one; try another "
      "('lens: auto'), or measure the target";
  for (std::size_t i = 0; i < step.maps.size(); ++i) {
    const ProjectionMap& map = step.maps[i];
    const AlikePixels& alike = step.alike[i];
    if (alike.chance < kChance && alike.alike > std::max(kPixels, kPart * alike.all)) {
      judgement.add(Grade::use_with_care,
                    "residuals of '" + map.sensor + "' depend on the place in its image (" +
                        reading(alike.alike, "px") + " of " + reading(alike.all, "px") +
                        ", most at the " + alike.region + ")" + cause,
                    {Remedy::Kind::mend});
    } else if (map.halves && map.halves->chance < kSmallChance &&
               map.halves->difference > kPixels &&
               map.halves->difference > kTimes * map.halves->allowed) {
      judgement.add(Grade::use_with_care,
                    "two halves of the samples put pixels of '" + map.sensor + "' " +
                        reading(map.halves->difference, "px") + " apart, the +- allow " +
                        reading(map.halves->allowed, "px") + cause,
                    {Remedy::Kind::mend});
    }
  }
}

/// A step that determines nothing leaves the robot as it was, however well it fits.
void judge_determined(const Assessment& step, bool last, Judgement& judgement) {
  if (step.parameters.empty() || step.uncertainty.determined > 0) return;
  judgement.add(last ? Grade::do_not_use : Grade::use_with_care,
                "step '" + step.step + "': these samples determine none of its " +
                    std::to_string(step.parameters.size()) +
                    " free parameters; does any error block depend on them, with what weight?",
                {Remedy::Kind::mend});
}

void judge_freedom(const Assessment& step, Judgement& judgement) {
  const double parameters = std::max(1, step.uncertainty.determined);
  const double freedom = (static_cast<double>(step.rows) - step.used) / step.readings - parameters;
  if (freedom >= parameters) return;
  judgement.add(freedom < 0.5 * parameters ? Grade::do_not_use : Grade::use_with_care,
                "step '" + step.step + "': " + std::to_string(step.rows) +
                    " residuals are too few to check " +
                    std::to_string(static_cast<int>(parameters)) +
                    " parameters; record more samples",
                {Remedy::Kind::record});
}

/// Samples of other regions may fit worse: the model lacks something that matters there.
void judge_region(const HeldOutError& error, double expected, Judgement& judgement) {
  constexpr double kTimes = 3.0;
  if (!(error.region > kTimes * std::max(expected, error.held_out))) return;
  judgement.add(Grade::use_with_care,
                "error block '" + error.block + "': " + reading(error.region, error.unit) +
                    " on samples of a region that was held out, " +
                    reading(error.fitted, error.unit) +
                    " on fitted ones; use it near these samples only",
                {Remedy::Kind::record});
}

void judge_held_out(const Assessment& step, Judgement& judgement) {
  constexpr Limits kTimes{1.5, 3.0};
  for (std::size_t t = 0; t < step.held_out.size(); ++t) {
    const HeldOutError& error = step.held_out[t];
    // Few samples fit better than their noise; outliers under a loss are in both errors.
    const double noise = step.noise[t].sigma * std::sqrt(step.noise[t].components);
    const double expected = std::max(noise, error.fitted);
    if (error.features == 0 || !(expected > 0.0)) continue;
    const double times = error.held_out / expected;
    judge_region(error, expected, judgement);
    if (!kTimes.exceeded(times)) continue;
    judgement.add(kTimes.grade(times),
                  "error block '" + error.block + "': " + reading(error.held_out, error.unit) +
                      " on samples held out, " + reading(error.fitted, error.unit) +
                      " on fitted ones; record more samples or free fewer parameters",
                  {Remedy::Kind::record});
  }
}

/// Samples that do not fit: a few are bad captures, many show a wrong model.
void judge_share(int bad, int samples, const std::string& where, const std::string& what,
                 Judgement& judgement) {
  constexpr Limits kShare{0.1, 0.25};
  const double share = static_cast<double>(bad) / std::max(1, samples);
  if (bad == 0 || share <= kShare.care) return;
  judgement.add(share > kShare.refuse ? Grade::do_not_use : Grade::use_with_care,
                where + std::to_string(bad) + " of " + std::to_string(samples) +
                    " samples do not fit the others" + what);
}

void judge_captures(const Assessment& step, const AnyProblem& problem, Judgement& judgement) {
  if (explains_more(step)) return;  // than leaving samples out
  const auto bad = std::count_if(step.captures.begin(), step.captures.end(),
                                 [](const CaptureError& error) { return error.bad; });
  judge_share(static_cast<int>(bad), problem.num_samples(), "step '" + step.step + "': ", "",
              judgement);
}

void judge_weak(const Assessment& step, const ParameterTable& table, Judgement& judgement) {
  if (step.weak.parameters.empty()) return;
  std::string hold;
  for (const int p : step.weak.hold) hold += " " + table[p].name;
  const Parameter& first = table[step.weak.hold.front()];
  const std::size_t others = step.weak.parameters.size() - 1;
  judgement.add(Grade::use_with_care,
                "these samples hardly determine '" + first.name + "' (+- " +
                    reading(step.deviation(step.weak.hold.front()).value_or(0.0), first.unit) +
                    ")" + (others > 0 ? " and " + std::to_string(others) + " more" : "") +
                    "; record poses that differ more, or hold:" + hold,
                {Remedy::Kind::hold});
}

void judge_priors(const Assessment& step, const ParameterTable& table, Judgement& judgement) {
  for (const PriorPull& pull : step.pulls) {
    if (!pull.contradicts()) continue;
    const Parameter& p = table[pull.parameter];
    judgement.add(Grade::use_with_care,
                  "prior '" + pull.prior + "' contradicts the samples: it shifts '" + p.name +
                      "' by " + reading(pull.shift, p.unit) + ", " + reading(pull.times, "1") +
                      " times its +-; loosen or remove it",
                  {Remedy::Kind::mend, "loosen or remove prior '" + pull.prior + "'"});
  }
}

void judge_pose(const Assessment& step, const PoseUncertainty& known, Judgement& judgement) {
  constexpr Limits kPosition{0.005, 0.02};
  const std::string pose = "the position of '" + known.frame + "' in '" + known.in + "'";
  if (!known.determined) {
    judgement.add(Grade::use_with_care,
                  pose +
                      " depends on a combination of parameters that these samples do not "
                      "determine; see 'cannot be determined'",
                  {Remedy::Kind::hold});
  }
  if (known.elsewhere > kPosition.care && !kPosition.exceeded(known.position)) {
    judgement.add(Grade::use_with_care,
                  pose + " is known to " + reading(known.position, "m") +
                      " at these samples, but to " + reading(known.elsewhere, "m") +
                      " over the limits of the joints; use it near these samples only, or record "
                      "poses that differ more",
                  {Remedy::Kind::record});
  }
  if (!kPosition.exceeded(known.position)) return;
  std::string answer = "; record more samples";
  Remedy remedy{Remedy::Kind::record};
  if (!step.pulls.empty()) {  // what a prior shifts is in the +-, and no sample takes it out
    remedy = {Remedy::Kind::mend, "loosen or remove prior '" + step.pulls.front().prior + "'"};
    answer = ", as the samples disagree with prior '" + step.pulls.front().prior +
             "'; loosen or remove it";
  }
  judgement.add(kPosition.grade(known.position),
                pose + " is known to " + reading(known.position, "m") + " only" + answer, remedy);
}

}  // namespace
}  // namespace detail

void judge_left_out(int left_out, int samples, Judgement& judgement) {
  detail::judge_share(left_out, samples, "", " and were left out", judgement);
}

bool fits_badly(const Assessment& step) {
  Judgement of_noise;
  detail::judge_noise(step, of_noise);
  return of_noise.verdict != Grade::good;
}

Judgement judge(const Calibration& calibration, const CalibrationResult& result,
                const std::vector<Assessment>& assessments, const std::vector<std::string>& doubts,
                const std::vector<std::string>& refutable) {
  Judgement judgement;
  if (!result.converged) {
    judgement.add(Grade::do_not_use, result.termination, {Remedy::Kind::hold});
  }
  for (std::size_t s = 0; s < assessments.size(); ++s) {
    const CalibrationStep& step = calibration.steps[s];
    const bool last = s + 1 == assessments.size();
    if (last) detail::judge_noise(assessments[s], judgement);  // earlier steps fit less
    if (last) detail::judge_directions(assessments[s], judgement);
    detail::judge_determined(assessments[s], last, judgement);
    detail::judge_freedom(assessments[s], judgement);
    if (last) {
      detail::judge_blocks(*step.problem, step.free, assessments[s], result.table, judgement);
    }
    if (last) detail::judge_held_out(assessments[s], judgement);
    if (last) detail::judge_folds(assessments[s], judgement);
    if (last) detail::judge_views(assessments[s], result.table, judgement);
    if (last) detail::judge_pixels(assessments[s], judgement);
    if (last) detail::judge_projection(assessments[s], judgement);
    if (last && assessments[s].one_pose) {
      judgement.add(Grade::use_with_care,
                    "all samples are of one pose of the robot, and nothing shows how the result "
                    "does in others; record "
                    "other poses",
                    {Remedy::Kind::record});
    }
    if (last) detail::judge_captures(assessments[s], *step.problem, judgement);
    if (last && assessments[s].systematic) {
      const SystematicError& error = *assessments[s].systematic;
      judgement.add_causes(error.refuse ? Grade::do_not_use : Grade::use_with_care,
                           {sentence(error)});
    }
    detail::judge_values(step, result, assessments[s], judgement);
    if (last) {
      detail::judge_given_places(*step.problem, result.table, assessments[s].size, judgement);
    }
    if (last) detail::judge_places(*step.problem, assessments[s], result.table, judgement);
    if (last) detail::judge_weak(assessments[s], result.table, judgement);
    if (last) detail::judge_priors(assessments[s], result.table, judgement);
    if (!last) continue;
    for (const PoseUncertainty& pose : assessments[s].compared) {
      detail::judge_pose(assessments[s], pose, judgement);
    }
  }
  const bool refutes =
      result.converged && !assessments.empty() && detail::fits_to_noise(assessments.back());
  for (const std::string& doubt : doubts) {
    if (refutes && std::find(refutable.begin(), refutable.end(), doubt) != refutable.end())
      continue;
    judgement.add(Grade::use_with_care, doubt, {Remedy::Kind::mend});
  }
  return judgement;
}

}  // namespace kinecal
