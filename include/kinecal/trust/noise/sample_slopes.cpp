// Definitions of sample_slopes.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/trust/noise/sample_slopes.hpp"

#include <memory>
#include <stdexcept>

namespace kinecal::detail {

Eigen::VectorXd sample_slopes(const FittedSamples& fitted, const std::function<void(Sample&)>& move,
                              double step) {
  const auto& [problem, free, fit, values, samples] = fitted;
  const std::unique_ptr<AnyProblem> moved = problem.without_samples();
  try {
    for (Sample sample : samples) {
      move(sample);
      moved->add_sample(sample);
    }
    moved->set_poses_of_samples(problem.poses_of_samples());
    const auto evaluator = moved->evaluator(free, 1);
    const LinearFit there = linear_fit(*evaluator, values, fit.coordinates, false);
    if (there.residual.size() == fit.residual.size()) {
      const Eigen::VectorXd slopes = (there.residual - fit.residual) / step;
      if (slopes.allFinite()) return slopes;
    }
  } catch (const SampleError&) {
  } catch (const std::domain_error&) {  // a point behind a camera
  }
  return Eigen::VectorXd::Zero(fit.residual.size());
}

}  // namespace kinecal::detail
