// The courses of joint errors over the samples.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <vector>

#include "kinecal/kinematics/forward_kinematics.hpp"
#include "kinecal/problem/any_problem.hpp"
#include "kinecal/samples/joint_moves.hpp"
#include "kinecal/trust/systematic_error.hpp"

namespace kinecal::detail {

/// A joint in each sample.
struct JointTrack {
  std::vector<double> at;      ///< its position; NaN if a sample does not have it
  std::vector<double> raises;  ///< by which it raises the tip of its chain: dz/dq
  bool turns = true;           ///< radians, not metres
};

/// By which each joint of a chain raises its tip, at the pose of a sample; empty if joints are missing.
[[nodiscard]] inline Eigen::VectorXd raises_of(const RuntimeChain& chain, const Sample& sample) {
  const auto n = std::ssize(chain.joints);
  Eigen::VectorXd q = Eigen::VectorXd::Zero(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const ChainJoint& joint = chain.joints[static_cast<std::size_t>(i)];
    if (joint.type == JointType::fixed) continue;
    const auto position = sample.position(joint.drive.joint);
    if (!position || !std::isfinite(*position)) return {};
    q(i) = joint.drive.multiplier * *position + joint.drive.offset;
  }
  Eigen::Matrix<double, 6, Eigen::Dynamic> jacobian(6, n);
  geometric_jacobian(chain, q, jacobian);
  return jacobian.row(2).transpose();
}

/// The joints that move a sensor or target of the problem, by the name of the one that drives.
[[nodiscard]] inline std::map<std::string, JointTrack> joint_tracks(
    const AnyProblem& problem, std::span<const Sample> samples) {
  std::map<std::string, JointTrack> tracks;
  for (const MountedSensor& sensor : problem.sensors()) {
    for (const SampledChain& chain : sensor.chains()) {
      std::map<std::string, JointTrack> of_chain;
      for (const ChainJoint& joint : chain.chain().joints) {
        const std::string& name = joint.drive.joint;
        if (joint.type == JointType::fixed || tracks.contains(name)) continue;
        if (!problem.robot().has_joint(name)) continue;
        of_chain[name].turns = turns(problem.robot().joint(name).type);
      }
      if (of_chain.empty()) continue;
      for (const Sample& sample : samples) {
        const Eigen::VectorXd raises = raises_of(chain.chain(), sample);
        for (auto& [name, track] : of_chain) {
          track.at.push_back(sample.position(name).value_or(std::nan("")));
          double sum = 0.0;
          for (Eigen::Index i = 0; i < raises.size(); ++i) {
            const ChainJoint& joint = chain.chain().joints[static_cast<std::size_t>(i)];
            if (joint.drive.joint == name && moves(joint.type)) sum += raises(i);
          }
          track.raises.push_back(sum);
        }
      }
      tracks.merge(of_chain);
    }
  }
  return tracks;
}

/// The step of which all positions of a joint are multiples, apart from an offset; 0 if absent.
[[nodiscard]] inline double rounding_step(const JointTrack& track) {
  constexpr double kSame = 1e-9, kTolerance = 0.02;
  constexpr std::size_t kFew = 8;
  std::vector<double> sorted;
  for (const double q : track.at) {
    if (std::isfinite(q)) sorted.push_back(q);
  }
  std::sort(sorted.begin(), sorted.end());
  sorted.erase(std::unique(sorted.begin(), sorted.end(),
                           [](double a, double b) { return std::abs(a - b) < kSame; }),
               sorted.end());
  if (sorted.size() < kFew) return 0.0;
  double step = sorted.back() - sorted.front();
  for (std::size_t i = 1; i < sorted.size(); ++i) step = std::min(step, sorted[i] - sorted[i - 1]);
  for (const double q : sorted) {
    const double multiple = (q - sorted.front()) / step;
    if (std::abs(multiple - std::round(multiple)) > kTolerance) return 0.0;
  }
  return step;
}

/// The course of a joint's error in each sample (samples x columns); no columns if it has none.
[[nodiscard]] inline Eigen::MatrixXd course_of(ErrorCourse course, const JointTrack& track) {
  const bool turn = course == ErrorCourse::turn;
  if (turn && !track.turns) return {};
  Eigen::MatrixXd u = Eigen::MatrixXd::Zero(std::ssize(track.at), turn ? 2 : 1);
  double sum = 0.0, known = 0.0;
  for (const double q : track.at) {
    if (std::isfinite(q)) sum += q, known += 1.0;
  }
  const double mean = sum / std::max(1.0, known);
  double before = std::nan("");
  JointWay way;
  for (Eigen::Index s = 0; s < u.rows(); ++s) {
    const double q = track.at[static_cast<std::size_t>(s)];
    if (!std::isfinite(q)) continue;
    way.pass(q);
    if (course == ErrorCourse::zero) u(s, 0) = 1.0;
    if (course == ErrorCourse::gear) u(s, 0) = q - mean;
    if (course == ErrorCourse::backlash)
      u(s, 0) = way.move > 0.0 ? 1.0 : way.move < 0.0 ? -1.0 : 0.0;
    if (course == ErrorCourse::sag) u(s, 0) = track.raises[static_cast<std::size_t>(s)];
    if (course == ErrorCourse::lag && std::isfinite(before)) u(s, 0) = before - q;
    if (turn) u.row(s) << std::sin(q), std::cos(q);
    before = q;
  }
  return u;
}

}  // namespace kinecal::detail
