// The parameters of a calibration, found by name, and which of them are free in a step.
//
// A parameter's index is its place in the table and never changes.  A free set gives some
// parameters a column of the Jacobian; the others are held at their value.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <map>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "kinecal/kinematics/nearest_name.hpp"
#include "kinecal/parameters/parameter.hpp"

namespace kinecal {

/// All parameters of a calibration, in the order in which they were added.
class ParameterTable {
 public:
  /// Adds a parameter.
  /// @returns  its index
  /// @throws std::invalid_argument  if the table has the name already
  int add(const Parameter& parameter) {
    const int index = size();
    if (!indices_.emplace(parameter.name, index).second) {
      throw std::invalid_argument("parameter '" + parameter.name + "' occurs twice");
    }
    parameters_.push_back(parameter);
    return index;
  }

  /// Number of parameters.
  [[nodiscard]] int size() const { return static_cast<int>(parameters_.size()); }

  /// Index of a parameter; -1 if the table does not have it.
  [[nodiscard]] int find(const std::string& name) const {
    const auto it = indices_.find(name);
    return it == indices_.end() ? -1 : it->second;
  }

  /// Index of a parameter.
  /// @throws std::invalid_argument  if the table does not have it, with the nearest name
  [[nodiscard]] int index(const std::string& name) const {
    const int found = find(name);
    if (found >= 0) return found;
    std::vector<std::string> names;
    for (const auto& [known, i] : indices_) names.push_back(known);
    throw std::invalid_argument("no parameter '" + name + "'" + did_you_mean(name, names));
  }

  /// A parameter by index or by name.
  /// @throws std::invalid_argument  if the table does not have the name, with the nearest name
  /// @{
  [[nodiscard]] Parameter& operator[](int i) { return parameters_[static_cast<std::size_t>(i)]; }
  [[nodiscard]] const Parameter& operator[](int i) const {
    return parameters_[static_cast<std::size_t>(i)];
  }
  [[nodiscard]] Parameter& operator[](const std::string& name) { return (*this)[index(name)]; }
  [[nodiscard]] const Parameter& operator[](const std::string& name) const {
    return (*this)[index(name)];
  }
  /// @}

  [[nodiscard]] auto begin() const { return parameters_.begin(); }  ///< first parameter
  [[nodiscard]] auto end() const { return parameters_.end(); }      ///< behind the last one

  /// (size) current values.
  [[nodiscard]] Eigen::VectorXd values() const {
    Eigen::VectorXd all(size());
    for (int i = 0; i < size(); ++i) all(i) = (*this)[i].value;
    return all;
  }

 private:
  std::vector<Parameter> parameters_;
  std::map<std::string, int> indices_;
};

/// Adds the parameters that a sensor or error block declares, as far as a table does not have them.
inline void add_parameters(ParameterTable& table, std::string_view owner,
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

/// Which parameters are free: the columns of the Jacobian.
class FreeSet {
 public:
  /// @param parameters  indices in the table, in the order of the columns
  /// @param table_size  number of parameters in the table
  /// @throws std::invalid_argument  if the table has no parameter with an index, or it occurs twice
  FreeSet(std::vector<int> parameters, int table_size)
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

  /// Number of columns.
  [[nodiscard]] int size() const { return static_cast<int>(parameters_.size()); }
  /// Number of parameters in the table.
  [[nodiscard]] int table_size() const { return static_cast<int>(columns_.size()); }
  /// Table index of the parameter of each column.
  [[nodiscard]] const std::vector<int>& parameters() const { return parameters_; }

  /// Column of a parameter; -1 if it is held, or if the index is -1.
  [[nodiscard]] int column(int parameter) const {
    return parameter < 0 ? -1 : columns_[static_cast<std::size_t>(parameter)];
  }

 private:
  std::vector<int> parameters_;
  std::vector<int> columns_;
};

}  // namespace kinecal
