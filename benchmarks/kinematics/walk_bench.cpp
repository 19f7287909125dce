// Forward kinematics and twists of one pose.  Control: a hand-written chain of 4x4 matrices.
// SPDX-License-Identifier: Apache-2.0
#include <benchmark/benchmark.h>

#include <Eigen/Geometry>

#include "kinecal/kinematics.hpp"
#include "support/robots.hpp"

namespace kinecal {
namespace {

struct Work {
  Robot robot = test::mobile_manipulator();
  RuntimeChain chain = make_chain(robot, "hand", "camera_optical_frame");
  Corrections<double> corrections = Corrections<double>(chain.joints.size());
  std::vector<JointState<double>> motions = measured_joint_states(
      chain, [](const std::string& joint) { return 0.1 * double(joint.size()); });
};

/// The control: joint after joint, with trigonometry.
Eigen::Isometry3d by_hand(const Work& work) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  const auto apply = [&](const Pose<double>& fixed) {
    Eigen::Isometry3d step = Eigen::Isometry3d::Identity();
    step.linear() = fixed.rotation;
    step.translation() = fixed.translation;
    pose = pose * step;
  };
  for (std::size_t i = 0; i < work.chain.joints.size(); ++i) {
    const ChainJoint& joint = work.chain.joints[i];
    const double q = joint.reversed ? -work.motions[i].position : work.motions[i].position;
    apply(joint.fixed);
    if (turns(joint.type)) {
      pose = pose * Eigen::AngleAxisd(q, joint.axis);
    } else {
      pose = pose * Eigen::Translation3d(q * joint.axis);
    }
  }
  apply(work.chain.tail);
  return pose;
}

template <class W>
void walk_once(const Work& work, W& walker) {
  walk(work.chain, std::span<const JointState<double>>(work.motions),
       std::span<const JointCorrection<double>>(work.corrections), walker);
}

void BM_pose_control(benchmark::State& state) {
  Work work;
  for (auto _ : state) {
    benchmark::DoNotOptimize(work.motions.data());
    Eigen::Isometry3d pose = by_hand(work);
    benchmark::DoNotOptimize(pose);
  }
}
BENCHMARK(BM_pose_control);

void BM_pose_walk(benchmark::State& state) {
  Work work;
  PoseWalker<double> once;
  walk_once(work, once);
  if ((once.pose.translation - by_hand(work).translation()).norm() > 1e-12) {
    state.SkipWithError("the walk disagrees with the control");
  }
  for (auto _ : state) {
    benchmark::DoNotOptimize(work.motions.data());
    PoseWalker<double> walker;
    walk_once(work, walker);
    benchmark::DoNotOptimize(walker.pose);
  }
}
BENCHMARK(BM_pose_walk);

/// How fast a joint moves the tip, by central differences of the control: metres per unit.
Vector3<double> tip_velocity(Work work, int joint) {
  constexpr double kStep = 1e-5;
  double& position = work.motions[static_cast<std::size_t>(joint)].position;
  position += kStep;
  const Vector3<double> ahead = by_hand(work).translation();
  position -= 2.0 * kStep;
  return (ahead - by_hand(work).translation()) / (2.0 * kStep);
}

void BM_twists_walk(benchmark::State& state) {
  Work work;
  std::vector<JointIndices> columns(work.chain.joints.size());
  for (std::size_t i = 0; i < columns.size(); ++i) columns[i].offset = static_cast<int>(i);
  ChainTwists<double> twists;
  const TwistColumns joints = twist_columns(work.chain, columns);
  joints.resize(twists);
  TwistWalker<double> once{columns, twists};
  walk_once(work, once);
  const Vector3<double> tip = by_hand(work).translation();
  for (std::size_t k = 0; k < joints.rotational.size(); ++k) {
    const Vector3<double> velocity = twists.rotational[k].velocity(tip);
    if ((velocity - tip_velocity(work, joints.rotational[k])).norm() > 1e-8) {
      state.SkipWithError("a twist disagrees with the control");
    }
  }
  for (auto _ : state) {
    benchmark::DoNotOptimize(work.motions.data());
    TwistWalker<double> walker{columns, twists};
    walk_once(work, walker);
    benchmark::DoNotOptimize(twists.rotational.data());
  }
}
BENCHMARK(BM_twists_walk);

}  // namespace
}  // namespace kinecal

BENCHMARK_MAIN();
