// SPDX-License-Identifier: Apache-2.0
#include "pose_choice.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <set>

#include "kinecal/io/urdf/velocity_limits.hpp"

namespace kinecal::cli {
namespace {

/// The joints that differ between samples and move what is observed.
std::vector<std::string> moved_joints(const StudyInput& input) {
  const AnyProblem& problem = *input.calibration.steps.back().problem;
  std::set<std::string> joints;
  for (const MountedSensor& sensor : problem.sensors()) {
    for (const RuntimeChain& chain : sensor.chains()) {
      for (const ChainJoint& joint : chain.joints) {
        if (moves(joint.type)) joints.insert(std::string(joint.drive.joint));
      }
    }
  }
  return {joints.begin(), joints.end()};
}

/// Where a position is in the range of its joint, from 0 to 1.
double share_of(const Joint& joint, double position) {
  if (joint.limits && joint.limits->lower < joint.limits->upper) {
    return (position - joint.limits->lower) / (joint.limits->upper - joint.limits->lower);
  }
  return turns(joint.type) ? 0.5 + position / (2.0 * std::numbers::pi) : position;
}

}  // namespace

PoseChoice pose_choice(const StudyInput& input) {
  const StudySetup& setup = input.setup;
  PoseChoice choice;
  choice.samples = exact_samples(setup.make, setup.drawn, setup.samples);
  const AnyProblem& problem = *input.calibration.steps.back().problem;
  const FreeSet free(setup.free, problem.table().size());
  choice.design = study_design(setup.make, free, setup.drawn, choice.samples, setup.noise);
  const std::size_t candidates = choice.samples.size() - input.have;
  for (std::size_t i = 0; i < candidates; ++i) {
    choice.candidates.information.push_back(choice.design.samples[i].information);
    choice.candidates.scores.push_back(choice.design.samples[i].scores);
  }
  choice.candidates.prior = choice.design.prior;
  Eigen::MatrixXd before = Eigen::MatrixXd::Zero(free.size(), free.size()), scores = before;
  for (std::size_t i = candidates; i < choice.samples.size(); ++i) {
    before += choice.design.samples[i].information.matrix() + choice.design.prior.matrix();
    scores += choice.design.samples[i].scores.matrix();
    choice.have.push_back(static_cast<int>(i));
  }
  choice.candidates.before = before;
  choice.candidates.before_scores = scores;
  choice.candidates.goal =
      position_goal(problem, free, setup.drawn, choice.samples, setup.frame, setup.in);
  choice.joints = moved_joints(input);
  const auto limits = velocity_limits(input.urdf_text, "the URDF");
  constexpr double kTurning = 1.0, kSliding = 0.1;  // rad/s, m/s, where the URDF has no limit
  for (const std::string& name : choice.joints) {
    const auto limit = limits.find(name);
    const bool turning = turns(input.robot.joint(name).type);
    choice.speeds.push_back(limit != limits.end() ? limit->second : turning ? kTurning : kSliding);
  }
  for (const Sample& sample : choice.samples) {
    std::vector<double> place, shares;
    for (const std::string& name : choice.joints) {
      place.push_back(sample.position(name).value_or(0.0));
      shares.push_back(share_of(input.robot.joint(name), place.back()));
    }
    choice.places.push_back(std::move(place));
    if (choice.candidates.shares.size() < candidates) {
      choice.candidates.shares.push_back(std::move(shares));
    }
  }
  return choice;
}

double expected_position(const PoseChoice& choice, const std::vector<int>& chosen) {
  std::vector<int> all(choice.samples.size());
  for (std::size_t i = 0; i < all.size(); ++i) all[i] = static_cast<int>(i);
  const ExpectedUncertainty best = expected_uncertainty(choice.design, all);
  std::vector<int> both = choice.have;
  both.insert(both.end(), chosen.begin(), chosen.end());
  const ExpectedUncertainty expected = expected_uncertainty(choice.design, both);
  if (expected.determined < best.determined) return std::numeric_limits<double>::infinity();
  return std::sqrt(expected_variance(expected, choice.candidates.goal));
}

double random_position(const PoseChoice& choice, int count) {
  constexpr int kSets = 51;  // their median
  const int all = static_cast<int>(choice.candidates.information.size());
  std::vector<double> values;
  SeededRandom random(static_cast<std::uint64_t>(count));
  std::vector<int> order(static_cast<std::size_t>(all));
  for (int i = 0; i < all; ++i) order[static_cast<std::size_t>(i)] = i;
  for (int set = 0; set < kSets; ++set) {
    for (int i = 0; i < count; ++i) {
      std::swap(order[static_cast<std::size_t>(i)],
                order[static_cast<std::size_t>(random.integer(i, all - 1))]);
    }
    values.push_back(expected_position(choice, {order.begin(), order.begin() + count}));
  }
  std::nth_element(values.begin(), values.begin() + kSets / 2, values.end());
  return values[kSets / 2];
}

int random_poses_for(const PoseChoice& choice, double position) {
  int low = 0, high = static_cast<int>(choice.candidates.information.size()) + 1;
  while (high - low > 1) {  // the median falls with the number
    const int middle = (low + high) / 2;
    (random_position(choice, middle) <= position ? high : low) = middle;
  }
  return high;
}

double session_seconds(const PoseChoice& choice, const std::vector<int>& order) {
  constexpr double kStop = 3.0;  // seconds: settling, and a few images
  return motion_time(choice.places, order, choice.speeds) +
         kStop * static_cast<double>(order.size());
}

std::string duration_text(double seconds) {
  const int whole = static_cast<int>(std::lround(seconds));
  return whole < 60 ? fmt::format("{} s", whole)
                    : fmt::format("{} min {} s", whole / 60, whole % 60);
}

std::vector<int> short_order(const PoseChoice& choice, std::vector<int> chosen) {
  std::sort(chosen.begin(), chosen.end());
  return motion_order(choice.places, chosen, choice.speeds);
}

std::vector<CapturePose> poses_of_choice(const StudyInput& input, const std::vector<int>& chosen) {
  std::vector<CapturePose> poses;
  for (const int i : chosen) poses.push_back(input.poses[static_cast<std::size_t>(i)]);
  return poses;
}

}  // namespace kinecal::cli
