// The samples of a problem: added as rows of numbers, counted, and left out.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <map>
#include <span>

#include "kinecal/problem/any_problem.hpp"
#include "kinecal/problem/input_checks.ipp"
#include "kinecal/problem/term_applies.ipp"
#include "kinecal/samples/paired_features.hpp"

namespace kinecal {

namespace detail {

/// Features that terms compare in a sample, by index of the term.
using ComparedFeatures = std::map<int, std::vector<std::size_t>>;

/// Packs the inputs of the applicable terms.
[[nodiscard]] inline SampleRow row_of(const std::vector<Term>& terms,
                                      const ComparedFeatures& compared, const Sample& sample,
                                      const Observed& observed) {
  const auto term = [&](int t) -> const Term& { return terms[static_cast<std::size_t>(t)]; };
  std::vector<bool> used(observed.size(), false);  // the others are not evaluated
  for (const auto& [t, features] : compared) {
    for (const int s : term(t).sensors) used[static_cast<std::size_t>(s)] = true;
  }
  SampleRow row;
  for (std::size_t s = 0; s < used.size(); ++s) row.add_sensor(used[s] ? &*observed[s] : nullptr);
  for (const auto& [t, features] : compared) {
    row.add_term(t, precisions_of(term(t), observed), conditions_of(term(t), sample));
  }
  return row;
}

/// What of a sample no term uses.
[[nodiscard]] inline UnusedInput unused_of(const std::vector<MountedSensor>& sensors,
                                           const Sample& sample, const Observed& observed) {
  UnusedInput unused;
  const auto is_name = [](const std::string& name) {
    return [&](const MountedSensor& sensor) { return sensor.mount().name == name; };
  };
  for (const Observation& seen : sample.observations) {
    if (std::none_of(sensors.begin(), sensors.end(), is_name(seen.sensor))) {
      unused.others.push_back(seen.sensor);
    }
  }
  for (std::size_t s = 0; s < sensors.size(); ++s) {
    const std::string& name = sensors[s].mount().name;
    if (!observed[s]) {
      unused.absent.push_back(name);
    } else if (std::count(observed[s]->usable.begin(), observed[s]->usable.end(), 0.0) > 0) {
      unused.not_numbers.push_back(name);
    }
  }
  return unused;
}

/// A hash of numbers, rounded to 1e-6.  Source: Fowler, Noll, Vo, FNV-1a.
[[nodiscard]] inline std::uint64_t fingerprint_of(std::size_t layout,
                                                  std::span<const double> numbers) {
  constexpr std::uint64_t kOffset = 0xcbf29ce484222325, kPrime = 0x100000001b3;
  std::uint64_t hash = (kOffset ^ layout) * kPrime;
  for (const double number : numbers) {
    const double rounded = std::round(1e6 * number) + 0.0;  // no -0
    hash = (hash ^ std::bit_cast<std::uint64_t>(rounded)) * kPrime;
    hash ^= hash >> 32;
  }
  return hash;
}

}  // namespace detail

KINECAL_INLINE std::optional<Sample> AnyProblem::paired(const Sample& sample) const {
  if (!has_ids(sample)) return std::nullopt;
  std::vector<ComparedSensors> blocks;
  for (const Term& term : terms_) {
    ComparedSensors& block = blocks.emplace_back();
    for (const int s : term.sensors) block.names.push_back(sensor(s).mount().name);
    block.paired = term.pairs_features();
  }
  return pair_features(sample, blocks);
}

KINECAL_INLINE void AnyProblem::add_sample(const Sample& sample) {
  std::optional<Sample> in_order;
  detail::Observed observed(sensors_.size());
  detail::ComparedFeatures compared;
  detail::SampleRow row;
  const std::string source =
      sample.source.empty() ? "sample " + std::to_string(num_samples()) : sample.source;
  try {
    detail::check_lists(sample);
    in_order = paired(sample);
    for (std::size_t s = 0; s < sensors_.size(); ++s) {
      const Observation* observation =
          (in_order ? *in_order : sample).observation(sensors_[s].mount().name);
      if (observation == nullptr || observation->features.empty()) continue;
      observed[s] = sensors_[s].numbers(sample, *observation);
    }
    for (int t = 0; t < num_terms(); ++t) {
      auto features = detail::compared_features(term(t), sensors_, sample, observed);
      if (!features.empty()) compared.emplace(t, std::move(features));
    }
    row = detail::row_of(terms_, compared, sample, observed);
  } catch (const SampleError& e) {
    throw SampleError(source + ": " + e.what());
  }
  AddedSample added{.source = source, .unused = detail::unused_of(sensors_, sample, observed)};
  for (const auto& [t, features] : compared) {
    added.residuals += static_cast<int>(features.size()) * term(t).feature_size;
    const std::string& first = sensor(term(t).sensors.front()).mount().name;
    const Observation* recorded = sample.observation(first);
    auto labels = detail::labels_of(term(t), features, *recorded,
                                    in_order ? *in_order->observation(first) : *recorded);
    if (!labels.empty()) added.labels.emplace(t, std::move(labels));
  }
  auto& [layout, use] =
      *layouts_.try_emplace(std::move(row.layout), LayoutUse{layouts_.size()}).first;
  add_to_batch(use.index, layout, row.numbers);
  added.fingerprint = detail::fingerprint_of(use.index, row.numbers);
  ++use.samples;
  residuals_ += added.residuals;
  samples_.push_back(std::move(added));
  if (own_poses_.empty()) return;
  std::vector<Pose<double>>& poses = poses_of_samples_.emplace_back();
  for (const std::string& joint : own_poses_) {
    const auto pose = sample.poses.find(joint);
    poses.push_back(pose == sample.poses.end() ? Pose<double>{} : pose->second);
  }
}

KINECAL_INLINE void AnyProblem::exclude(const std::set<int>& samples) {
  std::vector<AddedSample> kept;
  std::vector<std::vector<Pose<double>>> poses;
  std::vector<int> numbers;  // the new one of each sample
  for (int i = 0; i < num_samples(); ++i) {
    const bool stays = !samples.contains(i);
    numbers.push_back(stays ? static_cast<int>(kept.size()) : -1);
    AddedSample& sample = samples_[static_cast<std::size_t>(i)];
    if (stays) {
      kept.push_back(std::move(sample));
      if (!own_poses_.empty()) poses.push_back(poses_of_samples_[static_cast<std::size_t>(i)]);
    } else {
      residuals_ -= sample.residuals;
    }
  }
  samples_ = std::move(kept);
  poses_of_samples_ = std::move(poses);
  const std::vector<int> left = renumber_in_batches(numbers);
  for (auto& [layout, use] : layouts_) use.samples = left[use.index];
}

KINECAL_INLINE FeatureLabel AnyProblem::feature(int term, int sample, std::ptrdiff_t i) const {
  const auto& all = samples_[static_cast<std::size_t>(sample)].labels;
  const auto labels = all.find(term);
  if (labels == all.end()) return {static_cast<int>(i)};
  return labels->second.at(static_cast<std::size_t>(i));
}

KINECAL_INLINE int AnyProblem::samples_of(int term, std::size_t terms) const {
  int n = 0;
  for (const auto& [layout, use] : layouts_) {
    const auto& places = layout.terms;
    const auto is_its = [&](const detail::TermLayout& place) { return place.term == term; };
    const bool applies = std::any_of(places.begin(), places.end(), is_its);
    if (applies && places.size() >= terms) n += use.samples;
  }
  return n;
}

}  // namespace kinecal
