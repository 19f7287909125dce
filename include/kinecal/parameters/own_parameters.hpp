// The parameters of a sensor or an error block during an evaluation.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "kinecal/parameters/parameter_table.hpp"

namespace kinecal {

/// A sensor's or an error block's own parameters: their values, and which are free.
struct OwnParameters {
  std::vector<double> values;  ///< of all of them
  std::vector<int> free;       ///< which are free
  std::vector<int> columns;    ///< their columns of the Jacobian

  /// @param parameters  table indices; -1 for one that the table does not have
  OwnParameters(const std::vector<int>& parameters, const FreeSet& set)
      : values(parameters.size(), 0.0) {
    for (std::size_t i = 0; i < parameters.size(); ++i) {
      const int column = set.column(parameters[i]);
      if (column < 0) continue;
      free.push_back(static_cast<int>(i));
      columns.push_back(column);
    }
  }

  /// Takes over new values.
  /// @param all  of all parameters of the table
  void set(const std::vector<int>& parameters, std::span<const double> all) {
    for (std::size_t i = 0; i < parameters.size(); ++i) {
      if (parameters[i] >= 0) values[i] = all[static_cast<std::size_t>(parameters[i])];
    }
  }
};

}  // namespace kinecal
