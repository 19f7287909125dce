// The features of an error block with their residuals, before and after.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <map>

#include "kinecal/errors/plane_to_plane.hpp"
#include "kinecal/evaluation/any_evaluator.hpp"
#include "kinecal/report/report_data.hpp"
#include "kinecal/trust/feature_places.hpp"

namespace kinecal::detail {

/// Adds where the cameras of a block saw a feature.
inline void add_sight(const AnyProblem& problem, const Term& term, const Sample& sample,
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

/// Distances of the features of a term in a sample.
[[nodiscard]] inline std::vector<double> distances(const TermResiduals& residuals, int size) {
  std::vector<double> all;
  for (Eigen::Index row = 0; row < residuals.residual.size(); row += size) {
    all.push_back(residuals.residual.segment(row, size).norm());
  }
  return all;
}

/// The root of the mean squared distance in the first samples; NaN if a residual is undefined.
[[nodiscard]] inline double root_mean_square(const std::vector<ReportedFeature>& features,
                                             double ReportedFeature::*distance,
                                             std::size_t samples) {
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
[[nodiscard]] inline ReportedBlock reported_block(const Term& term, const Findings& findings) {
  ReportedBlock block{.name = term.name,
                      .type = term.options.type,
                      .unit = term.options.unit,
                      .components = term.feature_size};
  for (const Quantity quantity : term.quantities) {
    block.is_plane = block.is_plane || quantity == Quantity::plane;
  }
  block.is_plane = block.is_plane || block.type == "chain3d_to_plane";
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
[[nodiscard]] inline std::vector<ReportedBlock> reported_blocks(const AnyProblem& problem,
                                                                const std::vector<double>& initial,
                                                                const Findings& findings,
                                                                std::span<const Sample> samples,
                                                                std::size_t used) {
  std::vector<ReportedBlock> blocks;
  for (int t = 0; t < problem.num_terms(); ++t) {
    blocks.push_back(reported_block(problem.term(t), findings));
  }
  std::map<std::pair<int, int>, std::vector<double>> before;  // by term and sample
  (void)evaluate(problem, initial, nullptr, [&](int t, int sample, const TermResiduals& residuals) {
    before[{t, sample}] = distances(residuals, problem.term(t).feature_size);
  });
  std::vector<double> values;
  for (const Parameter& parameter : findings.result.table) values.push_back(parameter.value);
  (void)evaluate(problem, values, nullptr, [&](int t, int sample, const TermResiduals& residuals) {
    ReportedBlock& block = blocks[static_cast<std::size_t>(t)];
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
      add_sight(problem, problem.term(t), samples[static_cast<std::size_t>(sample)], feature,
                block);
    }
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
[[nodiscard]] inline std::string recorded_on(std::span<const Sample> samples) {
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

}  // namespace kinecal::detail
