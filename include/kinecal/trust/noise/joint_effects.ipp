// What residuals change by if joints stop elsewhere than they say.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <map>
#include <span>
#include <string>

#include "kinecal/trust/noise/sample_slopes.hpp"

namespace kinecal::detail {

/// Names of the joints that move a sensor or target of the problem, and how well robots repeat them:
/// 1 mrad, 0.2 mm.
[[nodiscard]] inline std::map<std::string, double> repeatable_joints(const AnyProblem& problem) {
  constexpr double kRadians = 1e-3, kMetres = 2e-4;
  std::map<std::string, double> joints;
  for (const MountedSensor& sensor : problem.sensors()) {
    for (const SampledChain& chain : sensor.chains()) {
      for (const ChainJoint& joint : chain.chain().joints) {
        const std::vector<std::string>& own = problem.sample_poses();
        const bool is_own = std::find(own.begin(), own.end(), joint.floating) != own.end();
        if (joint.type == JointType::fixed || is_own) continue;
        joints[joint.drive.joint] = turns(joint.type) ? kRadians : kMetres;
      }
    }
  }
  return joints;
}

/// Change of weighted residuals if each of these joints is off by what robots repeat, to first order.
/// @param values   of all parameters of the table
/// @param samples  those of the problem, in their order
/// @param fit      the rows of these samples
/// @returns  (rows x joints); zero for a joint that makes a residual undefined
[[nodiscard]] inline Eigen::MatrixXd joint_effects(const AnyProblem& problem,
                                                   ParameterValues values,
                                                   std::span<const Sample> samples,
                                                   const FreeSet& free, const LinearFit& fit) {
  const std::map<std::string, double> joints = repeatable_joints(problem);
  Eigen::MatrixXd effects = Eigen::MatrixXd::Zero(fit.residual.size(), std::ssize(joints));
  Eigen::Index column = 0;
  for (const auto& joint : joints) {
    const std::string& name =
        joint.first;  // lambdas of C++20 capture no structured bindings in clang 14
    const double repeats = joint.second;
    constexpr double kStep = 1e-3;  // of what robots repeat
    const auto move = [&](Sample& sample) { sample.add_to_position(name, kStep * repeats); };
    effects.col(column) = sample_slopes({problem, free, fit, values, samples}, move, kStep);
    ++column;
  }
  return effects;
}

}  // namespace kinecal::detail
