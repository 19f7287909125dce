// Forward kinematics: where is the gripper, and how does each joint move it?
//
// A chain leads from one link to another; the compiler knows it, or it is built at run time.  One
// walk along it gives the pose of its tip, and a twist per joint: the exact derivative of that
// pose.
// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cmath>
#include <cstdio>
#include <map>
#include <numbers>
#include <string>
#include <string_view>

#include "kinecal/geometry.hpp"
#include "kinecal/kinematics.hpp"

namespace {

using namespace kinecal;

constexpr double kDegree = std::numbers::pi / 180.0;
using Positions = std::map<std::string, double>;

constexpr auto kAt = [](double x, double y, double z) {
  return PoseData{.translation = {x, y, z}};
};

/// A lift, three revolute joints, a gripper.  (kinecal_add_robot() generates such a type from a
/// URDF.)
struct LittleArm {
  static constexpr std::string_view kName = "little_arm";
  static constexpr std::array<JointData, 5> kJoints = {{
      {"lift", JointType::prismatic, "base", "column", kAt(0, 0, 0.3), {0, 0, 1}},
      {"shoulder", JointType::revolute, "column", "upper_arm", kAt(0.1, 0, 0.1), {0, 0, 1}},
      {"elbow", JointType::revolute, "upper_arm", "forearm", kAt(0.4, 0, 0), {0, 0, 1}},
      {"wrist", JointType::revolute, "forearm", "hand", kAt(0.3, 0, 0), {0, 1, 0}},
      {"mount", JointType::fixed, "hand", "gripper", {{1, 0, 0, 0, -1, 0, 0, 0, -1}, {0.15, 0, 0}}},
  }};
};
using Arm = Chain<LittleArm, "base", "gripper">;  // a wrong name does not compile
static_assert(Arm::kSize == 4, "what does not move is folded");

/// The gripper's origin at these joint positions: metres, in the base.
Vector3<double> gripper(const RuntimeChain& chain, const Positions& positions) {
  return forward_kinematics(chain, [&](const std::string& joint) { return positions.at(joint); })
      .translation;
}

/// The twist of each joint: a TwistWalker computes how each joint's offset moves the tip.
std::vector<std::pair<int, Twist<double>>> twists(const RuntimeChain& chain,
                                                  const Positions& positions) {
  std::vector<JointIndices> columns(chain.joints.size());
  for (std::size_t i = 0; i < columns.size(); ++i) columns[i].offset = static_cast<int>(i);
  const Corrections<double> none(chain.joints.size());
  const auto motions =
      measured_motions(chain, [&](const std::string& joint) { return positions.at(joint); });
  ChainTwists<double> twists;
  twist_columns(chain, columns).resize(twists);
  TwistWalker<double> walker{columns, twists};
  walk(chain, std::span<const Motion<double>>(motions),
       std::span<const JointCorrection<double>>(none), walker);
  return by_column(twists, twist_columns(chain, columns));
}

}  // namespace

int main() {
  const Positions positions = {
      {"lift", 0.05}, {"shoulder", 30 * kDegree}, {"elbow", 45 * kDegree}, {"wrist", 20 * kDegree}};
  const auto position_of = [&](std::string_view name) { return positions.at(std::string(name)); };
  const RuntimeChain chain = make_chain(robot_from<LittleArm>(), "base", "gripper");

  const Pose<double> base_T_gripper = forward_kinematics(chain, position_of);
  const Vector3<double> p = base_T_gripper.translation;
  const double apart = (forward_kinematics(Arm{}, position_of).translation - p).norm();
  const Vector3<double> rpy = rpy_from_rotation(base_T_gripper.rotation) / kDegree;
  std::printf("The gripper is at x %.4f y %.4f z %.4f m,\n", p.x(), p.y(), p.z());
  std::printf("turned by roll %.1f pitch %.1f yaw %.1f degrees;\n", rpy.x(), rpy.y(), rpy.z());
  std::printf("the compiled chain has it %.0e m away.\n\n", apart);

  std::printf("How it moves when a joint turns by 1 degree or slides by 1 mm, in mm:\n");
  std::printf("  %-10s %8s %8s %8s   %s\n", "joint", "x", "y", "z", "twist - difference");
  bool agree = apart < 1e-15;
  for (const auto& [column, twist] : twists(chain, positions)) {
    const ChainJoint& joint = chain.joints[static_cast<std::size_t>(column)];
    // The same by brute force: central differences.
    constexpr double kStep = 1e-6;
    Positions up = positions, down = positions;
    up[joint.name] += kStep;
    down[joint.name] -= kStep;
    const Vector3<double> difference = (gripper(chain, up) - gripper(chain, down)) / (2 * kStep);
    const double error = (twist.velocity(p) - difference).norm();
    const Vector3<double> mm = twist.velocity(p) * (turns(joint.type) ? kDegree * 1e3 : 1.0);
    std::printf("  %-10s %8.3f %8.3f %8.3f   %.0e\n", joint.name.c_str(), mm.x(), mm.y(), mm.z(),
                error);
    agree = agree && error < 1e-8;  // the accuracy of central differences
  }
  std::printf("\nChains, twists and differences %s.\n", agree ? "agree" : "DO NOT AGREE");
  return agree ? 0 : 1;
}
