// Errors that are tried: their columns beside those of a fit, and how they are said.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <numbers>
#include <string>
#include <vector>

#include "kinecal/text/reading.hpp"
#include "kinecal/trust/added_columns.ipp"
#include "kinecal/trust/systematic_error.hpp"

namespace kinecal::detail {

/// Sums over the rows of some residuals r.
struct ResidualSums {
  double squares = 0.0;                     ///< r^T W r
  Eigen::MatrixXd of_slopes;                ///< (samples x slopes) d^T W r
  std::vector<Eigen::VectorXd> of_courses;  ///< (coordinates) sum of u J^T W r, of each course
};

/// An error that is tried.
struct Trial {
  SystematicError error;  ///< owner and course
  AddedColumns columns;
  std::function<Eigen::VectorXd(const ResidualSums&)> gradient;  ///< X^T W r
  /// Sets size and text, without the noise that is left; false if it is beyond what the linearization can say, or one bad
  /// capture.
  std::function<bool(const Fall&, SystematicError&)> say;
};

/// "0.57 deg" or "1.2 mm"
[[nodiscard]] inline std::string amount(double size, bool turns) {
  return turns ? reading(size * 180.0 / std::numbers::pi, "1") + " deg"
               : reading(1e3 * size, "1") + " mm";
}

/// "12 %"
[[nodiscard]] inline std::string percent(double part) {
  return reading(1e2 * part, "1") + " %";
}

}  // namespace kinecal::detail
