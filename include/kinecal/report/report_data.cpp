// Gathering what a report shows.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/report/report_data.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <tuple>

#include "kinecal/report/json_state.ipp"
#include "kinecal/report/left_out.ipp"
#include "kinecal/report/reported_block.ipp"

namespace kinecal {

namespace detail {

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
  data.pose = last.pose;
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
