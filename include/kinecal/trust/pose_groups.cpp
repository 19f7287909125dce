// Grouping samples by pose.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/trust/pose_groups.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <string>

#include "kinecal/trust/joint_effects.ipp"

namespace kinecal {

PoseGroups each_its_own(std::size_t samples) {
  PoseGroups groups{std::vector<int>(samples), static_cast<int>(samples)};
  std::iota(groups.of_sample.begin(), groups.of_sample.end(), 0);
  return groups;
}

PoseGroups pose_groups(const AnyProblem& problem, std::span<const Sample> samples) {
  const std::map<std::string, double> joints = detail::repeatable_joints(problem);
  if (joints.empty()) return each_its_own(samples.size());
  constexpr double kMissing = 1e9;  // a joint that is missing is far away from all others
  struct Pose {
    Eigen::VectorXd at;  // positions in units of repeatability
    int number;
  };
  std::multimap<double, Pose> poses;  // by the first joint's position
  PoseGroups groups;
  for (const Sample& sample : samples) {
    Eigen::VectorXd at(std::ssize(joints));
    Eigen::Index i = 0;
    for (const auto& [name, repeats] : joints) {
      const auto position = sample.position(name);
      at(i++) = position && std::isfinite(*position) ? *position / repeats : kMissing;
    }
    const auto end = poses.upper_bound(at(0) + 1.0);
    const auto known = std::find_if(poses.lower_bound(at(0) - 1.0), end, [&](const auto& pose) {
      return (pose.second.at - at).template lpNorm<Eigen::Infinity>() <= 1.0;
    });
    if (known != end) {
      groups.of_sample.push_back(known->second.number);
    } else {
      groups.of_sample.push_back(groups.count);
      poses.emplace(at(0), Pose{at, groups.count++});
    }
  }
  if (groups.count < 2) return each_its_own(samples.size());
  return groups;
}

}  // namespace kinecal
