// Forward kinematics: where is the gripper, and how does each joint move it?
//
// A chain leads from one link to another; the compiler knows it, or it is built at run time.
// Joint positions are a vector in the order of its joints.
// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cstdio>
#include <numbers>
#include <string_view>

#include "kinecal/geometry.hpp"
#include "kinecal/kinematics.hpp"

namespace {

using namespace kinecal;

constexpr double kDegree = std::numbers::pi / 180.0;

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

}  // namespace

int main() {
  const RuntimeChain chain = make_chain(robot_from<LittleArm>(), "base", "gripper");
  const Eigen::Vector4d q(0.05, 30 * kDegree, 45 * kDegree, 20 * kDegree);

  const Pose<double> base_T_gripper = forward_kinematics(chain, q);
  const Vector3<double> p = base_T_gripper.translation;
  const double apart = (forward_kinematics(Arm{}, q).translation - p).norm();
  const Vector3<double> rpy = rpy_from_rotation(base_T_gripper.rotation) / kDegree;
  std::printf("The gripper is at x %.4f y %.4f z %.4f m,\n", p.x(), p.y(), p.z());
  std::printf("turned by roll %.1f pitch %.1f yaw %.1f degrees;\n", rpy.x(), rpy.y(), rpy.z());
  std::printf("the compiled chain has it %.0e m away.\n\n", apart);

  std::printf("How it moves when a joint turns by 1 degree or slides by 1 mm, in mm:\n");
  std::printf("  %-10s %8s %8s %8s   %s\n", "joint", "x", "y", "z", "Jacobian - difference");
  const Eigen::Matrix<double, 6, 4> jacobian = geometric_jacobian(Arm{}, q);
  bool agree = apart < 1e-15;
  for (int i = 0; i < 4; ++i) {
    constexpr double kStep = 1e-6;  // the same by brute force: central differences
    const Eigen::Vector4d step = kStep * Eigen::Vector4d::Unit(i), up = q + step, down = q - step;
    const Vector3<double> difference =
        (forward_kinematics(chain, up).translation - forward_kinematics(chain, down).translation) /
        (2 * kStep);
    const Vector3<double> moved = jacobian.col(i).head<3>();
    const double error = (moved - difference).norm();
    const ChainJoint& joint = chain.joints[static_cast<std::size_t>(i)];
    const Vector3<double> mm = moved * (turns(joint.type) ? kDegree * 1e3 : 1.0);
    std::printf("  %-10s %8.3f %8.3f %8.3f   %.0e\n", joint.name.c_str(), mm.x(), mm.y(), mm.z(),
                error);
    agree = agree && error < 1e-8;  // the accuracy of central differences
  }
  std::printf("\nChains, Jacobian and differences %s.\n", agree ? "agree" : "DO NOT AGREE");
  return agree ? 0 : 1;
}
