// A term of the cost that depends on parameters only: a prior with its weight and loss.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>

#include "kinecal/errors/prior.hpp"
#include "kinecal/problem/any_term.hpp"

namespace kinecal {

/// A prior with its weight and loss.
struct PriorTerm {
  std::string name;     ///< of the prior, for reports
  Prior prior;          ///< which parameters should stay small
  TermOptions options;  ///< weight, loss, names

  /// Its unweighted residuals; they count once for each sample.
  /// @param values  of all parameters of the table
  /// @param free    the columns of the Jacobian; nullptr: residuals only
  void evaluate(const ParameterTable& table, std::span<const double> values, const FreeSet* free,
                TermResiduals& out) const {
    out.resize(Prior::kRows, free != nullptr ? free->size() : -1);
    const auto parameters = prior.parameters(table);
    const auto scales = prior.scales();
    for (std::size_t row = 0; row < parameters.size(); ++row) {
      if (parameters[row] < 0) continue;
      const auto r = static_cast<Eigen::Index>(row);
      out.residual(r) =
          scales[row] * (values[static_cast<std::size_t>(parameters[row])] - prior.mean[row]);
      const int column = free != nullptr ? free->column(parameters[row]) : -1;
      if (column >= 0) out.jacobian(r, column) = scales[row];
    }
  }
};

}  // namespace kinecal
