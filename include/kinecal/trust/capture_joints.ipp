// Bad captures explained by other joint positions: one joint's reading, or motion of the robot.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "kinecal/geometry/ldlt.hpp"
#include "kinecal/kinematics/robot.hpp"
#include "kinecal/trust/capture_trials.ipp"
#include "kinecal/trust/judge.hpp"

namespace kinecal::detail {

/// Step of numeric derivatives, radians or metres.
inline constexpr double kJointStep = 1e-6;

/// Joint positions that explain a sample.
struct JointCause {
  std::string text;   ///< empty: no explanation
  double chi2 = 0.0;  ///< that remains
};

/// A sample with other positions of its joints.
/// @param change  (joints) added, in the order of the sample
[[nodiscard]] inline Sample with_positions(const Sample& sample, const Eigen::VectorXd& change) {
  Sample changed = sample;
  for (std::size_t j = 0; j < changed.joint_positions.size(); ++j) {
    changed.joint_positions[j] += change(static_cast<Eigen::Index>(j));
  }
  return changed;
}

/// Joints of a sample that affect its observations, by index.
[[nodiscard]] inline std::vector<Eigen::Index> moving_joints(const CaptureTrials& trials,
                                                             const Sample& sample,
                                                             const TrialRows& now) {
  const Eigen::Index count = std::ssize(sample.joint_positions);
  std::vector<Sample> variants;
  for (Eigen::Index j = 0; j < count; ++j) {
    variants.push_back(with_positions(sample, kJointStep * Eigen::VectorXd::Unit(count, j)));
  }
  std::vector<Eigen::Index> moving;
  if (variants.empty()) return moving;
  const std::vector<TrialRows> found = trials(variants);
  for (Eigen::Index j = 0; j < count; ++j) {
    const TrialRows& rows = found[static_cast<std::size_t>(j)];
    const bool same_size = rows.defined && rows.rows.size() == now.rows.size();
    if (same_size && (rows.rows - now.rows).norm() > 0.1 * kJointStep) moving.push_back(j);
  }
  return moving;
}

/// Unit of a joint's position.
[[nodiscard]] inline std::string_view unit_of(const Robot& robot, const std::string& joint) {
  const bool slides = robot.has_joint(joint) && robot.joint(joint).type == JointType::prismatic;
  return slides ? "m" : "rad";
}

/// "'elbow' reads 4.9 deg less": the joint, and the error of its reading.
[[nodiscard]] inline std::string reading_text(const Robot& robot, const std::string& joint,
                                              double lacks) {
  return "'" + joint + "' reads " + reading(std::abs(lacks), unit_of(robot, joint)) +
         (lacks > 0.0 ? " less" : " more");
}

/// Changes of single joints, each alone, that bring a sample nearest to the fit.
/// @returns  (joints) zero for one that is not among `moving`
[[nodiscard]] inline Eigen::VectorXd single_changes(const CaptureTrials& trials,
                                                    const Sample& sample,
                                                    const std::vector<Eigen::Index>& moving) {
  const Eigen::Index count = std::ssize(sample.joint_positions);
  Eigen::VectorXd change = Eigen::VectorXd::Zero(count);
  constexpr int kIterations = 8;
  constexpr double kMost = 0.5;  // of a step
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    std::vector<Sample> variants;
    for (const Eigen::Index j : moving) {
      const Eigen::VectorXd unit = Eigen::VectorXd::Unit(count, j);
      variants.push_back(with_positions(sample, change(j) * unit));
      variants.push_back(with_positions(sample, (change(j) + kJointStep) * unit));
    }
    const std::vector<TrialRows> found = trials(variants);
    for (std::size_t i = 0; i < moving.size(); ++i) {
      const TrialRows &here = found[2 * i], &there = found[2 * i + 1];
      if (!here.defined || !there.defined || here.rows.size() != there.rows.size()) continue;
      const Eigen::VectorXd slope = (there.rows - here.rows) / kJointStep;
      const double curvature = slope.squaredNorm();
      if (!(curvature > 0.0)) continue;
      change(moving[i]) += std::clamp(-slope.dot(here.rows) / curvature, -kMost, kMost);
    }
  }
  return change;
}

