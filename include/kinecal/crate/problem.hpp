// A calibration problem: a robot's sensors, its samples, and the terms of the cost.
//
// Everything is resolved by name when it is added; evaluating it takes only numbers.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "kinecal/crate/block_term.hpp"
#include "kinecal/crate/prior_term.hpp"

namespace kinecal {

/// A residual that is not defined: which, where.
struct UndefinedResidual {
  std::string term, source;  ///< name of the error block, place of the sample
};

class Problem {
 public:
  /// @param base    the link in which sensors are compared
  /// @param frames  names of the free frames, joints of the robot or virtual
  /// @throws RobotError  if the link does not exist
  Problem(Robot robot, std::string base, ParameterTable table, std::set<std::string> frames)
      : robot_(std::move(robot)),
        base_(std::move(base)),
        table_(std::move(table)),
        frames_(std::move(frames)) {
    (void)robot_.parent_joint(base_);
  }

  /// @throws RobotError  if there is no chain from the base to the sensor
  /// @throws std::logic_error  if samples have been added: they would not know of it
  void add_sensor(const Sensor& sensor) {
    check_no_samples();
    sensors_.emplace_back(robot_, base_, sensor, table_, frames_);
  }

  /// Adds an error block between sensors, which are added before.
  /// @throws std::invalid_argument  if a sensor does not exist, or their number or kind is wrong
  /// @throws std::logic_error       if samples have been added: they would not know of it
  template <ErrorBlock B>
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
    terms_.push_back(std::make_unique<BlockTerm<B>>(name, block, std::move(indices), options));
  }

  /// Adds a prior; it counts once for each sample.
  void add_prior(const std::string& name, const Prior& prior, const TermOptions& options = {}) {
    priors_.push_back({name, prior, options});
  }

  /// Adds a sample, after the sensors and blocks.
  /// @throws SampleError  naming the sample and what is missing or wrong in it; it is not added
  void add_sample(const Sample& sample) {
    PackedSample packed{
        sample.source, std::vector<std::optional<PackedObservation>>(sensors_.size()), {}};
    try {
      for (std::size_t s = 0; s < sensors_.size(); ++s) {
        const Observation* seen = sample.observation(sensors_[s].sensor().name);
        if (seen == nullptr || seen->features.empty()) continue;
        packed.seen[s] = sensors_[s].pack(sample, *seen);
      }
      for (std::size_t t = 0; t < terms_.size(); ++t) {
        if (applies(*terms_[t], sample, packed)) packed.terms.push_back(static_cast<int>(t));
      }
    } catch (const SampleError& e) {
      throw SampleError(sample.source + ": " + e.what());
    }
    forget_unused(packed);
    samples_.push_back(std::move(packed));
  }

  [[nodiscard]] const ParameterTable& table() const { return table_; }
  [[nodiscard]] const std::vector<SensorModel>& sensors() const { return sensors_; }
  [[nodiscard]] const std::vector<std::unique_ptr<Term>>& terms() const { return terms_; }
  [[nodiscard]] const std::vector<PriorTerm>& priors() const { return priors_; }
  [[nodiscard]] int num_samples() const { return static_cast<int>(samples_.size()); }

  /// Number of samples to which a term applies.
  [[nodiscard]] int samples_of(int term) const {
    int n = 0;
    for (const PackedSample& sample : samples_) {
      n += static_cast<int>(std::count(sample.terms.begin(), sample.terms.end(), term));
    }
    return n;
  }

  /// Number of samples of a term in which another term, of other sensors too, applies as well.
  [[nodiscard]] int shared_samples(int term) const {
    return static_cast<int>(
        std::count_if(samples_.begin(), samples_.end(), [&](const PackedSample& sample) {
          return sample.terms.size() > 1 &&
                 std::count(sample.terms.begin(), sample.terms.end(), term) > 0;
        }));
  }

