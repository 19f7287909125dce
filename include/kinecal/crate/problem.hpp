// A calibration problem: a robot's sensors, its samples, and the terms of the cost.
//
// Everything is resolved by name when it is added; evaluating it takes only numbers.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "kinecal/crate/block_term.hpp"
#include "kinecal/crate/prior_term.hpp"

namespace kinecal {

/// @tparam S  in which it is evaluated: a packet, or double for one sample at a time
template <class S>
class BasicProblem {
 public:
  /// @param base    the link in which sensors are compared
  /// @param frames  names of the free frames, joints of the robot or virtual
  /// @throws RobotError  if the link does not exist
  BasicProblem(Robot robot, std::string base, ParameterTable table, std::set<std::string> frames)
      : robot_(std::move(robot)),
        base_(std::move(base)),
        table_(std::move(table)),
        frames_(std::move(frames)) {
    (void)robot_.parent_joint(base_);
  }

  /// @param walks  along its chains, if they are compiled
  /// @throws RobotError  if there is no chain from the base to the sensor
  /// @throws std::logic_error  if samples have been added: they would not know of it
  void add_sensor(const Sensor& sensor, std::vector<CompiledWalk<S>> walks = {}) {
    check_no_samples();
    sensors_.emplace_back(robot_, base_, sensor, table_, frames_);
    walks_.push_back(std::move(walks));
  }

  /// Adds an error block between sensors, which are added before.
  /// @tparam Expected  KnownSizes of its two bodies, where the compiler knows them
  /// @throws std::invalid_argument  if a sensor does not exist, or their number or kind is wrong
  /// @throws std::logic_error       if samples have been added: they would not know of it
  template <class Expected = void, ErrorBlock B>
  void add_block(const std::string& name, const B& block, const std::vector<std::string>& sensors,
                 const TermOptions& options = {}) {
    check_no_samples();
    std::vector<int> indices;
    for (const std::string& sensor : sensors) indices.push_back(sensor_index(sensor));
    if (static_cast<int>(indices.size()) != kSensors<B>) {
      throw std::invalid_argument("error block '" + name + "' takes " +
                                  std::to_string(kSensors<B>) + " sensors, not " +
                                  std::to_string(indices.size()));
    }
    for (std::size_t i = 0; i < indices.size(); ++i) {
      const bool is_pinhole = model(indices[i]).sensor().type == SensorType::camera2d;
      if (is_pinhole != (SightBlock<B> && i == 1)) {
        throw std::invalid_argument(
            "error block '" + name + "': sensor '" + sensors[i] + "' " +
            (is_pinhole ? "sees pixels, a point is needed" : "sees points, a camera2d is needed"));
      }
    }
    terms_.push_back(
        std::make_unique<BlockTerm<B, S, Expected>>(name, block, std::move(indices), options));
  }

  /// Adds a prior; it counts once for each sample.
  void add_prior(const std::string& name, const Prior& prior, const TermOptions& options = {}) {
    priors_.push_back({name, prior, options});
  }

  /// Adds a sample, after the sensors and blocks.
  /// @throws SampleError  naming the sample and what is missing or wrong in it; it is not added
  void add_sample(const Sample& sample) {
    Observations seen(sensors_.size());
    SampleShape shape;
    try {
      for (std::size_t s = 0; s < sensors_.size(); ++s) {
        const Observation* observation = sample.observation(sensors_[s].sensor().name);
        if (observation == nullptr || observation->features.empty()) continue;
        seen[s] = sensors_[s].pack(sample, *observation);
      }
      for (std::size_t t = 0; t < terms_.size(); ++t) {
        if (applies(*terms_[t], sample, seen)) shape.terms.push_back(static_cast<int>(t));
      }
    } catch (const SampleError& e) {
      throw SampleError(sample.source + ": " + e.what());
    }
    for (const int t : shape.terms) residuals_ += residuals_of(*terms_[std::size_t(t)], seen);
    forget_unused(shape, seen);
    add_to_packs(std::move(shape), seen);
    sources_.push_back(sample.source);
  }

  [[nodiscard]] const ParameterTable& table() const { return table_; }
  [[nodiscard]] const std::vector<SensorModel>& sensors() const { return sensors_; }
  /// Compiled walks of each sensor.
  [[nodiscard]] const std::vector<std::vector<CompiledWalk<S>>>& walks() const { return walks_; }
  [[nodiscard]] const std::vector<std::unique_ptr<Term<S>>>& terms() const { return terms_; }
  [[nodiscard]] const std::vector<PriorTerm>& priors() const { return priors_; }
  [[nodiscard]] int num_samples() const { return static_cast<int>(sources_.size()); }
  /// Where a sample came from.
  [[nodiscard]] const std::string& source(int sample) const {
    return sources_[static_cast<std::size_t>(sample)];
  }
  [[nodiscard]] std::span<const PackedSample<S>> packs() const { return packs_; }
  /// Number of residuals of all features, and of each prior once.
  [[nodiscard]] int num_residuals() const {
    return residuals_ + static_cast<int>(priors_.size()) * Prior::kRows;
  }

  /// Number of samples to which a term applies.
  [[nodiscard]] int samples_of(int term) const {
    int n = 0;
    for (const PackedSample<S>& pack : packs_) {
      if (has_term(pack, term)) n += static_cast<int>(pack.samples.size());
    }
    return n;
  }

  /// Number of samples of a term in which another term, of other sensors too, applies as well.
  [[nodiscard]] int shared_samples(int term) const {
    int n = 0;
    for (const PackedSample<S>& pack : packs_) {
      const bool shared = pack.shape->terms.size() > 1 && has_term(pack, term);
      if (shared) n += static_cast<int>(pack.samples.size());
    }
    return n;
  }

