// What each parameter of a problem's table belongs to, and names that belong to nothing.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdexcept>

#include "kinecal/crate/any_problem.hpp"

namespace kinecal {

KINECAL_INLINE void AnyProblem::check(const FreeSet& free) const {
  if (free.table_size() != table_.size()) {
    throw std::invalid_argument("a free set of a table of " + std::to_string(free.table_size()) +
                                " parameters; the problem's has " + std::to_string(table_.size()));
  }
  const std::vector<std::string> owner = owners();
  for (const int parameter : free.parameters()) {
    if (!owner[static_cast<std::size_t>(parameter)].empty()) continue;
    std::vector<std::string> names;
    for (const Joint& joint : robot_.joints()) {
      if (moves(joint.type)) names.push_back(joint.name);
    }
    for (int i = 0; i < table_.size(); ++i) {
      if (!owner[static_cast<std::size_t>(i)].empty()) names.push_back(table_[i].name);
    }
    const std::string& name = table_[parameter].name;
    throw std::invalid_argument("free parameter '" + name +
                                "' belongs to no joint that moves, free frame or sensor" +
                                did_you_mean(name, names));
  }
}

KINECAL_INLINE std::vector<std::string> AnyProblem::owners() const {
  std::vector<std::string> owners(static_cast<std::size_t>(table_.size()));
  const auto belongs = [&](int parameter, const std::string& owner) {
    if (parameter >= 0) owners[static_cast<std::size_t>(parameter)] = owner;
  };
  for (const Joint& joint : robot_.joints()) {
    if (moves(joint.type)) belongs(table_.find(joint.name), joint.name);
  }
  for (const std::string& frame : frames_) {
    for (const std::string_view axis : kFrameAxes) {
      belongs(table_.find(parameter_name(frame, axis)), frame);
    }
  }
  for (const SensorModel& sensor : sensors_) {
    for (const int parameter : sensor.camera_parameters()) {
      belongs(parameter, sensor.sensor().parameter_prefix());
    }
  }
  return owners;
}

}  // namespace kinecal
