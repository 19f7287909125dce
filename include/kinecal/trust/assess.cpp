// Assessing steps.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/trust/assess.hpp"

#include <algorithm>
#include <cmath>
#include <future>
#include <limits>
#include <map>
#include <set>
#include <utility>

#include "kinecal/geometry/median.hpp"
#include "kinecal/solve/determined_spectrum.hpp"
#include "kinecal/solve/spectrum.hpp"
#include "kinecal/trust/captures/ruined.hpp"
#include "kinecal/trust/inside_bounds.ipp"
#include "kinecal/trust/noise/joint_effects.ipp"
#include "kinecal/trust/noise/repeat_noise.hpp"
#include "kinecal/trust/plausible_change.hpp"
#include "kinecal/trust/uncertainty/compared_frames.hpp"
#include "kinecal/trust/uncertainty/workspace_map.hpp"

namespace kinecal {

namespace detail {
namespace {

/// Groups of parameters that improve nothing: their change d from the initial values is no larger
/// than chance, d^T C^-1 d < 2 rank.  A fit without them predicts just as well.
/// Source: Akaike, A New Look at the Statistical Model Identification, 1974.
[[nodiscard]] std::vector<IdleGroup> idle_groups(const AnyProblem& problem, const FreeSet& free,
                                                 ParameterValues values, const Uncertainty& known) {
  std::map<std::string, std::vector<int>> columns;
  for (int c = 0; c < free.size(); ++c) {
    const int p = free.parameters()[static_cast<std::size_t>(c)];
    columns[problem.owners()[static_cast<std::size_t>(p)]].push_back(c);
  }
  std::vector<IdleGroup> idle;
  for (const auto& [owner, of_owner] : columns) {
    IdleGroup group{.owner = owner, .parameters = {}};
    Eigen::VectorXd change(std::ssize(of_owner));
    bool determined = true;
    for (std::size_t i = 0; i < of_owner.size(); ++i) {
      const int p = free.parameters()[static_cast<std::size_t>(of_owner[i])];
      group.parameters.push_back(p);
      change(static_cast<Eigen::Index>(i)) =
          values[static_cast<std::size_t>(p)] - problem.table()[p].value;
      determined = determined && std::isfinite(known.deviation(of_owner[i]));
    }
    const Spectrum spectrum(known.covariance.matrix()(of_owner, of_owner));
    group.rank = static_cast<int>(change.size() - spectrum.null);
    group.statistic = change.dot(spectrum.pseudo_inverse() * change);
    if (determined && group.rank > 0 && group.statistic < 2.0 * group.rank) idle.push_back(group);
  }
  return idle;
}

/// Held-out errors of folds and of regions; infinite if a fit without some ends with a point behind a camera.
[[nodiscard]] std::vector<HeldOutError> held_out_of(AnyEvaluator& evaluator, ParameterValues values,
                                                    const LinearFit& fit,
                                                    std::span<const Sample> samples,
                                                    const PoseGroups& poses,
                                                    const AssessOptions& options) {
  const AnyProblem& problem = evaluator.problem();
  const int folds = std::min(options.folds, poses.count);
  if (folds < 2) return {};
  try {
    std::vector<HeldOutError> errors =
        held_out_errors(evaluator, values, fit, folds_of(samples, poses, folds), options.meter);
    const std::vector<int> regions = pose_regions(problem, samples, poses);
    if (regions.empty()) return errors;
    const auto of_regions = held_out_errors(evaluator, values, fit, regions);
    for (std::size_t t = 0; t < errors.size(); ++t) errors[t].region = of_regions[t].held_out;
    return errors;
  } catch (const std::domain_error&) {
    std::vector<HeldOutError> errors;
    for (int t = 0; t < problem.num_terms(); ++t) {
      const Term& term = problem.term(t);
      errors.push_back(
          {term.name, term.options.unit, 0, 0.0, std::numeric_limits<double>::infinity()});
    }
    return errors;
  }
}

/// The parameters of cameras whose pixels are known: a coefficient of a lens says nothing by itself.
[[nodiscard]] std::set<int> known_by_pixels(const AnyProblem& problem,
                                            const std::vector<ProjectionMap>& maps) {
  std::set<int> all;
  for (const ProjectionMap& map : maps) {
    if (!map.is_known() || map.focal_deviation() > ProjectionMap::kKnownFocal) continue;
    for (const MountedSensor& camera : problem.sensors()) {
      if (camera.mount().name != map.sensor) continue;
      all.insert(camera.parameters().begin(), camera.parameters().end());
    }
  }
  return all;
}

/// The median +- of a pose over the limits of the joints; 0 if it is not known there.
[[nodiscard]] double deviation_elsewhere(const AnyProblem& problem, const Assessment& step,
                                         const PoseUncertainty& pose, ParameterValues values) {
  constexpr int kPoses = 64;
  std::vector<double> deviations;
  for (const KnownPoint& point : workspace_map(problem, step, pose, values, kPoses)) {
    deviations.push_back(point.deviation);
  }
  return deviations.empty() ? 0.0 : median_of(std::move(deviations));
}

/// Sets the uncertainty, and the priors that the samples contradict.
/// @param inverse  (coordinates x coordinates) of the information
void set_uncertainty(const AnyProblem& problem, const FreeSet& free, ParameterValues values,
                     const LinearFit& fit, const Eigen::MatrixXd& inverse, const PoseGroups& poses,
                     const FeatureLinks& links, Assessment& found) {
  const Eigen::MatrixXd& basis = fit.coordinates.basis;
  const Eigen::MatrixXd of_free = basis * inverse * basis.transpose();
  const bool robust = (fit.loss.array() != 1.0).any();
  const double variance = robust ? 1.0 : prior_variance(found.noise);
  const auto with_priors = [&](const Eigen::MatrixXd& of_priors) {
    found.uncertainty = uncertainty(problem, fit, found.noise, poses, links, of_priors);
    mark_undetermined(problem, free, fit.coordinates, found.uncertainty);
  };
  with_priors(variance * fit.prior_hessian);
  if (problem.priors().empty()) return;
  found.pulls = prior_pulls(problem, free, values, of_free, variance, found.uncertainty);
  with_priors(basis.transpose() * prior_scatter(problem, free, values, of_free, variance) * basis);
}

/// Doubts no sample without which the others are foretold no better: many parameters fit few samples more closely
/// than those that are left out, whichever these are.
/// @param found  with the held-out errors of all samples; its captures may be bad no longer
void keep_what_foretells(AnyEvaluator& evaluator, ParameterValues values, const LinearFit& fit,
                         std::span<const Sample> samples, const PoseGroups& poses,
                         const AssessOptions& options, Assessment& found) {
  const auto is_bad = [&](int sample) {
    return found.captures[static_cast<std::size_t>(sample)].bad;
  };
  const bool any_bad = std::any_of(found.captures.begin(), found.captures.end(),
                                   [](const CaptureError& error) { return error.bad; });
  if (!any_bad || found.held_out.empty()) return;
  LinearFit without = fit;
  std::vector<int> fold = folds_of(samples, poses, std::min(options.folds, poses.count));
  std::set<int> terms;  // in which a bad sample is measured
  for (const RowBlock& block : fit.blocks) {
    if (!is_bad(block.sample)) continue;
    without.loss.segment(block.first, block.size).setZero();
    fold[static_cast<std::size_t>(block.sample)] = -1;
    terms.insert(block.term);
  }
  if (terms.empty()) return;
  try {
    const std::vector<HeldOutError> errors = held_out_errors(evaluator, values, without, fold);
    const bool better = std::any_of(terms.begin(), terms.end(), [&](int term) {
      const auto t = static_cast<std::size_t>(term);
      return errors[t].held_out < found.held_out[t].held_out;
    });
    if (better) return;
  } catch (const std::domain_error&) {
    return;
  }
  for (CaptureError& error : found.captures) error.bad = false;
}

}  // namespace
}  // namespace detail

std::optional<double> Assessment::deviation(int parameter) const {
  const auto at = std::find(parameters.begin(), parameters.end(), parameter);
  if (at == parameters.end()) return std::nullopt;
  return uncertainty.deviation(at - parameters.begin());
}

Assessment assess(const AnyProblem& problem, const FreeSet& free, ParameterValues values,
                  std::span<const Sample> samples, const AssessOptions& options) {
  Assessment found;
  const detail::SampleInformation of_free = detail::sample_information(problem, free, values);
  if (free.size() > 0) found.observability = detail::observability_of(problem, free, of_free);
  const FreeSet inside = detail::inside_bounds(problem, free, values, found.at_bound);
  found.parameters = inside.parameters();
  const auto evaluator = problem.evaluator(inside, 1);
  const LinearFit fit =
      linear_fit(*evaluator, values,
                 inside.size() == free.size() ? detail::coordinates_of(of_free)
                                              : determined_coordinates(problem, inside, values));
  found.rows = fit.residual.size();
  found.used = fit.used.sum();
  found.samples = problem.num_samples();
  const PoseGroups single = pose_groups(problem, samples);
  found.readings = single.readings();
  found.views = distinct_poses(problem, samples);
  found.one_pose = are_one_pose(problem, samples);
  found.neighbours = neighbours(problem, fit, single);
  const PoseGroups poses = by_run(joined(single, found.neighbours.together), samples);
  found.size = detail::robot_size(problem);
  const Eigen::MatrixXd inverse = detail::Spectrum(fit.hessian).pseudo_inverse();
  found.noise = estimate_noise(problem, fit, inverse);
  set_repeats(fit, single, found.noise);
  // What poses share, the +- and systematic errors, beside what single samples show.
  std::future<void> shared = std::async(std::launch::async, [&] {
    const Eigen::MatrixXd effects = detail::joint_effects(problem, values, samples, inside, fit);
    found.common = common_noise(fit, effects, single, found.noise);
    detail::set_uncertainty(problem, inside, values, fit, inverse, poses,
                            feature_links(problem, fit, samples), found);
    found.systematic = systematic_error({problem, inside, fit, values, samples}, poses, effects,
                                        found.noise, found.common);
  });
  found.held_out = detail::held_out_of(*evaluator, values, fit, samples, poses, options);
  found.captures = capture_errors(problem, fit, single);
  detail::keep_what_foretells(*evaluator, values, fit, samples, poses, options, found);
  found.noise_without_bad = noise_without_bad(fit, found.captures);
  shared.get();
  found.folded = folded_lenses(problem, free, values, samples);
  found.maps =
      projection_maps({*evaluator, inside, values, fit, found.uncertainty, samples, poses});
  found.weak = weak_parameters(problem, inside, found.uncertainty,
                               detail::known_by_pixels(problem, found.maps));
  found.alike = alike_pixels(problem, fit, found.maps, samples);
  found.idle = detail::idle_groups(problem, inside, values, found.uncertainty);
  for (const ComparedFrames& frames : compared_frames(problem, samples)) {
    PoseUncertainty pose = pose_uncertainty(problem, inside, values, fit, found.uncertainty,
                                            samples, frames.frame, frames.in);
    pose.elsewhere = detail::deviation_elsewhere(problem, found, pose, values);
    found.compared.push_back(std::move(pose));
  }
  for (std::size_t b = 1; b < options.between.size(); ++b) {
    const FrameOnRobot frame = frame_named(problem, samples, options.between[b]);
    for (std::size_t a = 0; a < b; ++a) {
      found.between.push_back(pose_uncertainty(problem, inside, values, fit, found.uncertainty,
                                               samples, frame,
                                               frame_named(problem, samples, options.between[a])));
    }
  }
  return found;
}

std::vector<Assessment> assess(const Calibration& calibration, const CalibrationResult& result,
                               std::span<const Sample> samples, const AssessOptions& options) {
  std::vector<Assessment> all;
  const Eigen::VectorXd values = result.table.values();
  for (std::size_t s = 0; s < result.steps.size(); ++s) {
    const CalibrationStep& step = calibration.steps[s];
    all.push_back(assess(*step.problem, step.free,
                         {values.data(), static_cast<std::size_t>(values.size())}, samples,
                         options));
    all.back().step = step.name;
  }
  return all;
}

}  // namespace kinecal
