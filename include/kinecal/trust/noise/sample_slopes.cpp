// Definitions of sample_slopes.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/trust/noise/sample_slopes.hpp"

#include <algorithm>
#include <optional>
#include <stdexcept>
#include <vector>

namespace kinecal::detail {

namespace {

/// Slopes of the rows of some error blocks; zero in the others, and everywhere if some are undefined.
/// @param moved  the problem with other samples
/// @param terms  the error blocks; empty: all
[[nodiscard]] Eigen::VectorXd slopes_of(const FittedSamples& fitted, const AnyProblem& moved,
                                        const std::vector<int>& terms, double step) {
  const LinearFit& fit = fitted.fit;
  const Eigen::VectorXd none = Eigen::VectorXd::Zero(fit.residual.size());
  Eigen::VectorXd slopes = none;
  try {
    const auto evaluator = moved.evaluator(fitted.free, 1, terms);
    const LinearFit there = linear_rows(*evaluator, fitted.values, fit.coordinates, false);
    auto at = there.blocks.begin();
    for (const RowBlock& block : fit.blocks) {
      const bool is_there =
          at != there.blocks.end() && at->term == block.term && at->sample == block.sample;
      if (!is_there) continue;
      if (at->size != block.size) return none;
      slopes.segment(block.first, block.size) = (there.residual.segment(at->first, block.size) -
                                                 fit.residual.segment(block.first, block.size)) /
                                                step;
      ++at;
    }
    if (at == there.blocks.end() && slopes.allFinite()) return slopes;
  } catch (const std::domain_error&) {  // a point behind a camera
  }
  return none;
}

}  // namespace

Eigen::VectorXd sample_slopes(const FittedSamples& fitted, const std::function<void(Sample&)>& move,
                              double step) {
  const std::unique_ptr<AnyProblem> moved = fitted.problem.without_samples();
  try {
    for (Sample sample : fitted.samples) {
      move(sample);
      moved->add_sample(sample);
    }
  } catch (const SampleError&) {
    return Eigen::VectorXd::Zero(fitted.fit.residual.size());
  }
  moved->set_poses_of_samples(fitted.problem.poses_of_samples());
  return slopes_of(fitted, *moved, {}, step);
}

MeasurementSlopes::MeasurementSlopes(const FittedSamples& fitted)
    : fitted_(fitted), moved_(fitted.problem.without_samples()) {
  for (const Sample& sample : fitted.samples) moved_->add_sample(sample);
  moved_->set_poses_of_samples(fitted.problem.poses_of_samples());
}

Eigen::VectorXd MeasurementSlopes::operator()(const std::string& sensor,
                                              const std::function<void(Observation&)>& move,
                                              double step) {
  const AnyProblem& problem = fitted_.problem;
  std::vector<int> terms;
  for (int t = 0; t < problem.num_terms(); ++t) {
    const std::vector<int>& sensors = problem.term(t).sensors;
    const bool is_its = std::any_of(sensors.begin(), sensors.end(), [&](int s) {
      return problem.sensors()[static_cast<std::size_t>(s)].mount().name == sensor;
    });
    if (is_its) terms.push_back(t);
  }
  std::vector<int> samples;  // in which an error block compares it
  for (const RowBlock& block : fitted_.fit.blocks) {
    const bool is_its = std::binary_search(terms.begin(), terms.end(), block.term);
    if (is_its && (samples.empty() || samples.back() != block.sample)) {
      samples.push_back(block.sample);
    }
  }
  const auto read = [&](const std::function<void(Observation&)>& change) {
    for (const int s : samples) {
      const Sample& sample = fitted_.samples[static_cast<std::size_t>(s)];
      const std::optional<Sample> paired = problem.paired(sample);
      Observation seen = *(paired ? *paired : sample).observation(sensor);
      change(seen);
      moved_->set_measurements(s, seen);
    }
  };
  const auto as_recorded = [](Observation&) {};
  Eigen::VectorXd slopes = Eigen::VectorXd::Zero(fitted_.fit.residual.size());
  if (samples.empty()) return slopes;
  if (!problem.sample_poses().empty()) terms.clear();  // they are fitted to all of a sample
  try {
    read(move);
    slopes = slopes_of(fitted_, *moved_, terms, step);
  } catch (const SampleError&) {
  }
  read(as_recorded);
  return slopes;
}

}  // namespace kinecal::detail
