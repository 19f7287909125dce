// Definitions of term.hpp.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/problem/term.hpp"

namespace kinecal {

KINECAL_INLINE void PriorTerm::evaluate(const ParameterTable& table, ParameterValues values,
                                        const FreeSet* free, TermResiduals& out) const {
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

}  // namespace kinecal
