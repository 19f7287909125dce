// SPDX-License-Identifier: Apache-2.0
#include "new_samples.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>

#include "input.hpp"
#include "kinecal/config/assemble.hpp"
#include "kinecal/config/complete_samples.hpp"
#include "kinecal/config/doubts/joint_positions.hpp"
#include "kinecal/config/doubts/repeated_samples.hpp"
#include "kinecal/config/doubts/sensor_points.hpp"
#include "kinecal/config/doubts/used_joints.hpp"
#include "kinecal/evaluation/any_evaluator.hpp"
#include "kinecal/files/cameras/camera_info.hpp"
#include "kinecal/files/cameras/set_camera.hpp"
#include "kinecal/procedure/background_rounds.hpp"
#include "kinecal/procedure/surface_rounds.hpp"
#include "kinecal/report/text.hpp"
#include "kinecal/text/reading.hpp"
#include "kinecal/trust/noise/noise.hpp"

namespace kinecal::cli {
namespace {

constexpr std::size_t kWorst = 3;  ///< samples that are listed

/// The configuration with all that may have moved in its last step: the offset of each joint that moves,
/// the frame of each fixed one.
Config with_possible_movers(Config config, const Robot& robot) {
  StepConfig& step = config.steps.back();
  for (const Joint* joint : detail::joints_between(config, robot)) {
    if (joint->mimic) continue;                        // the joint that it follows is there as well
    if (joint->type == JointType::floating) continue;  // its pose is measured
    if (moves(joint->type)) {
      const auto free = free_parameters(step);
      const auto same = [&](const FreeParamConfig& param) { return param.name == joint->name; };
      if (std::any_of(free.begin(), free.end(), same)) continue;
      step.free_params.push_back({joint->name, step.place});
    } else {
      const auto same = [&](const FreeFrameConfig& frame) { return frame.name == joint->name; };
      if (std::any_of(step.free_frames.begin(), step.free_frames.end(), same)) continue;
      step.free_frames.push_back({joint->name, {true, true, true, true, true, true}, step.place});
    }
  }
  return config;
}

void doubt(const Config& config, const Robot& robot, std::span<const Sample> samples,
           Diagnostics& diagnostics) {
  const std::vector<detail::UsedJoint> joints = detail::used_joints(config, robot, samples);
  detail::check_joint_positions(joints, samples, diagnostics);
  (void)detail::check_repeated_samples(config, joints, samples, diagnostics);
  detail::check_sensor_points(config, robot, samples, diagnostics);
}

/// Associates clouds and masks with the surface of the robot where the result puts it.
/// @param config  gets the links of the surface
void associate_new(const StoredResult& result, const NewSampleOptions& options, Config& config,
                   NewSamples& fresh) {
  fresh.assumed = take_off_if_after(result, options, fresh.samples);
  const SurfaceInput input{result.robot, result.urdf_text, urdf_beside_meshes(result),
                           options.mesh_paths};
  Diagnostics& found = fresh.diagnostics;
  const std::size_t before = found.doubts.size();
  const std::vector<std::vector<SurfaceBlock>> blocks = read_surface_blocks(input, config, found);
  if (!found.errors.empty()) return;
  match_surface_at(input, blocks, result.values, config, fresh.samples, found);
  if (!are_whole(blocks))
    return;  // points of links that are not listed may be near the listed ones
  const auto first = found.doubts.begin() + static_cast<std::ptrdiff_t>(before);
  fresh.off_robot.assign(first, found.doubts.end());
  found.doubts.erase(first, found.doubts.end());
}

void assemble_new(const StoredResult& result, const Config& config, NewSamples& fresh) {
  Diagnostics quiet;  // what a configuration leaves free is not of interest here
  fresh.calibration =
      assemble(with_possible_movers(config, result.robot), result.robot, fresh.samples, quiet);
  fresh.diagnostics.errors.insert(fresh.diagnostics.errors.end(), quiet.errors.begin(),
                                  quiet.errors.end());
  if (!fresh.diagnostics.errors.empty()) return;
  fresh.values = result.values_of(fresh.problem().table());
  const Assessment noise = assess_new(result, fresh);
  double sum = 0.0, rows = 0.0;
  const auto undefined =
      evaluate(fresh.problem(), fresh.values, nullptr, [&](int t, int, const TermResiduals& r) {
        const double sigma = noise.noise[static_cast<std::size_t>(t)].sigma;
        sum += r.residual.squaredNorm() / (sigma * sigma);
        rows += static_cast<double>(r.residual.size());
      });
  fresh.misfit = undefined ? std::numeric_limits<double>::infinity() : sum / std::max(1.0, rows);
}

/// How well new samples are explained.
struct Explanation {
  enum Kind { holds, one_moved, nothing_single, undefined } kind = undefined;
  double score = std::numeric_limits<double>::infinity();  ///< see Drift

