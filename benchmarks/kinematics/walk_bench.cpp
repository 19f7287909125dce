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

/// 1000 poses with Jacobians of an arm of seven joints; the control takes one pose after the other.
struct ThousandPoses {
  static constexpr std::size_t kPoses = 1000, kJoints = 7;
  ChainOfColumns chain = [] {
    std::vector<Joint> joints;
    std::vector<std::string> names;
    for (std::size_t i = 0; i < kJoints; ++i) {
      names.push_back("joint_" + std::to_string(i));
      Joint joint{.name = names.back(),
                  .type = JointType::revolute,
                  .parent = "link_" + std::to_string(i),
                  .child = "link_" + std::to_string(i + 1)};
      joint.axis = {0.0, 0.0, 1.0};
      joint.origin.translation = {0.1, 0.0, 0.3};
      joint.origin.rotation =
          Eigen::AngleAxisd(i % 2 == 0 ? 1.5 : -1.5, Eigen::Vector3d::UnitX()).toRotationMatrix();
      joints.push_back(joint);
    }
    return make_chain_of_columns(Robot("arm", joints), "link_0", "link_7", names);
  }();
  std::vector<double> positions = std::vector<double>(kPoses * kJoints, 0.3);
  std::vector<double> poses = std::vector<double>(16 * kPoses);
  std::vector<double> jacobians = std::vector<double>(6 * kJoints * kPoses);
};

void BM_thousand_jacobians_control(benchmark::State& state) {
  ThousandPoses work;
  Eigen::Matrix<double, 6, Eigen::Dynamic> jacobian(6, 7);
  for (auto _ : state) {
    benchmark::DoNotOptimize(work.positions.data());
    for (std::size_t i = 0; i < ThousandPoses::kPoses; ++i) {
      const Eigen::Map<const Eigen::VectorXd> q(&work.positions[7 * i], 7);
      benchmark::DoNotOptimize(geometric_jacobian(work.chain.chain, q, jacobian));
      benchmark::DoNotOptimize(jacobian.data());
    }
  }
}
BENCHMARK(BM_thousand_jacobians_control);

void BM_thousand_jacobians(benchmark::State& state) {
  ThousandPoses work;
  for (auto _ : state) {
    benchmark::DoNotOptimize(work.positions.data());
    forward_kinematics(work.chain, work.positions, work.poses, work.jacobians);
    benchmark::DoNotOptimize(work.jacobians.data());
  }
}
BENCHMARK(BM_thousand_jacobians);

}  // namespace
}  // namespace kinecal

BENCHMARK_MAIN();
