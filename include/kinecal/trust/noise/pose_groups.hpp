// Which samples are readings of one pose of the robot.
//
// Readings of a pose share what the robot did there: where its joints really stopped, how the target bent.
// They say how well the sensors repeat and little of the robot, so they count as one: in folds, in degrees
// of freedom, and in the covariance.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "kinecal/problem/any_problem.hpp"
#include "kinecal/samples/sample.hpp"

namespace kinecal {

/// Samples by pose.
struct PoseGroups {
  std::vector<int> of_sample;  ///< number of its pose, from 0, in the order of the samples
  int count = 0;               ///< number of poses
  bool are_runs = false;       ///< they are runs of a recording: see by_run()

  /// Samples per pose, in the mean.
  [[nodiscard]] double readings() const {
    return count > 0 ? static_cast<double>(of_sample.size()) / count : 1.0;
  }
};

/// Each sample is a pose of its own.
[[nodiscard]] PoseGroups each_its_own(std::size_t samples);

/// Samples in which every joint that moves a sensor or target of the problem is where it was in another,
/// within what robots repeat: 1 mrad, 0.2 mm; and so is a target with a pose of its own: 10 mrad, a hundredth of its
/// distance.  Where nothing moves each sample is a pose of its own.
/// @param samples  those of the problem, in their order
[[nodiscard]] PoseGroups pose_groups(const AnyProblem& problem, std::span<const Sample> samples);

/// Poses by run (kRun): the floor, the tyres and the tracking of a run err alike.  Of samples that are compared with those
/// before, and are of fewer than five runs or of none, twenty stretches of the recording are runs if there are more than a hundred.  As
/// they are where there are still fewer than five.
[[nodiscard]] PoseGroups by_run(const PoseGroups& poses, std::span<const Sample> samples);

/// Number of such poses, one of several samples among them; of samples, where nothing moves.
[[nodiscard]] int distinct_poses(const AnyProblem& problem, std::span<const Sample> samples);

/// True if joints move a sensor or target of the problem, and all of several samples are of one pose.
[[nodiscard]] bool are_one_pose(const AnyProblem& problem, std::span<const Sample> samples);

/// Four regions of poses, of as many poses each: halved at the median of the joint that moves most, and each half
/// again.  Empty if no joint moves or if there are fewer than 20 poses.
/// @param poses  of the samples: a pose is in one region
/// @returns      the region of each sample, 0 to 3
[[nodiscard]] std::vector<int> pose_regions(const AnyProblem& problem,
                                            std::span<const Sample> samples,
                                            const PoseGroups& poses);

}  // namespace kinecal
