// Definitions of any_problem.hpp: names, samples and shapes.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <set>
#include <span>
#include <sstream>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "kinecal/errors/plane_fit.hpp"
#include "kinecal/problem/any_problem.hpp"
#include "kinecal/problem/term.hpp"
#include "kinecal/samples/paired_features.hpp"
#include "kinecal/samples/sample.hpp"
#include "kinecal/text/nearest_name.hpp"

namespace kinecal {

namespace detail {

// What a problem refuses when parameters, frames, terms and samples are added.

/// @throws std::invalid_argument  if a number of a term cannot be used
inline void check_number(const std::string& whose, const char* what, double number, bool is_right,
                         const char* rule) {
  if (is_right) return;
  std::ostringstream message;
  message << whose << ": " << what << " is " << number << "; it must be " << rule;
  throw std::invalid_argument(message.str());
}

/// Checks scale, sigma and loss of an error block or prior.
inline void check_options(const std::string& whose, const TermOptions& options) {
  const double sigma = options.sigma.value_or(1.0), loss = options.loss.scale;
  check_number(whose, "scale", options.scale, std::isfinite(options.scale) && options.scale >= 0.0,
               "finite and not negative");
  check_number(whose, "sigma", sigma, std::isfinite(sigma) && sigma > 0.0, "positive");
  check_number(whose, "the scale of its loss", loss,
               options.loss.type == LossType::none || (std::isfinite(loss) && loss > 0.0),
               "positive");
}

/// Checks scales and means of a prior.
inline void check_prior(const std::string& whose, const Prior& prior) {
  for (const double scale : {prior.joint_scale, prior.position_scale, prior.rotation_scale}) {
    check_number(whose, "a scale", scale, std::isfinite(scale), "finite");
  }
  for (const double mean : prior.mean) {
    check_number(whose, "a mean", mean, std::isfinite(mean), "finite");
  }
}

/// Checks that each free frame is a joint, or has a parameter.
inline void check_frames(const Robot& robot, const ParameterTable& table,
                         const std::set<std::string>& frames) {
  for (const std::string& frame : frames) {
    const bool has_one = std::any_of(kFrameAxes.begin(), kFrameAxes.end(), [&](auto axis) {
      return table.find(parameter_name(frame, axis)) >= 0;
    });
    if (has_one || robot.has_joint(frame)) continue;
    std::vector<std::string> names;
    for (const Joint& joint : robot.joints()) names.push_back(joint.name);
    throw std::invalid_argument("free frame '" + frame +
                                "' is not a joint of the robot, and no parameter of it (" +
                                parameter_name(frame, kFrameAxes.front()) + " ... " +
                                parameter_name(frame, kFrameAxes.back()) + ") is in the table" +
                                did_you_mean(frame, names));
  }
}

/// Checks that a sample has one position of each joint and at most one observation of each sensor.
inline void check_lists(const Sample& sample) {
  const std::size_t names = sample.joint_names.size(), positions = sample.joint_positions.size();
  if (names != positions) {
    throw SampleError("it has " + std::to_string(names) + " joint names, but positions of " +
                      std::to_string(positions));
  }
  std::vector<std::string_view> sensors;
  for (const Observation& seen : sample.observations) sensors.push_back(seen.sensor);
  std::sort(sensors.begin(), sensors.end());
  const auto twice = std::adjacent_find(sensors.begin(), sensors.end());
  if (twice == sensors.end()) return;
  throw SampleError("it has two observations of sensor '" + std::string(*twice) + "'");
}

// Decides which terms apply to a sample.

/// The observation of each sensor of a problem in a sample.
using Observed = std::vector<std::optional<ObservationNumbers>>;

/// The observations of a term's sensors in a sample, in their order.
[[nodiscard]] inline std::vector<const ObservationNumbers*> observations_of(
    const Term& term, const Observed& observed) {
  std::vector<const ObservationNumbers*> seen;
  for (const int s : term.sensors) seen.push_back(&*observed[static_cast<std::size_t>(s)]);
  return seen;
}

/// 1 / sigma of each feature, 0 for one without a sigma; empty if no feature has one.  Variances of
/// several sensors add up.  A pixel block takes those of the camera, which are in pixels.
[[nodiscard]] inline std::vector<double> inverse_sigmas_of(const Term& term,
                                                           const Observed& observed) {
  const auto seen = observations_of(term, observed);
  const auto quantities = term.quantities;
  const bool of_pixels =
      std::find(quantities.begin(), quantities.end(), Quantity::pixel) != quantities.end();
  std::vector<double> variances;
  for (std::size_t s = 0; s < seen.size(); ++s) {
    const std::vector<double>& variance = seen[s]->variance;
    if (variance.empty() || (of_pixels && quantities[s] != Quantity::pixel)) continue;
    variances.resize(variance.size(), 0.0);
    for (std::size_t i = 0; i < variance.size(); ++i) variances[i] += variance[i];
  }
  for (double& variance : variances) {
    variance = variance > 0.0 ? 1.0 / std::sqrt(variance) : 0.0;
  }
  return variances;
}

/// Labels of the features that a term compares in a sample; empty if they are 0, 1, 2 ... without
/// ids.
/// @param features  the compared ones
/// @param recorded  the observation of its first sensor
/// @param paired    the same, after pairing
[[nodiscard]] inline std::vector<FeatureLabel> labels_of(const Term& term,
                                                         const std::vector<std::size_t>& features,
                                                         const Observation& recorded,
                                                         const Observation& paired) {
  std::vector<FeatureLabel> labels;
  if (!term.pairs_features()) return labels;  // they form one plane
  std::map<int, int> places;                  // place where each was recorded, by id
  for (std::size_t i = 0; &recorded != &paired && i < recorded.features.size(); ++i) {
    const std::optional<int>& id = recorded.features[i].id;
    if (id) places.emplace(*id, static_cast<int>(i));
  }
  bool plain = true;
  for (const std::size_t i : features) {
    const std::optional<int>& id = paired.features[i].id;
    const auto place = id ? places.find(*id) : places.end();
    labels.push_back({place != places.end() ? place->second : static_cast<int>(i), id});
    plain = plain && !id && i + 1 == labels.size();
  }
  if (plain) labels.clear();
  return labels;
}

/// The conditions that a term takes in a sample.
struct TermConditions {
  std::vector<double> values;  ///< in the order of the block: of each feature, or of the sample
  std::size_t step = 0;        ///< number of those of a feature; zero: they are the sample's
};

/// A condition of a sample: one of it, the measured position of a joint, or either in the sample before; NaN if it has
/// none of that name.
[[nodiscard]] inline double condition_of(const std::string& name, const Sample& sample) {
  constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
  if (name.starts_with(kBefore)) {
    const auto found = sample.before.find(name.substr(kBefore.size()));
    return found == sample.before.end() ? kUnknown : found->second;
  }
  const auto found = sample.conditions.find(name);
  return found == sample.conditions.end() ? sample.position(name).value_or(kUnknown)
                                          : found->second;
}

/// One condition of a feature: of the first sensor that has it there, else of the sample; NaN if neither has it.
[[nodiscard]] inline double condition_of(const std::string& name,
                                         const std::vector<const Observation*>& seen,
                                         const Sample& sample, std::size_t feature) {
  for (const Observation* of_sensor : seen) {
    const auto& own = of_sensor->features[feature].conditions;
    if (const auto found = own.find(name); found != own.end()) return found->second;
  }
  return condition_of(name, sample);
}

/// True if a block without a sensor should apply to a sample: it has one of the block's conditions, or joints suffice;
/// none of them is missing (not a number); and there is a sample before it if the block looks there.
[[nodiscard]] inline bool has_conditions(const Term& term, const Sample& sample) {
  const auto& names = term.conditions;
  const auto is_before = [](std::string_view name) { return name.starts_with(kBefore); };
  const auto is_missing = [&](std::string_view name) {
    const auto found = sample.conditions.find(std::string(name));
    return found != sample.conditions.end() && std::isnan(found->second);
  };
  if (std::any_of(names.begin(), names.end(), is_missing)) return false;
  if (sample.before.empty() && std::any_of(names.begin(), names.end(), is_before)) return false;
  return std::any_of(names.begin(), names.end(),
                     [&](auto name) { return sample.conditions.contains(std::string(name)); }) ||
         std::all_of(names.begin(), names.end(), [&](auto name) {
           return std::isfinite(condition_of(std::string(name), sample));
         });
}

/// The conditions that a term takes in a sample.
/// @param sample    its features paired
/// @param compared  the features that the term compares
[[nodiscard]] inline TermConditions conditions_of(const Term& term,
                                                  const std::vector<MountedSensor>& sensors,
                                                  const Sample& sample,
                                                  const std::vector<std::size_t>& compared) {
  TermConditions all;
  std::vector<const Observation*> seen;
  std::size_t features = 1;
  if (term.conditions.empty()) return all;
  if (term.pairs_features()) {
    const auto has_some = [](const Feature& feature) { return !feature.conditions.empty(); };
    for (const int s : term.sensors) {
      seen.push_back(sample.observation(sensors[static_cast<std::size_t>(s)].mount().name));
      const std::vector<Feature>& of_sensor = seen.back()->features;
      if (std::any_of(of_sensor.begin(), of_sensor.end(), has_some)) {
        all.step = term.conditions.size();
        features = of_sensor.size();
      }
    }
  }
  all.values.assign(features * term.conditions.size(), 0.0);
  for (const std::size_t i : all.step == 0 ? std::vector<std::size_t>{0} : compared) {
    for (std::size_t k = 0; k < term.conditions.size(); ++k) {
      const std::string name(term.conditions[k]);
      const double value = condition_of(name, seen, sample, i);
      all.values[i * all.step + k] = value;
      if (std::isfinite(value)) continue;
      std::set<std::string> names;
      for (const auto& [known, number] : sample.conditions) names.insert(known);
      for (const auto& [known, number] : sample.before) names.insert(std::string(kBefore) + known);
      if (seen.empty()) names.insert(sample.joint_names.begin(), sample.joint_names.end());
      for (const Observation* of_sensor : seen) {
        for (const auto& [known, number] : of_sensor->features[i].conditions) names.insert(known);
      }
      std::string whose = "the sample";
      if (all.step > 0) {
        whose = FeatureLabel{static_cast<int>(i), seen[0]->features[i].id}.text() + " or " + whose;
      }
      const std::vector<std::string> known(names.begin(), names.end());
      throw SampleError(
          "error block '" + term.name + "': condition '" + name + "' is not " +
          (names.contains(name) ? "a finite number" : "in " + whose + did_you_mean(name, known)));
    }
  }
  return all;
}

/// Why the features of a sensor in one sample do not determine a plane; empty if they do.
[[nodiscard]] inline std::string why_no_plane(const AnySensor& sensor,
                                              const ObservationNumbers& seen) {
  std::vector<Vector3<double>> points;
  for (std::size_t i = 0; i < seen.usable.size(); ++i) {
    if (seen.usable[i] == 0.0) continue;
    if (seen.chain[i] != seen.chain[0]) return "the points of a plane are in several frames";
    const double* measured = &seen.measured[3 * i];
    points.push_back(sensor.place({measured[0], measured[1], measured[2]}, seen.settings));
  }
  if (points.size() < 3) return "a plane takes three points or more";
  return PlaneFit<double>(points).determined() ? "" : "its points span no plane";
}

/// The features that a term compares in a sample: those that all of its sensors observed.  Empty if
/// the term does not apply; one entry for planes, and for a block without a sensor.
/// @throws SampleError  if it should apply, but cannot
[[nodiscard]] inline std::vector<std::size_t> compared_features(
    const Term& term, const std::vector<MountedSensor>& sensors, const Sample& sample,
    const Observed& observed) {
  const std::string& beside = term.options.beside;
  if (!beside.empty() && sample.observation(beside) == nullptr) return {};
  const auto observing = std::count_if(
      sample.observations.begin(), sample.observations.end(),
      [&](const Observation& o) { return !o.features.empty() && o.sensor != beside; });
  if (term.options.exclusive && observing != std::ssize(term.sensors)) return {};
  for (const int s : term.sensors) {
    if (!observed[static_cast<std::size_t>(s)]) return {};
  }
  if (term.sensors.empty() && !has_conditions(term, sample)) return {};
  const auto seen = observations_of(term, observed);
  const auto sensor = [&](std::size_t i) -> const MountedSensor& {
    return sensors[static_cast<std::size_t>(term.sensors[i])];
  };
  const auto name = [&](std::size_t i) { return sensor(i).mount().name; };
  for (std::size_t i = 1; i < seen.size() && term.pairs_features(); ++i) {
    if (seen[i]->usable.size() == seen[0]->usable.size()) continue;
    throw SampleError("error block '" + term.name + "': sensor '" + name(0) + "' has " +
                      std::to_string(seen[0]->usable.size()) + " features, sensor '" + name(i) +
                      "' has " + std::to_string(seen[i]->usable.size()) +
                      "; give them ids, so that they are paired by id, not by place");
  }
  for (std::size_t i = 0; i < seen.size(); ++i) {
    if (term.quantities[i] != Quantity::plane) continue;
    if (!seen[i]->variance.empty()) {
      throw SampleError("error block '" + term.name + "': a feature of sensor '" + name(i) +
                        "' has a sigma; all features together are one plane, so the sigma of the "
                        "block counts and features must have none");
    }
    if (const std::string why = why_no_plane(sensor(i).sensor(), *seen[i]); !why.empty()) {
      throw SampleError("error block '" + term.name + "': " + why);
    }
  }
  if (seen.empty() || !term.pairs_features()) return {0};
  std::vector<std::size_t> features;
  for (std::size_t i = 0; i < seen[0]->usable.size(); ++i) {
    const auto has_it = [i](const auto* of_sensor) { return of_sensor->usable[i] > 0.0; };
    if (std::all_of(seen.begin(), seen.end(), has_it)) features.push_back(i);
  }
  return features;
}

// The samples of a problem: added as rows of numbers, counted, and left out.

/// Features that terms compare in a sample, by index of the term.
using ComparedFeatures = std::map<int, std::vector<std::size_t>>;

/// Packs the inputs of the applicable terms.
/// @param sample  its features paired
[[nodiscard]] inline SampleRow row_of(const std::vector<Term>& terms,
                                      const std::vector<MountedSensor>& sensors,
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
    TermConditions conditions = conditions_of(term(t), sensors, sample, features);
    if (term(t).sensors.empty()) conditions.values.push_back(1.0);  // it is present
    row.add_term(t, inverse_sigmas_of(term(t), observed), conditions.values, conditions.step);
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
    row = detail::row_of(terms_, sensors_, compared, in_order ? *in_order : sample, observed);
  } catch (const SampleError& e) {
    throw SampleError(source + ": " + e.what());
  }
  AddedSample added{.source = source, .unused = detail::unused_of(sensors_, sample, observed)};
  for (const auto& [t, features] : compared) {
    added.residuals += static_cast<int>(features.size()) * term(t).feature_size;
    if (term(t).sensors.empty()) continue;
    const std::string& first = sensor(term(t).sensors.front()).mount().name;
    const Observation* recorded = sample.observation(first);
    auto labels = detail::labels_of(term(t), features, *recorded,
                                    in_order ? *in_order->observation(first) : *recorded);
    if (!labels.empty()) added.labels.emplace(t, std::move(labels));
  }
  Layouts::value_type& known =
      *layouts_.try_emplace(std::move(row.layout), LayoutUse{layouts_.size()}).first;
  auto& [layout, use] = known;
  add_to_batch(use.index, layout, row.numbers);
  added.layout = &known;
  added.fingerprint = detail::fingerprint_of(use.index, row.numbers);
  added.row = static_cast<std::size_t>(use.samples++);
  residuals_ += added.residuals;
  samples_.push_back(std::move(added));
  if (sample_poses_.empty()) return;
  std::vector<Pose<double>>& poses = poses_of_samples_.emplace_back();
  for (const std::string& joint : sample_poses_) {
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
      if (!sample_poses_.empty()) poses.push_back(poses_of_samples_[static_cast<std::size_t>(i)]);
    } else {
      residuals_ -= sample.residuals;
    }
  }
  samples_ = std::move(kept);
  poses_of_samples_ = std::move(poses);
  renumber_in_batches(numbers);
  for (auto& [layout, use] : layouts_) use.samples = 0;
  for (AddedSample& sample : samples_) {
    sample.row = static_cast<std::size_t>(layouts_.at(sample.layout->first).samples++);
  }
}

