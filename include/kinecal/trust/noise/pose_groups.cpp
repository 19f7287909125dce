// Grouping samples by pose.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/trust/noise/pose_groups.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <string>
#include <utility>

#include "kinecal/samples/joint_moves.hpp"
#include "kinecal/trust/noise/joint_effects.ipp"

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

/// The same of a pose.
/// @param turn, shift  within which poses are the same, radians and metres
[[nodiscard]] Eigen::VectorXd positions_of(const Pose<double>& pose, double turn, double shift) {
  Eigen::VectorXd at(12);
  at << pose.rotation.reshaped() / turn, pose.translation / shift;
  return at;
}

void append(const Eigen::VectorXd& more, Eigen::VectorXd& at) {
  at.conservativeResize(at.size() + more.size());
  at.tail(more.size()) = more;
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

/// Where everything is that moves in the samples, in units within which it is the same; no rows: nothing moves.
/// @returns  (coordinates x samples)
[[nodiscard]] Eigen::MatrixXd places_of(const AnyProblem& problem,
                                        std::span<const Sample> samples) {
  constexpr double kSeen = 0.01;  // rad, and parts of the distance, of a target that nobody moved
  const std::map<std::string, double> joints = repeatable_joints(problem);
  const auto& own = problem.poses_of_samples();
  double distance = 0.0;  // mean, of targets
  for (const auto& poses : own) {
    for (const Pose<double>& pose : poses) {
      distance += pose.translation.norm() / static_cast<double>(own.size() * poses.size());
    }
  }
  Eigen::MatrixXd places(0, std::ssize(samples));
  for (std::size_t s = 0; s < samples.size(); ++s) {
    Eigen::VectorXd at = positions_of(samples[s], joints);
    if (s < own.size()) {
      for (const Pose<double>& pose : own[s])
        append(positions_of(pose, kSeen, kSeen * distance), at);
    }
    if (s == 0) places.resize(at.size(), std::ssize(samples));
    places.col(static_cast<Eigen::Index>(s)) = at;
  }
  return places;
}

/// @param places  has rows
[[nodiscard]] PoseGroups groups_of(const Eigen::MatrixXd& places) {
  std::multimap<double, std::pair<Eigen::Index, int>> poses;  // column and number, by the first row
  PoseGroups groups;
  for (Eigen::Index s = 0; s < places.cols(); ++s) {
    const double first = places(0, s);
    const auto end = poses.upper_bound(first + 1.0);
    const auto known = std::find_if(poses.lower_bound(first - 1.0), end, [&](const auto& pose) {
      return (places.col(pose.second.first) - places.col(s)).template lpNorm<Eigen::Infinity>() <=
             1.0;
    });
    if (known != end) {
      groups.of_sample.push_back(known->second.second);
    } else {
      groups.of_sample.push_back(groups.count);
      poses.emplace(first, std::pair(s, groups.count++));
    }
  }
  return groups;
}

}  // namespace
}  // namespace detail

PoseGroups pose_groups(const AnyProblem& problem, std::span<const Sample> samples) {
  const Eigen::MatrixXd places = detail::places_of(problem, samples);
  if (places.rows() == 0) return each_its_own(samples.size());
  PoseGroups groups = detail::groups_of(places);
  return groups.count < 2 ? each_its_own(samples.size()) : groups;
}

PoseGroups by_run(const PoseGroups& poses, std::span<const Sample> samples) {
  constexpr std::size_t kFewest = 5, kStretches = 20;
  const auto is_numbered = [](const Sample& sample) {
    const auto run = sample.conditions.find(kRun);
    return run != sample.conditions.end() && std::isfinite(run->second);
  };
  const auto is_compared = [](const Sample& sample) { return !sample.before.empty(); };
  PoseGroups runs;
  runs.are_runs = true;
  if (std::all_of(samples.begin(), samples.end(), is_numbered)) {
    std::map<std::pair<std::string, double>, int> numbers;
    for (const Sample& sample : samples) {
      const std::pair run(recording_of(sample), sample.conditions.at(kRun));
      runs.of_sample.push_back(
          numbers.try_emplace(run, static_cast<int>(numbers.size())).first->second);
    }
    runs.count = static_cast<int>(numbers.size());
  }
  // The first of each run is compared with nothing before it.
  if (runs.count < static_cast<int>(kFewest) && samples.size() > kFewest * kStretches &&
      std::count_if(samples.begin(), samples.end(), is_compared) + std::max(1, runs.count) >=
          std::ssize(samples)) {
    runs.count = static_cast<int>(kStretches);
    runs.of_sample.clear();
    for (std::size_t s = 0; s < samples.size(); ++s) {
      runs.of_sample.push_back(static_cast<int>(s * kStretches / samples.size()));
    }
  }
  return runs.count < static_cast<int>(kFewest) ? poses : runs;
}

int distinct_poses(const AnyProblem& problem, std::span<const Sample> samples) {
  const Eigen::MatrixXd places = detail::places_of(problem, samples);
  return places.rows() == 0 ? static_cast<int>(samples.size()) : detail::groups_of(places).count;
}

bool are_one_pose(const AnyProblem& problem, std::span<const Sample> samples) {
  return samples.size() > 1 && !detail::repeatable_joints(problem).empty() &&
         distinct_poses(problem, samples) == 1;
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