/// The joint whose reading explains a sample; up to three, if several do.
[[nodiscard]] inline JointCause wrong_reading(const CaptureTrials& trials, const Robot& robot,
                                              const Sample& sample, const TrialRows& now) {
  constexpr int kOriented = 6;
  const bool oriented = now.features.front().size >= kOriented;
  if (!oriented && (now.features.size() < 3 || now.rows.size() < 6 || now.bad() < 2)) return {};
  const std::vector<Eigen::Index> moving = moving_joints(trials, sample, now);
  if (moving.empty()) return {};
  const Eigen::VectorXd change = single_changes(trials, sample, moving);
  std::vector<Sample> variants;
  for (const Eigen::Index j : moving) {
    variants.push_back(with_positions(sample, change(j) * Eigen::VectorXd::Unit(change.size(), j)));
  }
  const std::vector<TrialRows> found = trials(variants);
  std::vector<std::pair<double, std::string>> explain;
  for (std::size_t i = 0; i < moving.size(); ++i) {
    if (!found[i].fits() || found[i].rows.size() != now.rows.size()) continue;
    const auto j = static_cast<std::size_t>(moving[i]);
    explain.emplace_back(found[i].rows.squaredNorm(),
                         reading_text(robot, sample.joint_names[j], change(moving[i])));
  }
  constexpr std::size_t kMost = 3;
  if (explain.empty() || explain.size() > kMost) return {};
  std::sort(explain.begin(), explain.end());
  std::string text;
  for (const auto& [chi2, joint] : explain) text += (text.empty() ? "" : ", or ") + joint;
  return {text + " than the others say", explain.front().first};
}

/// A small change of all joints that best fits a sample's features; nullopt if it could fit
/// anything.
[[nodiscard]] inline std::optional<Eigen::VectorXd> small_change(
    const CaptureTrials& trials, const Sample& sample, const TrialRows& now,
    const std::vector<Eigen::Index>& moving) {
  constexpr double kTypical = 0.2, kTested = 5.0;
  constexpr int kIterations = 6;
  const Eigen::Index n = std::ssize(moving), count = std::ssize(sample.joint_positions);
  Eigen::VectorXd change = Eigen::VectorXd::Zero(count);
  const Eigen::MatrixXd prior = Eigen::MatrixXd::Identity(n, n) / (kTypical * kTypical);
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    std::vector<Sample> variants = {with_positions(sample, change)};
    for (const Eigen::Index j : moving) {
      variants.push_back(
          with_positions(sample, change + kJointStep * Eigen::VectorXd::Unit(count, j)));
    }
    const std::vector<TrialRows> found = trials(variants);
    if (!found[0].defined || found[0].rows.size() != now.rows.size()) return std::nullopt;
    Eigen::MatrixXd slopes(now.rows.size(), n);
    for (Eigen::Index i = 0; i < n; ++i) {
      const TrialRows& there = found[static_cast<std::size_t>(i) + 1];
      if (!there.defined || there.rows.size() != now.rows.size()) return std::nullopt;
      slopes.col(i) = (there.rows - found[0].rows) / kJointStep;
    }
    const Eigen::MatrixXd squares = slopes.transpose() * slopes;
    const Ldlt ldlt(squares + prior);
    if (iteration + 1 ==
        kIterations) {  // at first, the residual rotates with the joints, which fits more
      const double fitted = ldlt.solve(squares).trace();
      if (static_cast<double>(now.rows.size()) - fitted < kTested) return std::nullopt;
    }
    const Eigen::VectorXd so_far = change(moving);
    const Eigen::VectorXd slope = slopes.transpose() * found[0].rows + prior * so_far;
    change(moving) -= ldlt.solve(slope);
  }
  return change;
}

/// Tests whether a small change of all joints explains a sample: it was moving, or its target
/// slipped.
[[nodiscard]] inline JointCause motion(const CaptureTrials& trials, const Robot& robot,
                                       const Sample& sample, const TrialRows& now) {
  constexpr double kLargest = 0.35;
  if (2 * now.bad() < static_cast<int>(now.features.size())) return {};
  const std::vector<Eigen::Index> moving = moving_joints(trials, sample, now);
  if (moving.size() < 2) return {};
  const std::optional<Eigen::VectorXd> change = small_change(trials, sample, now, moving);
  if (!change || !(change->lpNorm<Eigen::Infinity>() <= kLargest)) return {};
  const TrialRows after = trials({with_positions(sample, *change)}).front();
  if (!after.fits() || after.rows.size() != now.rows.size()) return {};
  Eigen::Index largest = 0;
  (void)change->cwiseAbs().maxCoeff(&largest);
  const std::string& joint = sample.joint_names[static_cast<std::size_t>(largest)];
  return {"all its features are off alike: the robot was still moving (joints by up to " +
              reading(std::abs((*change)(largest)), unit_of(robot, joint)) +
              "), or the target or a sensor had slipped",
          after.rows.squaredNorm()};
}

}  // namespace kinecal::detail
