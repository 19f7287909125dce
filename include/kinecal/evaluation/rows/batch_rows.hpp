// Residuals of one term in a batch of samples, lane by lane.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "kinecal/evaluation/rows/feature_rows.hpp"

namespace kinecal::detail {

/// Residuals of one term in a batch of samples, and their derivatives.
template <class S>
struct BatchRows {
  std::vector<S> present;   ///< of each feature: one, or zero where it is missing
  std::vector<S> factor;    ///< of each feature: see TermResiduals; empty: all are one
  std::vector<S> residual;  ///< of each feature, unweighted
  std::vector<S> jacobian;  ///< of each feature, column-major; values after the last one are stale

  /// The rows of one lane; skips features that are missing in it.
  /// @param columns  of the whole Jacobian; negative: residuals only
  void unpack(std::span<const FeatureRun> runs, int feature_size, int lane_index, int columns,
              TermResiduals& out) const {
    Eigen::Index count = 0;
    for (const S& is : present) count += lane(is, lane_index) > 0.0 ? 1 : 0;
    out.resize(count * feature_size, columns);
    Eigen::Index row = 0;
    const auto size = static_cast<std::size_t>(feature_size);
    std::size_t value = 0;
    for (const FeatureRun& run : runs) {
      for (std::size_t feature = run.first; feature < run.end; ++feature) {
        const bool there = lane(present[feature], lane_index) > 0.0;
        for (int m = 0; there && m < feature_size; ++m) {
          out.residual(row + m) = lane(residual[feature * size + std::size_t(m)], lane_index);
          if (!factor.empty()) out.factor(row + m) = lane(factor[feature], lane_index);
        }
        if (columns >= 0) {
          for (const int column : run.columns) {
            for (int m = 0; m < feature_size; ++m) {
              const double derivative = lane(jacobian[value++], lane_index);
              if (there) out.jacobian(row + m, column) += derivative;
            }
          }
        }
        if (there) row += feature_size;
      }
    }
  }
};

}  // namespace kinecal::detail
