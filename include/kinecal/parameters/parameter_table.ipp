// Definitions of parameter_table.hpp.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "kinecal/parameters/parameter_table.hpp"
#include "kinecal/text/nearest_name.hpp"

namespace kinecal {

KINECAL_INLINE void detail::check(const Parameter& parameter) {
  const auto [name, unit, initial, value, lower, upper] = parameter;
  const std::string whose = "parameter '" + name + "'";
  if (!std::isfinite(initial) || !std::isfinite(value)) {
    throw std::invalid_argument(whose + ": its value is not a finite number");
  }
  if (std::isnan(lower) || std::isnan(upper)) {
    throw std::invalid_argument(whose + ": a bound is not a number");
  }
  if (lower > upper) {
    std::ostringstream message;
    message << whose << ": its lower bound " << lower << " is above its upper bound " << upper;
    throw std::invalid_argument(message.str());
  }
}

KINECAL_INLINE int ParameterTable::add(const Parameter& parameter) {
  detail::check(parameter);
  const int index = size();
  if (!indices_.emplace(parameter.name, index).second) {
    throw std::invalid_argument("parameter '" + parameter.name + "' occurs twice");
  }
  parameters_.push_back(parameter);
  return index;
}

KINECAL_INLINE int ParameterTable::find(const std::string& name) const {
  const auto it = indices_.find(name);
  return it == indices_.end() ? -1 : it->second;
}

KINECAL_INLINE int ParameterTable::index(const std::string& name) const {
  const int found = find(name);
  if (found >= 0) return found;
  std::vector<std::string> names;
  for (const auto& [known, i] : indices_) names.push_back(known);
  throw std::invalid_argument("no parameter '" + name + "'" + did_you_mean(name, names));
}

KINECAL_INLINE void add_parameters(ParameterTable& table, std::string_view owner,
                                   std::span<const ParameterInfo> infos) {
  for (const ParameterInfo& info : infos) {
    const std::string name = parameter_name(owner, info.name);
    if (table.find(name) >= 0) continue;
    table.add({.name = name,
               .unit = std::string(info.unit),
               .initial = info.initial,
               .value = info.initial,
               .lower = info.lower,
               .upper = info.upper});
  }
}

KINECAL_INLINE FreeSet::FreeSet(std::vector<int> parameters, int table_size)
    : parameters_(std::move(parameters)), columns_(static_cast<std::size_t>(table_size), -1) {
  for (std::size_t c = 0; c < parameters_.size(); ++c) {
    const int parameter = parameters_[c];
    if (parameter < 0 || parameter >= table_size) {
      throw std::invalid_argument("a free set has parameter " + std::to_string(parameter) +
                                  " of a table of " + std::to_string(table_size));
    }
    int& column = columns_[static_cast<std::size_t>(parameter)];
    if (column >= 0) {
      throw std::invalid_argument("a free set has parameter " + std::to_string(parameter) +
                                  " twice");
    }
    column = static_cast<int>(c);
  }
}

}  // namespace kinecal