KINECAL_INLINE void AnyProblem::set_measurements(int sample, const Observation& seen) {
  const auto s = static_cast<std::size_t>(sensor_index(seen.sensor));
  AddedSample& changed = samples_[static_cast<std::size_t>(sample)];
  const auto& [layout, use] = *changed.layout;
  const auto require = [&](bool is_right, const std::string& what) {
    if (!is_right) {
      throw SampleError(changed.source + ": sensor '" + seen.sensor + "': " + what);
    }
  };
  require(layout.sensors[s].has_value(), "no error block compares what it observed");
  const detail::ObservationLayout& known = *layout.sensors[s];
  detail::ObservationNumbers numbers;
  try {
    numbers = sensors_[s].measurements(seen);
  } catch (const SampleError& e) {
    throw SampleError(changed.source + ": " + e.what());
  }
  require(numbers.chain == known.chain,
          "its measurements can be replaced by as many in the same frames only");
  const std::vector<double> before = row_in_batches(use.index, changed.row);
  std::vector<double> row = before;
  const auto set = [&](std::size_t offset, std::span<const double> values) {
    std::copy(values.begin(), values.end(), row.begin() + static_cast<std::ptrdiff_t>(offset));
  };
  set(known.settings, numbers.settings);
  set(known.measured, numbers.measured);
  for (std::size_t i = 0; i < numbers.usable.size(); ++i) {
    require(row[known.usable + i * known.usable_step] == numbers.usable[i],
            FeatureLabel{static_cast<int>(i), seen.features[i].id}.text() +
                (numbers.usable[i] > 0.0 ? " was not a number before" : " is not a number"));
  }
  for (const detail::TermLayout& of_term : layout.terms) {
    const Term& used = term(of_term.term);
    const bool is_its = std::find(used.sensors.begin(), used.sensors.end(), static_cast<int>(s)) !=
                        used.sensors.end();
    for (std::size_t i = 0; is_its && i < seen.features.size(); ++i) {
      for (std::size_t k = 0; k < used.conditions.size(); ++k) {
        const auto value = seen.features[i].conditions.find(std::string(used.conditions[k]));
        if (value == seen.features[i].conditions.end()) continue;
        require(of_term.conditions_step > 0, "its features had no conditions before");
        require(std::isfinite(value->second),
                "condition '" + value->first + "' is not a finite number");
        row[of_term.conditions + i * of_term.conditions_step + k] = value->second;
      }
    }
  }
  for (std::size_t offset = 0; offset < row.size(); ++offset) {
    if (row[offset] != before[offset]) set_in_batches(use.index, changed.row, offset, row[offset]);
  }
  changed.fingerprint = detail::fingerprint_of(use.index, row);
}

