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

namespace detail {
namespace {

/// Positions of joints in a sample, in units of repeatability.
/// @param joints  their names and repeatability
[[nodiscard]] Eigen::VectorXd positions_of(const Sample& sample,
                                           const std::map<std::string, double>& joints) {
  constexpr double kMissing = 1e9;  // a joint that is missing is far away from all others
  Eigen::VectorXd at(std::ssize(joints));
  Eigen::Index i = 0;
  for (const auto& [name, repeats] : joints) {
    const auto position = sample.position(name);
    at(i++) = position && std::isfinite(*position) ? *position / repeats : kMissing;
  }
  return at;
}

/// Halves poses at the median of the joint that moves most, `depth` times.
void halve(const std::vector<Eigen::VectorXd>& at, std::span<int> poses, int depth, int region,
           std::vector<int>& regions) {
  if (depth == 0) {
    for (const int p : poses) regions[static_cast<std::size_t>(p)] = region;
    return;
  }
  Eigen::VectorXd mean = Eigen::VectorXd::Zero(at.front().size()), squares = mean;
  for (const int p : poses) {
    const Eigen::VectorXd& q = at[static_cast<std::size_t>(p)];
    mean += q / static_cast<double>(poses.size());
  }
  for (const int p : poses) squares += (at[static_cast<std::size_t>(p)] - mean).cwiseAbs2();
  Eigen::Index most = 0;
  (void)squares.maxCoeff(&most);
  std::stable_sort(poses.begin(), poses.end(), [&](int a, int b) {
    return at[static_cast<std::size_t>(a)](most) < at[static_cast<std::size_t>(b)](most);
  });
  const std::size_t half = poses.size() / 2;
  halve(at, poses.first(half), depth - 1, 2 * region, regions);
  halve(at, poses.subspan(half), depth - 1, 2 * region + 1, regions);
}

}  // namespace
}  // namespace detail

PoseGroups each_its_own(std::size_t samples) {
  PoseGroups groups{std::vector<int>(samples), static_cast<int>(samples)};
  std::iota(groups.of_sample.begin(), groups.of_sample.end(), 0);
  return groups;
}

namespace detail {
namespace {

/// @param joints  not empty
[[nodiscard]] PoseGroups groups_of(const std::map<std::string, double>& joints,
                                   std::span<const Sample> samples) {
  struct Pose {
    Eigen::VectorXd at;  // positions in units of repeatability
    int number;
  };
  std::multimap<double, Pose> poses;  // by the first joint's position
  PoseGroups groups;
  for (const Sample& sample : samples) {
    const Eigen::VectorXd at = positions_of(sample, joints);
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
  return groups;
}

}  // namespace
}  // namespace detail

PoseGroups pose_groups(const AnyProblem& problem, std::span<const Sample> samples) {
  const std::map<std::string, double> joints = detail::repeatable_joints(problem);
  if (joints.empty()) return each_its_own(samples.size());
  PoseGroups groups = detail::groups_of(joints, samples);
  return groups.count < 2 ? each_its_own(samples.size()) : groups;
}

bool are_one_pose(const AnyProblem& problem, std::span<const Sample> samples) {
  const std::map<std::string, double> joints = detail::repeatable_joints(problem);
  return !joints.empty() && samples.size() > 1 && detail::groups_of(joints, samples).count == 1;
}

std::vector<int> pose_regions(const AnyProblem& problem, std::span<const Sample> samples,
                              const PoseGroups& poses) {
  constexpr int kFew = 20, kDepth = 2;
  const std::map<std::string, double> joints = detail::repeatable_joints(problem);
  if (joints.empty() || poses.count < kFew) return {};
  std::vector<Eigen::VectorXd> at(static_cast<std::size_t>(poses.count));
  for (std::size_t s = 0; s < samples.size(); ++s) {
    Eigen::VectorXd& of = at[static_cast<std::size_t>(poses.of_sample[s])];
    if (of.size() == 0) of = detail::positions_of(samples[s], joints);
  }
  std::vector<int> order(at.size()), regions(at.size());
  std::iota(order.begin(), order.end(), 0);
  detail::halve(at, order, kDepth, 0, regions);
  std::vector<int> of_sample;
  for (const int pose : poses.of_sample) {
    of_sample.push_back(regions[static_cast<std::size_t>(pose)]);
  }
  return of_sample;
}

}  // namespace kinecal
