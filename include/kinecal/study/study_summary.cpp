// Definitions of study_summary.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/study/study_summary.hpp"

#include <algorithm>
#include <cmath>

namespace kinecal {

namespace detail {
namespace {

/// The group of trials that differ only by their repetition.
[[nodiscard]] StudyGroup group_of(const StudySetup& setup, const StudyRobot& robot,
                                  std::span<const StudyTrial> trials, double limit) {
  StudyGroup group;
  group.robot = trials[0].job.robot;
  group.poses = trials[0].job.poses;
  group.trials = static_cast<int>(trials.size());
  const double count = group.trials;
  double positions = 0.0, rotations = 0.0;
  for (const StudyTrial& trial : trials) {
    group.failed += trial.converged && trial.reprojection <= limit ? 0 : 1;
    group.ruined += trial.ruined;
    group.left_out += trial.left_out;
    positions += trial.position * trial.position / count;
    rotations += trial.rotation * trial.rotation / count;
    group.worst_position = std::max(group.worst_position, trial.position);
    group.reprojection += trial.reprojection / count;
    group.systematic += trial.systematic / count;
    group.nonlinearity += trial.nonlinearity / count;
  }
  group.position = std::sqrt(positions);
  group.rotation = std::sqrt(rotations);
  for (std::size_t p = 0; p < setup.free.size(); ++p) {
    ParameterSpread spread;
    spread.truth = robot.truth[static_cast<std::size_t>(setup.free[p])];
    for (const StudyTrial& trial : trials) spread.mean += trial.values[p] / count;
    for (const StudyTrial& trial : trials) {
      const double off = trial.values[p] - spread.mean;
      spread.variance += off * off / std::max(1.0, count - 1.0);
    }
    group.parameters.push_back(spread);
  }
  return group;
}

}  // namespace
}  // namespace detail

std::vector<StudyGroup> summarize(const StudySetup& setup, std::span<const StudyRobot> robots,
                                  std::span<const StudyTrial> trials, double limit) {
  std::vector<StudyGroup> groups;
  for (std::size_t first = 0, end = 0; first < trials.size(); first = end) {
    const StudyJob& job = trials[first].job;
    while (end < trials.size() && trials[end].job.robot == job.robot &&
           trials[end].job.poses == job.poses) {
      ++end;
    }
    groups.push_back(detail::group_of(setup, robots[static_cast<std::size_t>(job.robot)],
                                      trials.subspan(first, end - first), limit));
  }
  return groups;
}

double varied_variance(const StudyGroup& group, std::span<const StudyTrial> trials,
                       const PlainMatrix& goal) {
  const Eigen::MatrixXd by = goal.matrix();
  double sum = 0.0;
  for (const StudyTrial& trial : trials) {
    Eigen::VectorXd off(by.rows());
    for (Eigen::Index p = 0; p < off.size(); ++p) {
      const auto i = static_cast<std::size_t>(p);
      off(p) = trial.values[i] - group.parameters[i].mean;
    }
    sum += off.dot(by * off);
  }
  return sum / std::max(1.0, static_cast<double>(trials.size()) - 1.0);
}

void predict(const StudySetup& setup, const StudyRobot& robot, std::span<const StudyTrial> trials,
             StudyGroup& group) {
  const std::unique_ptr<AnyProblem> problem = setup.make();
  const FreeSet free(setup.free, problem->table().size());
  std::vector<Sample> chosen;
  std::vector<int> all;
  for (const int i : study_poses(setup, {group.robot, group.poses, 0})) {
    all.push_back(static_cast<int>(chosen.size()));
    chosen.push_back(robot.samples[static_cast<std::size_t>(i)]);
  }
  const StudyDesign design = study_design(setup.make, free, robot.truth, chosen, setup.noise);
  const ExpectedUncertainty expected = expected_uncertainty(design, all);
  for (std::size_t p = 0; p < group.parameters.size(); ++p) {
    group.parameters[p].predicted = std::pow(expected.deviation(static_cast<Eigen::Index>(p)), 2);
  }
  const PlainMatrix goal =
      position_goal(*problem, free, robot.truth, robot.samples, setup.frame, setup.in);
  group.predicted_position = std::sqrt(expected_variance(expected, goal));
  if (setup.free_targets) {
    const StudyDesign of_free =
        study_design(setup.make, free, robot.truth, chosen, setup.noise, Targets::free);
    group.free_targets = std::sqrt(expected_variance(expected_uncertainty(of_free, all), goal));
  }
  group.varied_position = std::sqrt(varied_variance(group, trials, goal));
}

}  // namespace kinecal
