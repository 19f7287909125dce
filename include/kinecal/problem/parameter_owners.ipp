// Finds the owner of each parameter in a problem's table, the parameters that priors restrict, and
// those that the samples affect.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <stdexcept>
#include <string>
#include <vector>

#include "kinecal/problem/any_problem.hpp"
#include "kinecal/problem/input_checks.ipp"

namespace kinecal {

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

KINECAL_INLINE std::vector<int> AnyProblem::touched_parameters() const {
  std::set<int> touched;
  for (const auto& [layout, use] : layouts_) {
    if (use.samples == 0) continue;  // they were excluded
    for (const detail::TermLayout& place : layout.terms) {
      const Term& used = term(place.term);
      touched.insert(used.parameters.begin(), used.parameters.end());
      for (const int s : used.sensors) {
        detail::add_touched(sensor(s), layout.sensors[static_cast<std::size_t>(s)]->chain, touched);
      }
    }
  }
  touched.erase(-1);
  for (const std::string& joint : own_poses_) {
    for (const auto axis : kFrameAxes) touched.erase(table_.find(parameter_name(joint, axis)));
  }
  return {touched.begin(), touched.end()};
}

}  // namespace kinecal
