// Definitions of any_problem.hpp: names, samples and shapes.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "kinecal/problem/added_samples.ipp"
#include "kinecal/problem/any_problem.hpp"
#include "kinecal/problem/input_checks.ipp"
#include "kinecal/problem/parameter_owners.ipp"

namespace kinecal {

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
      own_poses_(other.own_poses_),
      sensors_(other.sensors_),
      terms_(other.terms_),
      priors_(other.priors_) {}

KINECAL_INLINE void AnyProblem::give_own_poses(std::vector<std::string> joints) {
  check_no_samples();
  for (const std::string& joint : joints) {
    const bool floats = robot_.has_joint(joint) && robot_.joint(joint).type == JointType::floating;
    if (floats && frames_.contains(joint)) continue;
    throw std::invalid_argument("'" + joint + "' cannot have a pose in each sample: it is no " +
                                (floats ? "free frame" : "floating joint"));
  }
  own_poses_ = std::move(joints);
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
