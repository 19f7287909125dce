// Derivatives of residuals by what samples say: joint positions, measured coordinates.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>

#include "kinecal/solve/linear_fit.hpp"

namespace kinecal::detail {

/// A fit and the samples that it is of.
struct FittedSamples {
  const AnyProblem& problem;
  const FreeSet& free;
  const LinearFit& fit;
  std::span<const double> values;
  std::span<const Sample> samples;

  /// (rows) derivatives of the weighted residuals; empty if some are undefined.
  /// @param move  adds a step to a sample
  [[nodiscard]] Eigen::VectorXd slopes(
      const std::function<void(Sample& sample, double step)>& move) const {
    constexpr double kStep = 1e-6;  // radians, metres, or relative
    const std::unique_ptr<AnyProblem> moved = problem.without_samples();
    try {
      for (Sample sample : samples) {
        move(sample, kStep);
        moved->add_sample(sample);
      }
      const auto evaluator = moved->evaluator(free);
      const LinearFit there = linear_fit(*evaluator, values, fit.coordinates, false);
      if (there.residual.size() != fit.residual.size()) return {};
      const Eigen::VectorXd slope = (there.residual - fit.residual) / kStep;
      if (slope.allFinite()) return slope;
    } catch (const SampleError&) {
    } catch (const std::domain_error&) {
    }
    return {};
  }
  /// By the position of a joint.
  [[nodiscard]] Eigen::VectorXd by_joint(const std::string& joint) const {
    return slopes([&](Sample& sample, double step) {
      for (std::size_t j = 0; j < sample.joint_names.size(); ++j) {
        if (sample.joint_names[j] == joint) sample.joint_positions[j] += step;
      }
    });
  }
  /// By the length of an axis of a sensor, relative.
  [[nodiscard]] Eigen::VectorXd by_axis(const std::string& sensor, int axis) const {
    return slopes([&](Sample& sample, double step) {
      for (Observation& seen : sample.observations) {
        if (seen.sensor != sensor) continue;
        for (Feature& feature : seen.features) feature.point(axis) *= 1.0 + step;
      }
    });
  }
};

}  // namespace kinecal::detail
