// The parameters of a calibration, found by name, and which of them are free in a step.
//
// A parameter's index is its place in the table and never changes.  A free set gives some
// parameters a column of the Jacobian; the others are held at their value.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "kinecal/geometry/eigen_layout.hpp"
#include "kinecal/parameters/parameter.hpp"
#include "kinecal/parameters/parameter_values.hpp"

namespace kinecal {

/// All parameters of a calibration, in the order in which they were added.
class ParameterTable {
 public:
  /// Adds a parameter.
  /// @returns  its index
  /// @throws std::invalid_argument  if the table already has the name, or a number of the parameter
  ///                                cannot be used
  int add(const Parameter& parameter);

  /// Number of parameters.
  [[nodiscard]] int size() const { return static_cast<int>(parameters_.size()); }

  /// Index of a parameter; -1 if the table does not have it.
  [[nodiscard]] int find(const std::string& name) const;

  /// Index of a parameter.
  /// @throws std::invalid_argument  if the table does not have it, with the nearest name
  [[nodiscard]] int index(const std::string& name) const;

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
  [[nodiscard]] auto end() const { return parameters_.end(); }      ///< past the last one

  /// (size) current values.  Inline, because Eigen allocates differently for other instruction
  /// sets.
  [[nodiscard]] Eigen::VectorXd values() const {
    Eigen::VectorXd all(size());
    for (int i = 0; i < size(); ++i) all(i) = (*this)[i].value;
    return all;
  }

 private:
  std::vector<Parameter> parameters_;
  std::map<std::string, int> indices_;
};

namespace detail {
/// @throws std::invalid_argument  if a value is not finite, or the bounds exclude all values
void check(const Parameter& parameter);
}  // namespace detail

/// Adds the parameters that a sensor or error block declares, unless the table already has them.
void add_parameters(ParameterTable& table, std::string_view owner,
                    std::span<const ParameterInfo> infos);

/// Which parameters are free: the columns of the Jacobian.
class FreeSet {
 public:
  /// @param parameters  indices in the table, in the order of the columns
  /// @param table_size  number of parameters in the table
  /// @throws std::invalid_argument  if an index is not in the table, or occurs twice
  FreeSet(std::vector<int> parameters, int table_size);

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

#ifdef KINECAL_HEADER_ONLY
#include "kinecal/parameters/parameter_table.ipp"
#endif