  /// Table indices of the parameters on which some residual of the samples depends, in their order.
  [[nodiscard]] std::vector<int> touched_parameters() const {
    std::set<int> touched;
    for (const PackedSample& sample : samples_) {
      for (int term : sample.terms) {
        for (int s : terms_[static_cast<std::size_t>(term)]->sensors()) {
          add_touched(s, *sample.seen[static_cast<std::size_t>(s)], touched);
        }
      }
    }
    touched.erase(-1);
    return {touched.begin(), touched.end()};
  }

  /// Evaluates all residuals, sample by sample.
  /// @param values  of all parameters of the table
  /// @param free    the Jacobian's columns; nullptr: residuals only
  /// @param visit   callable (int term, int sample, const TermResiduals&)
  /// @param at      where derivatives are taken
  /// @returns       the first residual that is not defined, if any; the rest is not evaluated
  template <class Visit>
  [[nodiscard]] std::optional<UndefinedResidual> evaluate(
      std::span<const double> values, const FreeSet* free, Visit&& visit,
      Linearization at = Linearization::measured) const {
    std::vector<SensorState> states;
    for (const SensorModel& sensor : sensors_) states.emplace_back(sensor, values, free);
    std::vector<SensorView> views(sensors_.size());
    std::vector<const SensorView*> of_term;
    TermResiduals residuals;
    for (std::size_t n = 0; n < samples_.size(); ++n) {
      const PackedSample& sample = samples_[n];
      for (std::size_t s = 0; s < sensors_.size(); ++s) {
        if (sample.seen[s]) views[s].update(sensors_[s], states[s], *sample.seen[s]);
      }
      for (int t : sample.terms) {
        const Term& term = *terms_[static_cast<std::size_t>(t)];
        of_term.clear();
        for (int s : term.sensors()) of_term.push_back(&views[static_cast<std::size_t>(s)]);
        if (!term.evaluate(of_term, free != nullptr ? free->size() : -1, at, residuals)) {
          return UndefinedResidual{term.name(), sample.source};
        }
        visit(t, static_cast<int>(n), std::as_const(residuals));
      }
    }
    return std::nullopt;
  }

 private:
  struct PackedSample {
    std::string source;
    std::vector<std::optional<PackedObservation>> seen;  ///< by each sensor
    std::vector<int> terms;                              ///< that apply
  };

  void check_no_samples() const {
    if (samples_.empty()) return;
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

  [[nodiscard]] bool applies(const Term& term, const Sample& sample,
                             const PackedSample& packed) const {
    const auto observing = std::count_if(sample.observations.begin(), sample.observations.end(),
                                         [](const Observation& o) { return !o.features.empty(); });
    if (term.options().alone && observing != std::ssize(term.sensors())) return false;
    std::vector<const PackedObservation*> seen;
    for (int s : term.sensors()) {
      const auto& observation = packed.seen[static_cast<std::size_t>(s)];
      if (!observation) return false;
      seen.push_back(&*observation);
    }
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
  void forget_unused(PackedSample& packed) const {
    std::vector<bool> used(sensors_.size(), false);
    for (const int t : packed.terms) {
      for (const int s : terms_[static_cast<std::size_t>(t)]->sensors()) {
        used[static_cast<std::size_t>(s)] = true;
      }
    }
    for (std::size_t s = 0; s < used.size(); ++s) {
      if (!used[s]) packed.seen[s].reset();
    }
  }

  void add_touched(int s, const PackedObservation& seen, std::set<int>& touched) const {
    const SensorModel& sensor = model(s);
    touched.insert(sensor.camera_parameters().begin(), sensor.camera_parameters().end());
    for (std::size_t c = 0; c < seen.motions.size(); ++c) {
      if (!seen.motions[c]) continue;
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
  std::vector<std::unique_ptr<Term>> terms_;
  std::vector<PriorTerm> priors_;
  std::vector<PackedSample> samples_;
};

}  // namespace kinecal
