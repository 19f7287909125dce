// Gathering what a report shows.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/report/report_data.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <tuple>

#include "kinecal/errors/plane_to_plane.hpp"
#include "kinecal/errors/point_to_outline.hpp"
#include "kinecal/evaluation/any_evaluator.hpp"
#include "kinecal/report/json_state.ipp"
#include "kinecal/report/left_out.ipp"
#include "kinecal/report/parameters_text.ipp"
#include "kinecal/trust/uncertainty/feature_places.hpp"

namespace kinecal {

namespace detail {
namespace {

// The features of an error block with their residuals, before and after.

/// Adds where the cameras of a block saw a feature.
void add_sight(const AnyProblem& problem, const Term& term, const Sample& sample,
               ReportedFeature& reported, ReportedBlock& block) {
  for (const int s : term.sensors) {
    const MountedSensor& sensor = problem.sensors()[static_cast<std::size_t>(s)];
    const Observation* seen = sample.observation(sensor.mount().name);
    if (seen == nullptr || !seen->camera) continue;
    const Feature* feature = observed_feature(*seen, reported.feature);
    if (feature == nullptr || !feature->point.allFinite()) continue;
    if (sensor.sensor().delivers(Quantity::pixel)) {
      reported.pixel = {feature->point.x(), feature->point.y()};
      block.image = {static_cast<double>(seen->camera->width),
                     static_cast<double>(seen->camera->height)};
    } else if (!reported.depth) {
      reported.depth = feature->point.z();
    }
  }
}

/// Adds where the outline of the robot should be in a sample's image.
/// @param places    for some values
/// @param features  of the term and the sample
void add_outline(const AnyProblem& problem, const FeaturePlaces& places, const Term& term,
                 const Sample& sample, std::span<ReportedFeature> features,
                 std::optional<std::array<double, 2>> ReportedFeature::*pixel) {
  const int robot = term.sensors.front(), camera = term.sensors.back();
  const auto seen = [&](int s) {
    return sample.observation(problem.sensors()[static_cast<std::size_t>(s)].mount().name);
  };
  const std::vector<Eigen::Vector2d> pixels =
      places.pixels(camera, *seen(camera), sample, places.placed(robot, *seen(robot), sample));
  for (ReportedFeature& feature : features) {
    const auto i = static_cast<std::size_t>(feature.feature.place);
    if (feature.feature.id || i >= pixels.size() || !pixels[i].allFinite()) continue;
    feature.*pixel = {pixels[i].x(), pixels[i].y()};
  }
}

/// Distances of the features of a term in a sample.
[[nodiscard]] std::vector<double> distances(const TermResiduals& residuals, int size) {
  std::vector<double> all;
  for (Eigen::Index row = 0; row < residuals.residual.size(); row += size) {
    all.push_back(residuals.residual.segment(row, size).norm());
  }
  return all;
}

/// The root of the mean squared distance in the first samples; NaN if a residual is undefined.
[[nodiscard]] double root_mean_square(const std::vector<ReportedFeature>& features,
                                      double ReportedFeature::*distance, std::size_t samples) {
  double squares = 0.0;
  int count = 0;
  for (const ReportedFeature& feature : features) {
    if (static_cast<std::size_t>(feature.sample) >= samples) continue;
    squares += feature.*distance * (feature.*distance);
    ++count;
  }
  return count == 0 ? 0.0 : std::sqrt(squares / count);
}

/// An error block without features.
[[nodiscard]] ReportedBlock reported_block(const AnyProblem& problem, const Term& term,
                                           const Findings& findings) {
  ReportedBlock block{.name = term.name,
                      .type = term.options.type,
                      .unit = term.options.unit,
                      .components = term.feature_size};
  for (const Quantity quantity : term.quantities) {
    block.is_plane = block.is_plane || quantity == Quantity::plane;
  }
  block.is_plane = block.is_plane || block.type == "chain3d_to_plane";
  for (const int s : term.sensors) {
    const MountedSensor& sensor = problem.sensors()[static_cast<std::size_t>(s)];
    if (sensor.sensor().is_camera()) block.cameras.push_back(sensor.mount().name);
  }
  if (const auto* noise = of_block(findings.assessments, &Assessment::noise, block.name)) {
    block.sigma = noise->freedom > 0.0 ? noise->sigma : 0.0;
    block.sigma_given = noise->given;
  }
  const auto* error = of_block(findings.assessments, &Assessment::held_out, block.name);
  if (error != nullptr && error->features > 0) block.held_out = error->held_out;
  return block;
}

/// The error blocks of a problem with all features, in the order of samples.
/// @param initial  values of all parameters before the calibration
/// @param samples  those used, then those left out
/// @param used     number of the former
[[nodiscard]] std::vector<ReportedBlock> reported_blocks(const AnyProblem& problem,
                                                         const std::vector<double>& initial,
                                                         const Findings& findings,
                                                         std::span<const Sample> samples,
                                                         std::size_t used) {
  std::vector<ReportedBlock> blocks;
  for (int t = 0; t < problem.num_terms(); ++t) {
    blocks.push_back(reported_block(problem, problem.term(t), findings));
  }
  std::map<std::pair<int, int>, std::vector<double>> before;  // by term and sample
  (void)evaluate(problem, initial, nullptr, [&](int t, int sample, const TermResiduals& residuals) {
    before[{t, sample}] = distances(residuals, problem.term(t).feature_size);
  });
  std::vector<double> values;
  for (const Parameter& parameter : findings.result.table) values.push_back(parameter.value);
  const FeaturePlaces places_before(problem, initial), places_after(problem, values);
  (void)evaluate(problem, values, nullptr, [&](int t, int sample, const TermResiduals& residuals) {
    ReportedBlock& block = blocks[static_cast<std::size_t>(t)];
    const Term& term = problem.term(t);
    const Sample& of = samples[static_cast<std::size_t>(sample)];
    const std::size_t known_before = block.features.size();
    const auto first = before.find({t, sample});
    const std::vector<double> after = distances(residuals, block.components);
    for (std::size_t i = 0; i < after.size(); ++i) {
      const bool known = first != before.end() && i < first->second.size();
      ReportedFeature& feature = block.features.emplace_back();
      feature.sample = sample;
      feature.feature = problem.feature(t, sample, static_cast<std::ptrdiff_t>(i));
      feature.before = known ? first->second[i] : std::numeric_limits<double>::quiet_NaN();
      feature.after = after[i];
      const Eigen::Index row = static_cast<Eigen::Index>(i) * block.components;
      for (Eigen::Index c = 0; c < block.components; ++c) {
        feature.residual.push_back(residuals.residual(row + c));
      }
      add_sight(problem, term, of, feature, block);
    }
    if (term.options.type != PointToOutline::kType) return;
    const std::span<ReportedFeature> added = std::span(block.features).subspan(known_before);
    add_outline(problem, places_after, term, of, added, &ReportedFeature::outline_after);
    if (!has_before(findings, problem, term)) return;
    add_outline(problem, places_before, term, of, added, &ReportedFeature::outline_before);
  });
  for (ReportedBlock& block : blocks) {
    std::stable_sort(block.features.begin(), block.features.end(),
                     [](const auto& a, const auto& b) { return a.sample < b.sample; });
    block.rms_before = root_mean_square(block.features, &ReportedFeature::before, used);
    block.rms_after = root_mean_square(block.features, &ReportedFeature::after, used);
  }
  return blocks;
}

/// The day on which the first sample was recorded, "2026-11-23"; empty if unknown.
[[nodiscard]] std::string recorded_on(std::span<const Sample> samples) {
  std::optional<std::chrono::nanoseconds> first;
  for (const Sample& sample : samples) {
    if (sample.stamp && (!first || *sample.stamp < *first)) first = sample.stamp;
  }
  using std::chrono::seconds;
  constexpr seconds kNoEpoch{100'000'000};  // 1973: a simulator's clock
  if (!first || *first < kNoEpoch) return "";
  const auto time = static_cast<std::time_t>(std::chrono::duration_cast<seconds>(*first).count());
  constexpr std::time_t kYear9999 = 253'402'300'799;
  return time > kYear9999 ? "" : fmt::format("{:%Y-%m-%d}", fmt::gmtime(time));
}

}  // namespace

/// The error blocks of all steps that ran; if a block is in several steps, the last one counts.
[[nodiscard]] inline std::vector<ReportedBlock> reported_blocks(const Calibration& calibration,
                                                                const Findings& findings,
                                                                std::span<const Sample> samples,
                                                                std::span<const Sample> left_out) {
  std::vector<ReportedBlock> blocks;
  std::set<std::string> seen;
  std::vector<double> initial;
  for (const Parameter& parameter : calibration.table) initial.push_back(parameter.value);
  for (std::size_t s = findings.result.steps.size(); s-- > 0;) {
    const ProblemWithLeftOut all(*calibration.steps[s].problem, samples, left_out);
    std::vector<ReportedBlock> of_step =
        reported_blocks(all.problem(), initial, findings, all.samples(), samples.size());
    std::erase_if(of_step, [&](const ReportedBlock& block) { return seen.contains(block.name); });
    for (const ReportedBlock& block : of_step) seen.insert(block.name);
    blocks.insert(blocks.begin(), std::move_iterator(of_step.begin()),
                  std::move_iterator(of_step.end()));
  }
  return blocks;
}

/// Samples by number in the problem, then those left out.
[[nodiscard]] inline std::vector<ReportedSample> reported_samples(const Findings& findings) {
  std::vector<ReportedSample> all;
  for (std::size_t i = 0; i < findings.sources.size(); ++i) {
    all.push_back({.number = findings.numbers[i], .source = findings.sources[i], .why = {}});
  }
  if (!findings.assessments.empty()) {
    const Assessment& last = findings.assessments.back();
    for (const CaptureError& error : last.captures) {
      ReportedSample& sample = all.at(static_cast<std::size_t>(error.sample));
      sample.times = error.times;
      sample.bad = error.bad;
      if (error.bad) sample.why = capture_text(error, last) + cause_text(findings, error.sample);
    }
  }
  for (const LeftOutSample& sample : findings.left_out) {
    all.push_back({sample.number, sample.source, true, true, sample.why});
  }
  return all;
}

[[nodiscard]] inline std::vector<ReportedParameter> reported_parameters(
    const Calibration& calibration, const Findings& findings) {
  std::vector<ReportedParameter> all;
  std::vector<std::string> owners;
  if (!calibration.steps.empty()) owners = calibration.steps.front().problem->owners();
  for (const int i : findings.result.calibrated) {
    const Parameter& parameter = findings.result.table[i];
    ReportedParameter& reported = all.emplace_back();
    reported.name = parameter.name;
    const auto index = static_cast<std::size_t>(i);
    if (index < owners.size()) reported.owner = owners[index];
    reported.unit = parameter.unit;
    reported.value = parameter.value;
    reported.initial = parameter.initial;
    const auto deviation = findings.deviation(i);
    if (deviation && std::isfinite(*deviation)) reported.sigma = deviation;
    reported.note = deviation                      ? note_on(parameter, *deviation)
                    : findings.assessments.empty() ? ""
                                                   : "at its bound";
    if (is_of_camera_alone(findings, parameter)) reported.note = kInCamera;
  }
  return all;
}

/// Correlations of the determined parameters of all steps.
inline void add_correlations(const Findings& findings, ReportData& data) {
  const CalibratedState state = state_of_steps(findings.assessments);
  std::vector<Eigen::Index> known;
  for (Eigen::Index i = 0; i < state.covariance.rows(); ++i) {
    const int parameter = state.parameters[static_cast<std::size_t>(i)];
    const auto deviation = findings.deviation(parameter);
    if (!(state.covariance(i, i) > 0.0) || !deviation || !std::isfinite(*deviation)) continue;
    known.push_back(i);
    data.correlated.push_back(findings.result.table[parameter].name);
  }
  for (const Eigen::Index i : known) {
    std::vector<double>& row = data.correlation.emplace_back();
    for (const Eigen::Index j : known) {
      const double both = std::sqrt(state.covariance(i, i) * state.covariance(j, j));
      row.push_back(std::clamp(state.covariance(i, j) / both, -1.0, 1.0));
    }
  }
}

}  // namespace detail

ReportData report_data(const Calibration& calibration, const Findings& findings,
                       std::span<const Sample> samples, std::span<const Sample> left_out) {
  ReportData data;
  data.robot = findings.robot;
  data.verdict = findings.judgement.verdict;
  data.reasons = findings.judgement.reasons;
  data.helps = findings.helps;
  data.search = findings.search;
  data.read_back = findings.read_back;
  data.next = next_step(findings);
  data.steps = findings.result.steps;
  data.solved = findings.used_count();
  data.drawn = findings.drawn;
  data.blocks = detail::reported_blocks(calibration, findings, samples, left_out);
  data.samples = detail::reported_samples(findings);
  data.parameters = detail::reported_parameters(calibration, findings);
  data.recorded = detail::recorded_on(samples);
  data.summary = findings_text(findings);
  if (findings.assessments.empty()) return data;
  detail::add_correlations(findings, data);
  const Assessment& last = findings.assessments.back();
  const auto name = [&](int parameter) { return findings.result.table[parameter].name; };
  data.rank = last.observability.rank;
  for (const Combination& combination : last.observability.unobservable) {
    auto& of = data.unobservable.emplace_back();
    for (const auto& [parameter, factor] : combination) of.emplace_back(name(parameter), factor);
  }
  for (const int parameter : last.observability.hold) data.hold.push_back(name(parameter));
  data.compared = last.compared;
  data.between = last.between;
  data.cameras = last.maps;
  return data;
}

void add_points(const RobotScene& scene, ReportData& data) {
  std::map<std::tuple<std::string, int, std::string>, std::array<double, 3>> measured;
  for (const SceneSample& sample : scene.samples) {
    for (const SceneFeature& feature : sample.features) {
      if (!feature.after) continue;
      const std::string& block = scene.blocks[static_cast<std::size_t>(feature.block)];
      measured.emplace(std::tuple(block, sample.number, feature.name), (*feature.after)[0]);
    }
  }
  for (ReportedBlock& block : data.blocks) {
    if (!block.is_plane) continue;
    for (ReportedFeature& feature : block.features) {
      const int number = data.samples[static_cast<std::size_t>(feature.sample)].number;
      const auto found = measured.find({block.name, number, feature.feature.text()});
      if (found != measured.end()) feature.point = found->second;
    }
  }
}

}  // namespace kinecal
