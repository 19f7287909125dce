// Two arms of one torso: each hand carries a camera and a board, and its camera sees the other hand's board; or the arms alone.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <map>
#include <set>
#include <string>
#include <vector>

#include "kinecal/files/urdf/read_urdf.hpp"
#include "kinecal/geometry/rpy.hpp"
#include "kinecal/kinematics/forward_kinematics.hpp"
#include "support/unknown_poses.hpp"

namespace kinecal::test {

/// The robot, what is wrong with it, and what its cameras saw.
struct TwoArms {
  Robot robot = parse_urdf(urdf(), "two_arms.urdf");
  std::map<std::string, double> zeros;         ///< added to the reading, by joint
  std::map<std::string, Pose<double>> boards;  ///< hand_T_board, by the board's frame
  std::vector<Sample> samples;

  /// @param views  of each camera
  /// @param wrong  joints whose zeros are wrong
  TwoArms(std::uint64_t seed, int views, const std::set<std::string>& wrong = {},
          double pixels = 0.3) {
    Chance chance(seed);
    for (const Joint& joint : robot.joints()) {
      if (!moves(joint.type)) continue;
      zeros[joint.name] = wrong.contains(joint.name) ? chance(-0.02, 0.02) : 0.0;
    }
    for (const char* hand : {"left_hand", "right_hand"}) {
      boards[std::string(hand) + "_checkerboard"] = {
          rotation_from_rpy(Vector3<double>(chance.box(0.3) + Vector3<double>(0.0, 1.2, 0.0))),
          chance.box(0.05)};
    }
    for (const std::string side : {"left", "right"}) {
      for (int n = 0; n < views; ++n) samples.push_back(seen_by(side, chance, pixels));
    }
  }

  /// @param joints  of each arm: 6, or 7
  [[nodiscard]] static std::string urdf(std::size_t joints = 6) {
    std::string text = "<robot name=\"two_arms\"><link name=\"torso\"/>\n";
    for (const std::string side : {"left", "right"}) {
      const double y = side == "left" ? 0.25 : -0.25;
      std::vector<const char*> axes = {"0 0 1", "0 1 0", "0 1 0", "1 0 0", "0 1 0", "1 0 0"};
      std::vector<double> lengths = {0.0, 0.05, 0.3, 0.15, 0.15, 0.08};
      if (joints == 7) {  // one more turns the upper arm
        axes.insert(axes.begin() + 2, "1 0 0");
        lengths.insert(lengths.begin() + 2, 0.1);
      }
      std::string parent = "torso";
      for (std::size_t i = 0; i < joints; ++i) {
        const std::string child = i + 1 == joints ? side + "_hand" : fmt::format("{}_{}", side, i);
        text += fmt::format(
            "<link name=\"{0}\"/><joint name=\"{1}_joint_{2}\" type=\"revolute\"><parent "
            "link=\"{3}\"/><child link=\"{0}\"/><origin xyz=\"{4} {5} {6}\"/><axis "
            "xyz=\"{7}\"/><limit "
            "lower=\"-3\" upper=\"3\" effort=\"1\" velocity=\"1\"/></joint>\n",
            child, side, i, parent, lengths[i], i == 0 ? y : 0.01, i == 0 ? 0.4 : 0.0, axes[i]);
        parent = child;
      }
      text += fmt::format(
          "<link name=\"{0}_eye\"/><joint name=\"{0}_eye_joint\" type=\"fixed\"><parent "
          "link=\"{0}_hand\"/><child link=\"{0}_eye\"/><origin xyz=\"0.02 0.03 0.06\" rpy=\"-1.4 "
          "0.1 "
          "-1.5\"/></joint>\n",
          side);
    }
    return text + "</robot>";
  }

  /// The truth of a parameter: zeros, and poses of boards; all else is as the URDF says.
  [[nodiscard]] double truth(const std::string& name) const {
    if (const auto zero = zeros.find(name); zero != zeros.end()) return zero->second;
    for (const auto& [frame, pose] : boards) {
      if (name == parameter_name(frame, name.substr(name.size() - 1)))
        return of_axis(name.back(), pose);
    }
    return 0.0;
  }

 private:
  [[nodiscard]] static double of_axis(char axis, const Pose<double>& pose) {
    const auto k = static_cast<Eigen::Index>(std::string("xyzabc").find(axis));
    return k < 3 ? pose.translation(k) : log(pose.rotation)(k - 3);
  }

  /// A sample in which the camera of a side sees all corners of the other hand's board, from its face.
  [[nodiscard]] Sample seen_by(const std::string& side, Chance& chance, double pixels) const {
    const std::string eye = side + "_eye", hand = side == "left" ? "right_hand" : "left_hand",
                      frame = hand + "_checkerboard";
    const RuntimeChain to_eye = make_chain(robot, "torso", eye),
                       to_hand = make_chain(robot, "torso", hand);
    for (;;) {
      std::map<std::string, double> reading;
      for (const auto& [joint, zero] : zeros) reading[joint] = chance(-1.6, 1.6);
      const auto at = [&](const std::string& joint) { return reading[joint] + zeros.at(joint); };
      const Pose<double> eye_T_board = forward_kinematics(to_eye, at).inverse() *
                                       forward_kinematics(to_hand, at) * boards.at(frame);
      const Vector3<double> middle = eye_T_board * Vector3<double>(0.09, 0.06, 0.0);
      if (middle.z() < 0.2 || middle.z() > 0.8) continue;
      Observation holder{hand, {}, {}}, seen{eye, {}, camera_info()};
      bool is_in = true;
      for (const Vector3<double>& corner : corners()) {
        const Vector3<double> p = eye_T_board * corner;
        const double u = 550 * p.x() / p.z() + 320, v = 545 * p.y() / p.z() + 240;
        is_in = is_in && p.z() > 0.1 && u > 0 && u < 640 && v > 0 && v < 480;
        if (!is_in) break;
        holder.features.push_back({frame, corner});
        seen.features.push_back(
            {eye, {u + pixels * chance.normal(), v + pixels * chance.normal(), 0.0}});
      }
      if (!is_in) continue;
      Sample sample;
      sample.source = fmt::format("{}:{}", eye, samples.size());
      for (const auto& [joint, position] : reading) {
        sample.joint_names.push_back(joint);
        sample.joint_positions.push_back(position);
      }
      sample.observations = {holder, seen};
      return sample;
    }
  }
};

}  // namespace kinecal::test
