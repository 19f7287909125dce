// An arm whose joints have different limits, measured by a tracker: samples as they should be, for
// tests that spoil them.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <random>
#include <string>
#include <vector>

#include "kinecal/config/assemble.hpp"
#include "kinecal/config/doubts/find_doubts.hpp"
#include "kinecal/config/read_config.hpp"
#include "kinecal/files/urdf/read_urdf.hpp"
#include "kinecal/geometry/rpy.hpp"
#include "kinecal/kinematics/forward_kinematics.hpp"
#include "support/temporary_folder.hpp"

namespace kinecal::test {

inline const std::string kArmUrdf = R"(<?xml version="1.0"?>
<robot name="arm">
  <link name="base_link"/>
  <joint name="pan" type="revolute">
    <origin xyz="0 0 0.3"/><parent link="base_link"/><child link="l1"/><axis xyz="0 0 1"/>
    <limit lower="-2.9" upper="2.9" effort="1" velocity="1"/>
  </joint>
  <link name="l1"/>
  <joint name="lift" type="revolute">
    <origin xyz="0.1 0 0.2"/><parent link="l1"/><child link="l2"/><axis xyz="0 1 0"/>
    <limit lower="-1.2" upper="1.4" effort="1" velocity="1"/>
  </joint>
  <link name="l2"/>
  <joint name="elbow" type="revolute">
    <origin xyz="0.4 0 0" rpy="0 0.1 0"/><parent link="l2"/><child link="l3"/><axis xyz="0 1 0"/>
    <limit lower="0.6" upper="2.6" effort="1" velocity="1"/>
  </joint>
  <link name="l3"/>
  <joint name="roll" type="revolute">
    <origin xyz="0.35 0 0.02" rpy="0 1.5707963267948966 0"/><parent link="l3"/><child link="l4"/>
    <axis xyz="0 0 1"/>
    <limit lower="-3" upper="3" effort="1" velocity="1"/>
  </joint>
  <link name="l4"/>
  <joint name="flex" type="revolute">
    <origin xyz="0 0 0.1" rpy="1.5707963267948966 0 0"/><parent link="l4"/><child link="l5"/>
    <axis xyz="0 0 1"/>
    <limit lower="-2.2" upper="0.1" effort="1" velocity="1"/>
  </joint>
  <link name="l5"/>
  <joint name="flange" type="fixed">
    <origin xyz="0.08 0 0.1"/><parent link="l5"/><child link="tool"/>
  </joint>
  <link name="tool"/>
</robot>
)";

inline const std::string kArmConfig = R"(base_link: base_link
models:
 - {name: arm, type: chain3d, frame: tool}
 - {name: tracker, type: chain3d, frame: base_link}
free_params:
 - lift
 - elbow
 - roll
 - flex
free_frames:
 - {name: tracker_frame, x: true, y: true, z: true, roll: true, pitch: true, yaw: true}
error_blocks:
 - {name: measured, type: chain3d_to_chain3d, model_a: arm, model_b: tracker}
)";

/// Samples of a robot whose lift is 0.02 rad off and whose elbow -0.03; the tracker stands at
/// (0.7, -0.4, 0.2) and measures two reflectors in the tool to 0.05 mm.
/// @param seed  of poses and noise
inline std::vector<Sample> arm_samples(const Robot& robot, int count, unsigned seed = 7) {
  const RuntimeChain arm = make_chain(robot, "base_link", "tool");
  const Pose<double> base_T_tracker{rotation_from_rpy(Vector3<double>(0.1, -0.2, 0.7)),
                                    Vector3<double>(0.7, -0.4, 0.2)};
  std::mt19937 random(seed);
  std::normal_distribution<double> noise(0.0, 5e-5);
  std::vector<Sample> samples;
  for (int n = 0; n < count; ++n) {
    Sample sample;
    for (const ChainJoint& joint : arm.joints) {
      const JointLimits limits = *robot.joint(joint.name).limits;
      std::uniform_real_distribution<double> within(limits.lower, limits.upper);
      sample.joint_names.push_back(joint.name);
      sample.joint_positions.push_back(within(random));
    }
    const Pose<double> base_T_tool = forward_kinematics(arm, [&](const std::string& joint) {
      return *sample.position(joint) + (joint == "lift" ? 0.02 : joint == "elbow" ? -0.03 : 0.0);
    });
    Observation held{"arm", {}}, seen{"tracker", {}};
    for (const Vector3<double>& p : {Vector3<double>(0, 0, 0.03), Vector3<double>(0.05, 0.02, 0)}) {
      const Vector3<double> error(noise(random), noise(random), noise(random));
      held.features.push_back({"tool", p});
      seen.features.push_back(
          {"tracker_frame", base_T_tracker.inverse() * (base_T_tool * p) + error});
    }
    sample.observations = {held, seen};
    sample.source = "s.yaml:" + std::to_string(10 * n + 1);
    samples.push_back(sample);
  }
  return samples;
}

/// The scene as find_doubts() takes it; tests change it first.
class ArmScene : public FolderTest {
 protected:
  std::string urdf = kArmUrdf, config_text = kArmConfig;
  Recorded recorded = Recorded::after;
  std::vector<Sample> samples = arm_samples(parse_urdf(kArmUrdf, "arm.urdf"), 30);

  [[nodiscard]] Config config() const {
    write("c.yaml", config_text);
    Diagnostics diagnostics;
    Config read = read_config((folder_ / "c.yaml").string(), diagnostics);
    diagnostics.throw_if_errors();
    return read;
  }
  /// What find_doubts() adds.
  [[nodiscard]] Diagnostics found() const {
    const Config read = config();
    const Robot robot = parse_urdf(urdf, "arm.urdf");
    Diagnostics quiet, diagnostics;
    const Calibration calibration = assemble(read, robot, samples, quiet);
    quiet.throw_if_errors();
    const std::string name = "arm.urdf";
    find_doubts({read, robot, urdf, name, samples, calibration, recorded}, diagnostics);
    return diagnostics;
  }
  /// Replaces the first occurrence in a text.
  static void replace(std::string& text, const std::string& from, const std::string& to) {
    const std::size_t at = text.find(from);
    ASSERT_NE(at, std::string::npos) << from;
    text.replace(at, from.size(), to);
  }
  /// The position of a joint in a sample.
  static double& position(Sample& sample, const std::string& joint) {
    const auto& names = sample.joint_names;
    const auto at = std::find(names.begin(), names.end(), joint) - names.begin();
    return sample.joint_positions[static_cast<std::size_t>(at)];
  }
};

}  // namespace kinecal::test
