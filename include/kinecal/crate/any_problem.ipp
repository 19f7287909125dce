// Definitions of any_problem.hpp: names, samples and shapes.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <stdexcept>

#include "kinecal/crate/any_problem.hpp"
#include "kinecal/crate/parameter_owners.ipp"
namespace kinecal {

KINECAL_INLINE AnyProblem::AnyProblem(Robot robot, std::string base, ParameterTable table,
                                      std::set<std::string> frames)
    : robot_(std::move(robot)),
      base_(std::move(base)),
      table_(std::move(table)),
      frames_(std::move(frames)) {
  (void)robot_.parent_joint(base_);
  set_owners();
}

KINECAL_INLINE void AnyProblem::add_sensor(const Sensor& sensor) {
  check_no_samples();
  sensors_.emplace_back(robot_, base_, sensor, table_, frames_);
  for (const int parameter : sensors_.back().camera_parameters()) {
    set_owner(parameter, sensor.parameter_prefix());
  }
}

KINECAL_INLINE void AnyProblem::add_prior(const std::string& name, const Prior& prior,
                                          const TermOptions& options) {
  const auto rows = prior.parameters(table_);
  if (std::all_of(rows.begin(), rows.end(), [](int parameter) { return parameter < 0; })) {
    std::vector<std::string> names(frames_.begin(), frames_.end());
    for (const Parameter& parameter : table_) names.push_back(parameter.name);
    throw std::invalid_argument("error block '" + name + "': param '" + prior.param +
                                "' is neither a free joint nor a free frame" +
                                did_you_mean(prior.param, names));
  }
  priors_.push_back({name, prior, options});
}

namespace detail {

[[nodiscard]] inline std::vector<const PackedObservation<double>*> observations_of(
    const AnyTerm& term, const std::vector<std::optional<PackedObservation<double>>>& observed) {
  std::vector<const PackedObservation<double>*> seen;
  for (const int s : term.sensors()) seen.push_back(&*observed[static_cast<std::size_t>(s)]);
  return seen;
}

[[nodiscard]] inline bool has_term(const SampleShape& shape, int term) {
  return std::find(shape.terms.begin(), shape.terms.end(), term) != shape.terms.end();
}

}  // namespace detail

KINECAL_INLINE void AnyProblem::add_sample(const Sample& sample) {
  Observations seen(sensors_.size());
  SampleShape shape;
  try {
    if (sample.joint_names.size() != sample.joint_positions.size()) {
      throw SampleError("it has " + std::to_string(sample.joint_names.size()) +
                        " joint names, but positions of " +
                        std::to_string(sample.joint_positions.size()));
    }
    for (std::size_t s = 0; s < sensors_.size(); ++s) {
      const Observation* observation = sample.observation(sensors_[s].sensor().name);
      if (observation == nullptr || observation->features.empty()) continue;
      seen[s] = sensors_[s].pack(sample, *observation);
    }
    for (int t = 0; t < num_terms(); ++t) {
      if (applies(term(t), sample, seen)) shape.terms.push_back(t);
    }
  } catch (const SampleError& e) {
    throw SampleError(sample.source + ": " + e.what());
  }
  for (const int t : shape.terms) {
    residuals_ += term(t).count(detail::observations_of(term(t), seen)) * term(t).feature_size();
  }
  forget_unused(shape, seen);
  auto& [of_samples, of_shape] = *shapes_.try_emplace(std::move(shape)).first;
  pack_sample(of_samples, of_shape, seen);
  ++of_shape.samples;
  sources_.push_back(sample.source);
}

KINECAL_INLINE int AnyProblem::samples_of(int term) const {
  int n = 0;
  for (const auto& [shape, of_shape] : shapes_) {
    if (detail::has_term(shape, term)) n += of_shape.samples;
  }
  return n;
}

KINECAL_INLINE int AnyProblem::shared_samples(int term) const {
  int n = 0;
  for (const auto& [shape, of_shape] : shapes_) {
    if (shape.terms.size() > 1 && detail::has_term(shape, term)) n += of_shape.samples;
  }
  return n;
}

KINECAL_INLINE void AnyProblem::check_no_samples() const {
  if (sources_.empty()) return;
  throw std::logic_error("sensors and error blocks are added before the samples");
}

KINECAL_INLINE std::vector<int> AnyProblem::sensors_of_block(
    const std::string& name, const std::vector<std::string>& sensors, int expected,
    bool second_is_pinhole) const {
  check_no_samples();
  std::vector<int> indices;
  for (const std::string& sensor : sensors) indices.push_back(sensor_index(sensor));
  if (static_cast<int>(indices.size()) != expected) {
    throw std::invalid_argument("error block '" + name + "' takes " + std::to_string(expected) +
                                " sensors, not " + std::to_string(indices.size()));
  }
  for (std::size_t i = 0; i < indices.size(); ++i) {
    const bool is_pinhole = model(indices[i]).sensor().type == SensorType::camera2d;
    if (is_pinhole != (second_is_pinhole && i == 1)) {
      throw std::invalid_argument("error block '" + name + "': sensor '" + sensors[i] + "' " +
                                  (is_pinhole ? "observes pixels; use a camera3d or chain3d"
                                              : "observes points; use a camera2d"));
    }
  }
  return indices;
}

KINECAL_INLINE int AnyProblem::sensor_index(const std::string& name) const {
  std::vector<std::string> names;
  for (std::size_t s = 0; s < sensors_.size(); ++s) {
    names.push_back(sensors_[s].sensor().name);
    if (names.back() == name) return static_cast<int>(s);
  }
  throw std::invalid_argument("no sensor '" + name + "'" + did_you_mean(name, names));
}

KINECAL_INLINE bool AnyProblem::applies(const AnyTerm& term, const Sample& sample,
                                        const Observations& observed) const {
  const std::string& beside = term.options().beside;
  if (!beside.empty() && sample.observation(beside) == nullptr) return false;
  const auto observing = std::count_if(
      sample.observations.begin(), sample.observations.end(),
      [&](const Observation& o) { return !o.features.empty() && o.sensor != beside; });
  if (term.options().alone && observing != std::ssize(term.sensors())) return false;
  for (const int s : term.sensors()) {
    if (!observed[static_cast<std::size_t>(s)]) return false;
  }
  const auto seen = detail::observations_of(term, observed);
  if (term.pairs_features() && seen[0]->usable.size() != seen[1]->usable.size()) {
    throw SampleError(
        "error block '" + term.name() + "': sensor '" + model(term.sensors()[0]).sensor().name +
        "' has " + std::to_string(seen[0]->usable.size()) + " features, sensor '" +
        model(term.sensors()[1]).sensor().name + "' has " + std::to_string(seen[1]->usable.size()));
  }
  if (const std::string why = term.why_not(seen); !why.empty()) {
    throw SampleError("error block '" + term.name() + "': " + why);
  }
  return term.count(seen) > 0;
}

/// Drops the observations that no term uses, so that they are not evaluated.
KINECAL_INLINE void AnyProblem::forget_unused(SampleShape& shape, Observations& seen) const {
  std::vector<bool> used(sensors_.size(), false);
  for (const int t : shape.terms) {
    for (const int s : term(t).sensors()) used[static_cast<std::size_t>(s)] = true;
  }
  shape.chains.resize(sensors_.size());
  for (std::size_t s = 0; s < used.size(); ++s) {
    if (!used[s]) seen[s].reset();
    if (seen[s]) shape.chains[s] = seen[s]->chain;
  }
}

}  // namespace kinecal
