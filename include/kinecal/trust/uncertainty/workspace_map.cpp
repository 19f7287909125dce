// Computes the map of the workspace.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/trust/uncertainty/workspace_map.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <string>

#include "kinecal/trust/uncertainty/tip_derivative.ipp"

namespace kinecal {

namespace detail {
namespace {

/// Element i of the Halton sequence to a prime base: in [0, 1).
[[nodiscard]] double halton(int i, int base) {
  double number = 0.0, digit = 1.0;
  for (; i > 0; i /= base) {
    digit /= base;
    number += digit * (i % base);
  }
  return number;
}

/// The range in which a joint is moved.
[[nodiscard]] JointLimits moved_range(const Joint& joint) {
  const double most = turns(joint.type) ? std::numbers::pi : 1.0;
  const JointLimits limits = joint.limits.value_or(JointLimits{-most, most});
  JointLimits range{std::max(limits.lower, -most), std::min(limits.upper, most)};
  if (!(range.lower < range.upper)) range.lower = range.upper = 0.5 * (limits.lower + limits.upper);
  return range;
}

/// Joint positions spread evenly over the limits of the joints that drive chains.
[[nodiscard]] std::vector<Sample> spread_poses(const Robot& robot,
                                               std::initializer_list<const RuntimeChain*> chains,
                                               int poses) {
  std::map<std::string, JointLimits> ranges;
  for (const RuntimeChain* chain : chains) {
    for (const ChainJoint& joint : chain->joints) {
      if (!moves(joint.type)) continue;
      ranges[joint.drive.joint] = moved_range(robot.joint(joint.drive.joint));
    }
  }
  std::vector<Sample> all(static_cast<std::size_t>(poses));
  int prime = 1;
  for (const auto& [joint, range] : ranges) {
    const auto is_prime = [](int n) {
      for (int d = 2; d * d <= n; ++d) {
        if (n % d == 0) return false;
      }
      return true;
    };
    do {
      ++prime;
    } while (!is_prime(prime));
    constexpr int kFirst = 20;  // numbers before it are alike for large primes
    for (int i = 0; i < poses; ++i) {
      Sample& sample = all[static_cast<std::size_t>(i)];
      sample.joint_names.push_back(joint);
      sample.joint_positions.push_back(range.lower +
                                       halton(kFirst + i, prime) * (range.upper - range.lower));
    }
  }
  return all;
}

}  // namespace
}  // namespace detail

std::vector<KnownPoint> workspace_map(const AnyProblem& problem, const Assessment& step,
                                      const PoseUncertainty& pose, ParameterValues values,
                                      int poses) {
  if (step.parameters.empty()) return {};
  const auto floats = [](const RuntimeChain& chain) {
    return std::any_of(chain.joints.begin(), chain.joints.end(),
                       [](const ChainJoint& joint) { return !joint.floating.empty(); });
  };
  const auto chain_to = [&](const std::string& link, const std::string& frame) {
    RuntimeChain chain = make_chain(problem.robot(), problem.base(), link, problem.frames());
    return frame == link ? chain : with_virtual_frame(std::move(chain), frame);
  };
  const RuntimeChain to_frame = chain_to(pose.link, pose.frame),
                     to_in = chain_to(pose.in_link, pose.in);
  if (floats(to_frame) || floats(to_in)) return {};  // where it gets to is unknown
  const FreeSet free(step.parameters, problem.table().size());
  detail::TipDerivative of_frame(problem, free, values, to_frame),
      of_in(problem, free, values, to_in);
  const Eigen::MatrixXd covariance = step.uncertainty.covariance.matrix();
  const bool frame_moves = std::any_of(to_frame.joints.begin(), to_frame.joints.end(),
                                       [](const ChainJoint& joint) { return moves(joint.type); });
  std::vector<KnownPoint> map;
  for (const Sample& sample : detail::spread_poses(problem.robot(), {&to_frame, &to_in}, poses)) {
    const Vector3<double> p_base = of_frame.tip(sample);
    const auto position = [&](detail::TipDerivative& of) {
      return Eigen::MatrixXd(of.at(sample, p_base).topRows<3>());
    };
    const Eigen::MatrixXd jacobian = position(of_frame) - position(of_in);
    const Vector3<double> place = frame_moves ? p_base : of_in.tip(sample);
    const double variance = (jacobian * covariance).cwiseProduct(jacobian).sum();
    map.push_back({{place.x(), place.y(), place.z()}, std::sqrt(std::max(0.0, variance))});
  }
  return map;
}

}  // namespace kinecal