KINECAL_INLINE FeatureLabel AnyProblem::feature(int term, int sample, std::ptrdiff_t i) const {
  if (terms_[static_cast<std::size_t>(term)].quantities.empty()) return {-1};
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

// Finds the owner of each parameter in a problem's table, the parameters that priors restrict, and
// those that the samples affect.

/// Sets the owners for joints and frames; sensors and blocks set their own.
KINECAL_INLINE void AnyProblem::set_owners() {
  owners_.resize(static_cast<std::size_t>(table_.size()));
  for (const Joint& joint : robot_.joints()) {
    if (!moves(joint.type)) continue;
    set_owner(table_.find(joint.name), joint.name);
  }
  for (int p = 0; p < table_.size(); ++p) {
    const auto of = joint_model_parameter(robot_, table_[p].name);
    if (of && of->fault.empty()) set_owner(p, of->joint);
  }
  for (const std::string& frame : frames_) {
    for (const std::string_view axis : kFrameAxes) {
      set_owner(table_.find(parameter_name(frame, axis)), frame);
    }
  }
}

KINECAL_INLINE void AnyProblem::add_prior(const std::string& name, const Prior& prior,
                                          const TermOptions& options) {
  const std::string whose = "error block '" + name + "'";
  for (const PriorTerm& known : priors_) {
    if (known.name == name)
      throw std::invalid_argument("two priors have the name '" + name + "'; rename one of them");
  }
  detail::check_options(whose, options);
  detail::check_prior(whose, prior);
  const auto rows = prior.parameters(table_);
  if (std::all_of(rows.begin(), rows.end(), [](int parameter) { return parameter < 0; })) {
    std::vector<std::string> names(frames_.begin(), frames_.end());
    for (const Parameter& parameter : table_) names.push_back(parameter.name);
    throw std::invalid_argument("error block '" + name + "': param '" + prior.param +
                                "' is not a free joint, a free frame or a parameter" +
                                did_you_mean(prior.param, names));
  }
  for (std::size_t k = 0; k < rows.size(); ++k) {
    if (rows[k] >= 0 || prior.mean[k] == 0.0) continue;
    throw std::invalid_argument("error block '" + name + "': a " + std::string(kPriorMeans[k]) +
                                " is given, but '" + prior.param + "' has no such parameter");
  }
  priors_.push_back({name, prior, options});
  if (options.unit.empty()) priors_.back().options.unit = "1";
}

/// The own parameters of an error block; makes the block their owner.
KINECAL_INLINE std::vector<int> AnyProblem::parameters_of_block(
    const std::string& name, std::span<const ParameterInfo> infos) {
  std::vector<int> indices;
  for (const ParameterInfo& info : infos) {
    indices.push_back(table_.index(parameter_name(name, info.name)));
    std::string& owner = owners_[static_cast<std::size_t>(indices.back())];
    if (!owner.empty() && owner != name) {
      throw std::invalid_argument("error block '" + name + "': its parameter '" +
                                  parameter_name(name, info.name) + "' is also one of '" + owner +
                                  "'; rename the block");
    }
    owner = name;
  }
  return indices;
}

KINECAL_INLINE void AnyProblem::check(const FreeSet& free) const {
  if (free.table_size() != table_.size()) {
    throw std::invalid_argument("a free set of a table of " + std::to_string(free.table_size()) +
                                " parameters; the problem's has " + std::to_string(table_.size()));
  }
  for (const int parameter : free.parameters()) {
    if (!owners_[static_cast<std::size_t>(parameter)].empty()) continue;
    std::vector<std::string> names;
    for (const Joint& joint : robot_.joints()) {
      if (moves(joint.type)) names.push_back(joint.name);
    }
    for (int i = 0; i < table_.size(); ++i) {
      if (!owners_[static_cast<std::size_t>(i)].empty()) names.push_back(table_[i].name);
    }
    const std::string& name = table_[parameter].name;
    throw std::invalid_argument("free parameter '" + name +
                                "' belongs to no joint that moves, free frame, sensor "
                                "or error block" +
                                did_you_mean(name, names));
  }
}

namespace detail {

/// Adds the parameters of a sensor and of its chains to features.
inline void add_touched(const MountedSensor& sensor, const std::vector<std::size_t>& chains,
                        std::set<int>& touched) {
  touched.insert(sensor.parameters().begin(), sensor.parameters().end());
  for (const std::size_t c : chains) {
    for (const JointIndices& joint : sensor.chains()[c].parameters()) {
      touched.insert(joint.offset);
      touched.insert(joint.model.begin(), joint.model.end());
      touched.insert(joint.frame.begin(), joint.frame.end());
    }
  }
}

}  // namespace detail

KINECAL_INLINE std::vector<int> AnyProblem::touched_parameters(int term) const {
  std::set<int> touched;
  for (const auto& [layout, use] : layouts_) {
    if (use.samples == 0) continue;  // they were excluded
    for (const detail::TermLayout& place : layout.terms) {
      if (term >= 0 && place.term != term) continue;
      const Term& used = this->term(place.term);
      touched.insert(used.parameters.begin(), used.parameters.end());
      for (const int s : used.sensors) {
        detail::add_touched(sensor(s), layout.sensors[static_cast<std::size_t>(s)]->chain, touched);
      }
    }
  }
  touched.erase(-1);
  for (const std::string& joint : sample_poses_) {
    for (const auto axis : kFrameAxes) touched.erase(table_.find(parameter_name(joint, axis)));
  }
  return {touched.begin(), touched.end()};
}

KINECAL_INLINE AnyProblem::AnyProblem(Robot robot, std::string base, ParameterTable table,
                                      std::set<std::string> frames)
    : robot_(std::move(robot)),
      base_(std::move(base)),
      table_(std::move(table)),
      frames_(std::move(frames)) {
  base_ = make_chain(robot_, base_, base_).base;  // as the robot spells it
  for (const Parameter& parameter : table_) detail::check(parameter);
  detail::check_frames(robot_, table_, frames_);
  set_owners();
}

KINECAL_INLINE AnyProblem::AnyProblem(const AnyProblem& other, WithoutSamples)
    : robot_(other.robot_),
      base_(other.base_),
      table_(other.table_),
      frames_(other.frames_),
      owners_(other.owners_),
      sample_poses_(other.sample_poses_),
      sensors_(other.sensors_),
      terms_(other.terms_),
      priors_(other.priors_) {}

KINECAL_INLINE void AnyProblem::give_sample_poses(std::vector<std::string> joints) {
  check_no_samples();
  for (const std::string& joint : joints) {
    const bool floats = robot_.has_joint(joint) && robot_.joint(joint).type == JointType::floating;
    if (floats && frames_.contains(joint)) continue;
    throw std::invalid_argument("'" + joint + "' cannot have a pose in each sample: it is no " +
                                (floats ? "free frame" : "floating joint"));
  }
  sample_poses_ = std::move(joints);
}

KINECAL_INLINE void AnyProblem::set_sigma(int term, double sigma) {
  if (!(sigma > 0.0) || !std::isfinite(sigma)) {
    throw std::invalid_argument("error block '" + this->term(term).name + "': sigma is " +
                                std::to_string(sigma) + "; it must be positive");
  }
  Term& changed = terms_[static_cast<std::size_t>(term)];
  changed.sigma = sigma;
  changed.weight = changed.options.scale / sigma;
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
  set_owner(sensors_.back().lag(), mount.parameter_prefix());
}

KINECAL_INLINE void AnyProblem::check_no_samples() const {
  if (samples_.empty()) return;
  throw std::logic_error("sensors and error blocks are added before the samples");
}

KINECAL_INLINE void AnyProblem::add_term(Term term, const std::vector<std::string>& sensors,
                                         std::span<const ParameterInfo> own) {
  check_no_samples();
  const std::string block = "error block '" + term.name + "'";
  for (const Term& known : terms_) {
    if (known.name == term.name)
      throw std::invalid_argument("two error blocks have the name '" + term.name +
                                  "'; rename one of them");
  }
  detail::check_options(block, term.options);
  for (const std::string& name : sensors) term.sensors.push_back(sensor_index(name));
  if (sensors.size() != term.quantities.size()) {
    throw std::invalid_argument(block + " takes " + std::to_string(term.quantities.size()) +
                                " sensors, not " + std::to_string(sensors.size()));
  }
  std::size_t parameters = own.size();
  for (std::size_t i = 0; i < sensors.size(); ++i) {
    const AnySensor& of_block = sensor(term.sensors[i]).sensor();
    parameters += of_block.parameters().size();
    if (of_block.delivers(term.quantities[i])) continue;
    throw std::invalid_argument(block + ": sensor '" + sensors[i] + "', a " +
                                std::string(of_block.type()) + ", does not deliver " +
                                std::string(to_string(term.quantities[i])));
  }
  if (parameters > kMostOwn) {
    throw std::invalid_argument(block + ": its sensors and the block itself have " +
                                std::to_string(parameters) + " parameters; " +
                                std::to_string(kMostOwn) + " are possible");
  }
  term.parameters = parameters_of_block(term.name, own);
  terms_.push_back(std::move(term));
  set_sigma(num_terms() - 1, terms_.back().options.sigma.value_or(1.0));
}

KINECAL_INLINE int AnyProblem::sensor_index(const std::string& name) const {
  std::vector<std::string> names;
  for (std::size_t s = 0; s < sensors_.size(); ++s) {
    names.push_back(sensors_[s].mount().name);
    if (names.back() == name) return static_cast<int>(s);
  }
  throw std::invalid_argument("no sensor '" + name + "'" + did_you_mean(name, names));
}

}  // namespace kinecal
