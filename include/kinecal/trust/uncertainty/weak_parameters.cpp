// Finds poorly determined parameters.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/trust/uncertainty/weak_parameters.hpp"

#include <cmath>
#include <limits>
#include <numbers>

#include "kinecal/trust/uncertainty/reluctance.hpp"

namespace kinecal {

double useful_deviation(const Parameter& parameter) {
  if (parameter.unit == "rad") return 5.0 * std::numbers::pi / 180.0;
  if (parameter.unit == "m") return 0.02;
  if (parameter.unit == "1") return 0.05;
  if (parameter.name.ends_with("_z_quadratic")) return 0.05;  // of depth, at a metre
  return parameter.unit == "px" ? 20.0 : std::numeric_limits<double>::infinity();
}

WeakParameters weak_parameters(const AnyProblem& problem, const FreeSet& free,
                               const Uncertainty& known, const std::set<int>& beside) {
  WeakParameters weak;
  Eigen::MatrixXd covariance = known.covariance.matrix();
  const auto parameter = [&](int c) { return free.parameters()[static_cast<std::size_t>(c)]; };
  // With some parameters held; not NaN, and not undetermined.
  const auto times = [&](int c) {
    if (!std::isfinite(known.deviation(c)) || beside.contains(parameter(c))) return 0.0;
    return std::sqrt(std::max(0.0, covariance(c, c))) /
           useful_deviation(problem.table()[parameter(c)]);
  };
  for (int c = 0; c < free.size(); ++c) {
    if (times(c) > 1.0) weak.parameters.push_back(parameter(c));
  }
  for (std::size_t round = 0; round < weak.parameters.size(); ++round) {
    int worst = -1;
    for (int c = 0; c < free.size(); ++c) {
      if (!(times(c) > 1.0)) continue;
      const int more = worst < 0 ? -1
                                 : detail::reluctance(problem, parameter(c)) -
                                       detail::reluctance(problem, parameter(worst));
      if (more < 0 || (more == 0 && times(c) > times(worst))) worst = c;
    }
    if (worst < 0) break;
    weak.hold.push_back(parameter(worst));
    const Eigen::VectorXd column = covariance.col(worst);
    covariance -= column * column.transpose() / column(worst);
  }
  return weak;
}

}  // namespace kinecal