  /// True if this is clearly the better one.
  [[nodiscard]] bool beats(const Explanation& other) const {
    constexpr double kClearly = 6.0;  // likelihood ratio of 20
    return kind != other.kind ? kind < other.kind : score + kClearly < other.score;
  }
};

Explanation explanation(const StoredResult& result, const NewSamples& fresh, double level) {
  if (!std::isfinite(fresh.misfit)) return {};
  const Drift drift = drift_of(result, fresh, {level});
  const bool moved = !drift.movers.empty() && drift.movers.front().explains;
  return {drift.holds ? Explanation::holds
          : moved     ? Explanation::one_moved
                      : Explanation::nothing_single,
          drift.score};
}

/// "taken as recorded before the result was installed (--samples-recorded): after it, ..."
std::string assumption(bool after, const Explanation& taken, const Explanation& other) {
  std::string text =
      fmt::format("taken as recorded {} the result was installed (--samples-recorded)",
                  after ? "after" : "before");
  const char* otherwise = after ? "before" : "after";
  if (other.kind == Explanation::undefined) {
    return text + fmt::format(": {} it, a recorded point would be behind a camera", otherwise);
  }
  if (taken.kind == other.kind) {
    return text + fmt::format(": {} it, the samples would be less likely", otherwise);
  }
  return text + fmt::format(": {} it, {}", otherwise,
                            other.kind == Explanation::one_moved
                                ? "something would have moved"
                                : "nothing single would explain the residuals");
}

/// Decides whether the result was in force when the samples were recorded.
void choose_recorded(const StoredResult& result, const NewSampleOptions& options,
                     NewSamples& fresh) {
  NewSamples with;
  with.samples = fresh.samples;
  if (!take_off(result, fresh.problem(), with.samples)) return;
  assemble_new(result, result.config, with);
  if (!with.diagnostics.errors.empty()) return;
  bool after = false;
  if (options.recorded) {
    after = *options.recorded == Recorded::after;
    fresh.assumed = fmt::format("recorded {} the result was installed, as --samples-recorded says",
                                after ? "after" : "before");
  } else {
    const Explanation before = explanation(result, fresh, options.level);
    const Explanation then = explanation(result, with, options.level);
    after = then.beats(before);
    if (after || before.beats(then)) {
      fresh.assumed = after ? assumption(after, then, before) : assumption(after, before, then);
    } else if (before.kind != Explanation::holds) {
      fresh.assumed =
          "the samples do not show whether they were recorded before or after the result was "
          "installed: give --samples-recorded before or after; taken as before";
    }
  }
  if (!after) return;
  fresh.samples = std::move(with.samples);
  fresh.calibration = std::move(with.calibration);
  fresh.values = std::move(with.values);
  fresh.misfit = with.misfit;
}

[[nodiscard]] double root_mean_square(const std::vector<double>& distances) {
  double sum = 0.0;
  for (const double d : distances) sum += d * d;
  return distances.empty() ? 0.0 : std::sqrt(sum / static_cast<double>(distances.size()));
}

/// Noise of a coordinate of new samples.  Background near a robot counts as its surface does, so there it is that of the
/// median.
[[nodiscard]] double noise_now(const Term& term, const std::vector<double>& distances) {
  return term.is_of_surface()
             ? robust_sigma(distances, term.feature_size)
             : root_mean_square(distances) / std::sqrt(static_cast<double>(term.feature_size));
}

/// The same of the calibration; zero if it is not known.
[[nodiscard]] double noise_then(const StoredResult& result, const Term& term) {
  for (const BlockNoise& noise : result.noise) {
    if (noise.block == term.name) return term.is_of_surface() ? noise.robust : noise.sigma;
  }
  return 0.0;
}

const FittedBlock& fitted_block(const StoredResult& result, const std::string& name) {
  static const FittedBlock none;
  const auto found = result.fitted.find(name);
  return found == result.fitted.end() ? none : found->second;
}

}  // namespace

bool take_off(const StoredResult& result, const AnyProblem& problem, std::vector<Sample>& samples) {
  bool changes = !result.added_offsets.empty();
  add_rising(result.added_offsets, samples, -1.0);
  for (const MountedSensor& sensor : problem.sensors()) {
    const Mount& mount = sensor.mount();
    const auto inverse = [&](const char* part) {
      const auto value = result.values.find(parameter_name(mount.parameter_prefix(), part));
      return value == result.values.end() ? 0.0 : 1.0 / (1.0 + value->second) - 1.0;
    };
    const double fx = inverse("fx"), fy = inverse("fy"), cx = inverse("cx"), cy = inverse("cy");
    if (fx == 0.0 && fy == 0.0 && cx == 0.0 && cy == 0.0) continue;
    for (Sample& sample : samples) {
      for (Observation& seen : sample.observations) {
        if (seen.sensor != mount.name || !seen.camera) continue;
        seen.camera = calibrated_camera_info(*seen.camera, fx, fy, cx, cy);
        changes = true;
      }
    }
  }
  return changes;
}

Calibration with_movers(const StoredResult& result) {
  Diagnostics ignored;  // calibrate said it
  return assemble(with_possible_movers(result.config, result.robot), result.robot, {}, ignored);
}

Drift drift_of(const StoredResult& result, const NewSamples& fresh, const DriftOptions& options) {
  return check_drift(fresh.problem(), fresh.samples, result.state(fresh.problem().table()),
                     options);
}

std::string urdf_beside_meshes(const StoredResult& result) {
  return std::filesystem::exists(result.urdf_then) ? result.urdf_then : result.urdf;
}

std::string take_off_if_after(const StoredResult& result, const NewSampleOptions& options,
                              std::vector<Sample>& samples) {
  Diagnostics ignored;  // calibrate said it
  const Calibration without = assemble(result.config, result.robot, {}, ignored);
  if (without.steps.empty()) return "";
  std::vector<Sample> taken_off = samples;
  if (!take_off(result, *without.steps.back().problem, taken_off)) return "";
  if (options.recorded == Recorded::after) samples = std::move(taken_off);
  return options.recorded ? ""
                          : "taken as recorded before the result was installed; if not, give "
                            "--samples-recorded after";
}

std::vector<Sample> read_new_recordings(const NewSampleOptions& options, Diagnostics& diagnostics) {
  std::vector<Sample> samples = read_recordings(options.samples, diagnostics).samples;
  for (const std::string& camera : options.cameras) {
    try {
      set_camera(samples, camera, diagnostics);
    } catch (const InputError& e) {
      diagnostics.errors.emplace_back(e.what());
    }
  }
  if (samples.empty() && diagnostics.errors.empty()) {
    diagnostics.error({options.samples.front(), 0}, "has no samples");
  }
  return samples;
}

NewSamples read_new_samples(const StoredResult& result, const NewSampleOptions& options) {
  Diagnostics diagnostics;
  std::vector<Sample> samples = read_new_recordings(options, diagnostics);
  return hold_against(result, std::move(samples), options, std::move(diagnostics));
}

NewSamples hold_against(const StoredResult& result, std::vector<Sample> samples,
                        const NewSampleOptions& options, Diagnostics diagnostics) {
  if (!result.config.per_sample.empty()) {
    throw InputError(
        fmt::format("{}: its target has a pose of its own in each sample (per_sample: {}), so new "
                    "samples do not say whether "
                    "the result holds; calibrate them, and compare the files",
                    result.folder, result.config.per_sample.front().name));
  }
  NewSamples fresh;
  fresh.samples = std::move(samples);
  fresh.diagnostics = std::move(diagnostics);
  if (!fresh.diagnostics.errors.empty()) return fresh;
  Config config = result.config;
  const bool is_of_surface = compares_surface(config);
  complete_samples(config, fresh.samples);
  if (is_of_surface) associate_new(result, options, config, fresh);
  if (has_background(config, fresh.samples)) {
    (void)leave_out_background(result.robot, result.values, config, fresh.samples, {},
                               fresh.diagnostics);
  }
  if (!fresh.diagnostics.errors.empty()) return fresh;
  doubt(config, result.robot, fresh.samples, fresh.diagnostics);
  if (!fresh.diagnostics.errors.empty()) return fresh;
  assemble_new(result, config, fresh);
  if (!fresh.diagnostics.errors.empty() && !fresh.off_robot.empty()) {
    fresh.diagnostics.errors = fresh.off_robot;  // so far that nothing is left to compare
    return fresh;
  }
  if (!fresh.diagnostics.errors.empty()) {
    fresh.diagnostics.errors.push_back(
        fmt::format("these samples do not fit robot '{}' and the configuration of {}; are they of "
                    "another robot?",
                    result.robot.name(), result.folder));
    return fresh;
  }
  if (!is_of_surface) choose_recorded(result, options, fresh);
  return fresh;
}

Assessment assess_new(const StoredResult& result, const NewSamples& fresh) {
  const AnyProblem& problem = fresh.problem();
  Assessment found;
  for (int t = 0; t < problem.num_terms(); ++t) {
    const std::string& name = problem.term(t).name;
    const auto noise =
        std::find_if(result.noise.begin(), result.noise.end(),
                     [&](const BlockNoise& of) { return of.block == name && of.sigma > 0.0; });
    if (noise == result.noise.end() && problem.samples_of(t) == 0) {
      found.noise.push_back({.block = name, .unit = problem.term(t).options.unit, .sigma = 1.0});
      continue;
    }
    if (noise == result.noise.end()) {
      throw InputError(
          fmt::format("{}: the noise of error block '{}' is not known: the calibration "
                      "used all residuals for parameters; record more samples and "
                      "calibrate again",
                      result.report, name));
    }
    found.noise.push_back(*noise);
  }
  found.captures.resize(static_cast<std::size_t>(problem.num_samples()));
  (void)evaluate(problem, fresh.values, nullptr, [&](int t, int sample, const TermResiduals& rows) {
    const int size = problem.term(t).feature_size;
    const BlockNoise& noise = found.noise[static_cast<std::size_t>(t)];
    CaptureError& worst = found.captures[static_cast<std::size_t>(sample)];
    worst.sample = sample;
    for (Eigen::Index row = 0; row < rows.residual.size(); row += size) {
      const double distance = rows.residual.segment(row, size).norm();
      if (distance <= worst.times * noise.sigma) {
        if (worst.term == t) worst.others = std::max(worst.others, distance);
        continue;
      }
      worst.others = worst.term == t ? worst.distance : 0.0;
      worst.term = t;
      worst.feature = problem.feature(t, sample, row / size);
      worst.distance = distance;
      worst.times = distance / noise.sigma;
    }
  });
  return found;
}

std::string fit_text(const StoredResult& result, const NewSamples& fresh) {
  const AnyProblem& problem = fresh.problem();
  const auto norms = feature_norms(problem, {fresh.values.data(), fresh.values.size()});
  TextTable table({"error block", "features", "unit", "now", "calibration", "held out", "worst now",
                   "noise now", "noise then"});
  for (int t = 0; t < problem.num_terms(); ++t) {
    const auto& distances = norms[static_cast<std::size_t>(t)];
    if (distances.empty()) continue;
    const Term& term = problem.term(t);
    const std::string& unit = term.options.unit;
    const auto text = [&](double value) { return in_reading_unit(value, unit); };
    const FittedBlock& then = fitted_block(result, term.name);
    const double now = root_mean_square(distances);
    table.add({term.name, fmt::format("{}", distances.size()), reading_unit(unit), text(now),
               text(then.distance), then.held_out ? text(*then.held_out) : "-",
               text(*std::max_element(distances.begin(), distances.end())),
               text(noise_now(term, distances)), text(noise_then(result, term))});
  }
  return "Fit: distances of features, root of the mean square; noise of a coordinate\n" +
         table.str();
}

std::vector<FitChange> fit_changes(const StoredResult& result, const NewSamples& fresh) {
  const AnyProblem& problem = fresh.problem();
  const auto norms = feature_norms(problem, {fresh.values.data(), fresh.values.size()});
  std::vector<FitChange> changes;
  for (int t = 0; t < problem.num_terms(); ++t) {
    const auto& distances = norms[static_cast<std::size_t>(t)];
    if (distances.empty()) continue;
    const Term& term = problem.term(t);
    const FittedBlock& then = fitted_block(result, term.name);
    changes.push_back(term.is_of_surface()
                          ? FitChange{term.name, term.options.unit, noise_then(result, term),
                                      noise_now(term, distances)}
                          : FitChange{term.name, term.options.unit,
                                      then.held_out.value_or(then.distance),
                                      root_mean_square(distances)});
  }
  return changes;
}

detail::Json fit_json(const StoredResult& result, const NewSamples& fresh) {
  const AnyProblem& problem = fresh.problem();
  const auto norms = feature_norms(problem, {fresh.values.data(), fresh.values.size()});
  detail::Json list = detail::Json::array();
  for (int t = 0; t < problem.num_terms(); ++t) {
    const auto& distances = norms[static_cast<std::size_t>(t)];
    if (distances.empty()) continue;
    const Term& term = problem.term(t);
    const FittedBlock& then = fitted_block(result, term.name);
    list.push_back({{"name", term.name},
                    {"unit", term.options.unit},
                    {"features", distances.size()},
                    {"distance", root_mean_square(distances)},
                    {"worst", *std::max_element(distances.begin(), distances.end())},
                    {"calibration", then.distance},
                    {"held_out", then.held_out ? detail::Json(*then.held_out) : detail::Json()}});
  }
  return list;
}

namespace {

/// Of a cloud or mask some features are always far off, so it is judged as a whole: by the noise of the median.
[[nodiscard]] std::string worst_clouds_text(const StoredResult& result, const NewSamples& fresh) {
  const AnyProblem& problem = fresh.problem();
  std::map<std::pair<int, int>, std::vector<double>> distances;  // by sample and error block
  (void)evaluate(problem, fresh.values, nullptr, [&](int t, int sample, const TermResiduals& rows) {
    const int size = problem.term(t).feature_size;
    std::vector<double>& of_sample = distances[{sample, t}];
    for (Eigen::Index row = 0; row < rows.residual.size(); row += size) {
      of_sample.push_back(rows.residual.segment(row, size).norm());
    }
  });
  std::vector<std::pair<double, std::string>> all;  // times, text
  for (const auto& [of, norms] : distances) {
    const Term& term = problem.term(of.second);
    const double now = noise_now(term, norms), then = noise_then(result, term);
    if (!(then > 0.0)) continue;
    all.emplace_back(
        now / then,
        fmt::format("  {} (sample {}): error block '{}': noise {}, {:.2g} times that of the "
                    "calibration\n",
                    fresh.samples[static_cast<std::size_t>(of.first)].source, of.first + 1,
                    term.name, reading(now, term.options.unit), now / then));
  }
  std::stable_sort(all.begin(), all.end(),
                   [](const auto& a, const auto& b) { return a.first > b.first; });
  std::string text;
  for (std::size_t i = 0; i < std::min(kWorst, all.size()); ++i) text += all[i].second;
  return "Worst samples\n" + text;
}

}  // namespace

std::string worst_text(const StoredResult& result, const NewSamples& fresh) {
  if (compares_surface(result.config)) return worst_clouds_text(result, fresh);
  const Assessment found = assess_new(result, fresh);
  std::vector<CaptureError> worst = found.captures;
  std::stable_sort(worst.begin(), worst.end(),
                   [](const auto& a, const auto& b) { return a.times > b.times; });
  std::string text;
  for (std::size_t i = 0; i < std::min(kWorst, worst.size()); ++i) {
    const int sample = worst[i].sample;
    text += fmt::format("  {} (sample {}): {}\n",
                        fresh.samples[static_cast<std::size_t>(sample)].source, sample + 1,
                        capture_text(worst[i], found));
  }
  return "Worst samples\n" + text;
}

}  // namespace kinecal::cli
