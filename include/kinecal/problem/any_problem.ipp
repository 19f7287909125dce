// Definitions of any_problem.hpp: names, samples and shapes.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <stdexcept>

#include "kinecal/problem/any_problem.hpp"
#include "kinecal/problem/parameter_owners.ipp"
#include "kinecal/problem/term_applies.ipp"
#include "kinecal/samples/paired_features.hpp"

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

KINECAL_INLINE void AnyProblem::mount(std::shared_ptr<const AnySensor> sensor, const Mount& mount) {
  check_no_samples();
  for (const MountedSensor& known : sensors_) {
    if (known.mount().name == mount.name) {
      throw std::invalid_argument("two sensors have the name '" + mount.name + "'");
    }
  }
  sensors_.emplace_back(robot_, base_, mount, std::move(sensor), table_, frames_);
  for (const int parameter : sensors_.back().parameters()) {
    set_owner(parameter, mount.parameter_prefix());
  }
}

namespace detail {

inline void check_positions(const Sample& sample) {
  const std::size_t names = sample.joint_names.size(), positions = sample.joint_positions.size();
  if (names == positions) return;
  throw SampleError("it has " + std::to_string(names) + " joint names, but positions of " +
                    std::to_string(positions));
}

[[nodiscard]] inline bool has_term(const detail::SampleLayout& layout, int term) {
  return std::find(layout.terms.begin(), layout.terms.end(), term) != layout.terms.end();
}

}  // namespace detail

KINECAL_INLINE std::optional<Sample> AnyProblem::paired(const Sample& sample) const {
  if (!has_ids(sample)) return std::nullopt;
  std::vector<ComparedSensors> blocks;
  for (int t = 0; t < num_terms(); ++t) {
    ComparedSensors& block = blocks.emplace_back();
    for (const int s : term(t).sensors()) block.names.push_back(sensor(s).mount().name);
    block.paired = term(t).pairs_features();
  }
  return pair_features(sample, blocks);
}

KINECAL_INLINE void AnyProblem::add_sample(const Sample& sample) {
  std::optional<Sample> in_order;
  detail::SampleNumbers seen;
  seen.sensors.resize(sensors_.size());
  detail::SampleLayout layout;
  try {
    detail::check_positions(sample);
    in_order = paired(sample);
    for (std::size_t s = 0; s < sensors_.size(); ++s) {
      const Observation* observation =
          (in_order ? *in_order : sample).observation(sensors_[s].mount().name);
      if (observation == nullptr || observation->features.empty()) continue;
      seen.sensors[s] = sensors_[s].numbers(sample, *observation);
    }
    for (int t = 0; t < num_terms(); ++t) {
      if (!applies(term(t), sample, seen)) continue;
      layout.terms.push_back(t);
      seen.terms.push_back(
          {detail::factors_of(term(t), seen), detail::conditions_of(term(t), sample)});
      if (!seen.terms.back().factors.empty()) layout.weighted.push_back(t);
    }
  } catch (const SampleError& e) {
    throw SampleError(sample.source + ": " + e.what());
  }
  for (const int t : layout.terms) {
    residuals_ += term(t).count(detail::observations_of(term(t), seen)) * term(t).feature_size();
    const std::string& first = sensor(term(t).sensors().front()).mount().name;
    const Observation* recorded = sample.observation(first);
    auto labels = detail::labels_of(term(t), seen, *recorded,
                                    in_order ? *in_order->observation(first) : *recorded);
    if (!labels.empty()) labels_.emplace(std::pair(num_samples(), t), std::move(labels));
  }
  forget_unused(layout, seen);
  auto& [of_sample, of_layout] =
      *layouts_.try_emplace(std::move(layout), OfLayout{layouts_.size()}).first;
  add_to_batch(of_layout.index, of_sample, seen);
  ++of_layout.samples;
  sources_.push_back(sample.source);
}

KINECAL_INLINE FeatureLabel AnyProblem::feature(int term, int sample, std::ptrdiff_t i) const {
  const auto labels = labels_.find({sample, term});
  if (labels == labels_.end()) return {static_cast<int>(i)};
  return labels->second.at(static_cast<std::size_t>(i));
}

KINECAL_INLINE int AnyProblem::samples_of(int term) const {
  int n = 0;
  for (const auto& [layout, of_layout] : layouts_) {
    if (detail::has_term(layout, term)) n += of_layout.samples;
  }
  return n;
}

KINECAL_INLINE int AnyProblem::shared_samples(int term) const {
  int n = 0;
  for (const auto& [layout, of_layout] : layouts_) {
    if (layout.terms.size() > 1 && detail::has_term(layout, term)) n += of_layout.samples;
  }
  return n;
}

KINECAL_INLINE void AnyProblem::check_no_samples() const {
  if (sources_.empty()) return;
  throw std::logic_error("sensors and error blocks are added before the samples");
}

KINECAL_INLINE std::vector<int> AnyProblem::sensors_of_block(
    const std::string& name, const std::vector<std::string>& sensors,
    std::span<const Quantity> quantities, std::size_t own) const {
  check_no_samples();
  std::vector<int> indices;
  for (const std::string& of_block : sensors) indices.push_back(sensor_index(of_block));
  if (indices.size() != quantities.size()) {
    throw std::invalid_argument("error block '" + name + "' takes " +
                                std::to_string(quantities.size()) + " sensors, not " +
                                std::to_string(indices.size()));
  }
  for (std::size_t i = 0; i < indices.size(); ++i) {
    const AnySensor& of_block = sensor(indices[i]).sensor();
    if (of_block.delivers(quantities[i])) continue;
    throw std::invalid_argument("error block '" + name + "': sensor '" + sensors[i] + "', a " +
                                std::string(of_block.type()) + ", does not deliver " +
                                std::string(to_string(quantities[i])));
  }
  for (const int s : indices) own += sensor(s).parameters().size();
  if (own > kMostOwn) {
    throw std::invalid_argument("error block '" + name +
                                "': its sensors and the block itself have " + std::to_string(own) +
                                " parameters; " + std::to_string(kMostOwn) + " are possible");
  }
  return indices;
}

KINECAL_INLINE int AnyProblem::sensor_index(const std::string& name) const {
  std::vector<std::string> names;
  for (std::size_t s = 0; s < sensors_.size(); ++s) {
    names.push_back(sensors_[s].mount().name);
    if (names.back() == name) return static_cast<int>(s);
  }
  throw std::invalid_argument("no sensor '" + name + "'" + did_you_mean(name, names));
}

/// Drops the observations that no term uses, so that they are not evaluated.
KINECAL_INLINE void AnyProblem::forget_unused(detail::SampleLayout& layout,
                                              detail::SampleNumbers& seen) const {
  std::vector<bool> used(sensors_.size(), false);
  for (const int t : layout.terms) {
    for (const int s : term(t).sensors()) used[static_cast<std::size_t>(s)] = true;
  }
  layout.chains.resize(sensors_.size());
  layout.misses_some.resize(sensors_.size());
  for (std::size_t s = 0; s < used.size(); ++s) {
    auto& of_sensor = seen.sensors[s];
    if (!used[s]) of_sensor.reset();
    if (!of_sensor) continue;
    layout.chains[s] = of_sensor->chain;
    layout.misses_some[s] = of_sensor->misses_some();
  }
}

}  // namespace kinecal