  /// Table indices of the parameters on which some residual of the samples depends, in their order.
  [[nodiscard]] std::vector<int> touched_parameters() const {
    std::set<int> touched;
    for (const auto& [shape, open] : shapes_) {
      for (const int term : shape.terms) {
        for (const int s : terms_[static_cast<std::size_t>(term)]->sensors()) {
          add_touched(s, *shape.chains[static_cast<std::size_t>(s)], touched);
        }
      }
    }
    touched.erase(-1);
    return {touched.begin(), touched.end()};
  }

 private:
  using Observations = std::vector<std::optional<PackedObservation<double>>>;  ///< by each sensor

  void check_no_samples() const {
    if (sources_.empty()) return;
    throw std::logic_error("sensors and error blocks are added before the samples");
  }

  [[nodiscard]] const SensorModel& model(int s) const {
    return sensors_[static_cast<std::size_t>(s)];
  }

  [[nodiscard]] int sensor_index(const std::string& name) const {
    std::vector<std::string> names;
    for (std::size_t s = 0; s < sensors_.size(); ++s) {
      names.push_back(sensors_[s].sensor().name);
      if (names.back() == name) return static_cast<int>(s);
    }
    throw std::invalid_argument("no sensor '" + name + "'" + did_you_mean(name, names));
  }

  [[nodiscard]] static bool has_term(const PackedSample<S>& pack, int term) {
    const std::vector<int>& terms = pack.shape->terms;
    return std::find(terms.begin(), terms.end(), term) != terms.end();
  }

  [[nodiscard]] static std::vector<const PackedObservation<double>*> observations_of(
      const Term<S>& term, const Observations& observed) {
    std::vector<const PackedObservation<double>*> seen;
    for (const int s : term.sensors()) seen.push_back(&*observed[static_cast<std::size_t>(s)]);
    return seen;
  }

  [[nodiscard]] static int residuals_of(const Term<S>& term, const Observations& observed) {
    return term.count(observations_of(term, observed)) * term.feature_size();
  }

  [[nodiscard]] bool applies(const Term<S>& term, const Sample& sample,
                             const Observations& observed) const {
    const auto observing = std::count_if(sample.observations.begin(), sample.observations.end(),
                                         [](const Observation& o) { return !o.features.empty(); });
    if (term.options().alone && observing != std::ssize(term.sensors())) return false;
    for (const int s : term.sensors()) {
      if (!observed[static_cast<std::size_t>(s)]) return false;
    }
    const auto seen = observations_of(term, observed);
    if (term.pairs_features() && seen[0]->usable.size() != seen[1]->usable.size()) {
      throw SampleError("error block '" + term.name() + "': sensor '" +
                        model(term.sensors()[0]).sensor().name + "' has " +
                        std::to_string(seen[0]->usable.size()) + " features, sensor '" +
                        model(term.sensors()[1]).sensor().name + "' has " +
                        std::to_string(seen[1]->usable.size()));
    }
    if (const std::string why = term.why_not(seen); !why.empty()) {
      throw SampleError("error block '" + term.name() + "': " + why);
    }
    return term.count(seen) > 0;
  }

  /// What no term looks at needs no evaluation.
  void forget_unused(SampleShape& shape, Observations& seen) const {
    std::vector<bool> used(sensors_.size(), false);
    for (const int t : shape.terms) {
      for (const int s : terms_[static_cast<std::size_t>(t)]->sensors()) {
        used[static_cast<std::size_t>(s)] = true;
      }
    }
    shape.chains.resize(sensors_.size());
    for (std::size_t s = 0; s < used.size(); ++s) {
      if (!used[s]) seen[s].reset();
      if (seen[s]) shape.chains[s] = seen[s]->chain;
    }
  }

  void add_to_packs(SampleShape shape, const Observations& seen) {
    const auto [known, is_new] = shapes_.try_emplace(std::move(shape), packs_.size());
    auto& [of_samples, open] = *known;
    if (!is_new && add_to_pack(packs_[open], num_samples(), seen)) return;
    open = packs_.size();
    packs_.push_back(make_pack<S>(of_samples, num_samples(), seen));
  }

  /// @param chains  of the features that the sensor observed
  void add_touched(int s, const std::vector<std::size_t>& chains, std::set<int>& touched) const {
    const SensorModel& sensor = model(s);
    touched.insert(sensor.camera_parameters().begin(), sensor.camera_parameters().end());
    for (const std::size_t c : chains) {
      for (const JointIndices& joint : sensor.parameters()[c]) {
        touched.insert(joint.offset);
        touched.insert(joint.frame.begin(), joint.frame.end());
      }
    }
  }

  Robot robot_;
  std::string base_;
  ParameterTable table_;
  std::set<std::string> frames_;
  std::vector<SensorModel> sensors_;
  std::vector<std::vector<CompiledWalk<S>>> walks_;  ///< of each sensor
  std::vector<std::unique_ptr<Term<S>>> terms_;
  std::vector<PriorTerm> priors_;
  int residuals_ = 0;                          ///< of all features
  std::vector<std::string> sources_;           ///< of each sample
  std::map<SampleShape, std::size_t> shapes_;  ///< and the pack of each that is not full
  std::vector<PackedSample<S>> packs_;
};

/// A problem evaluated in packets of the instruction set compiled for.
using Problem = BasicProblem<Packet>;

}  // namespace kinecal
