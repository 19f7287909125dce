// Checks a walker that composes a pose against the laws of CONCEPTS.md.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <concepts>
#include <map>

#include "kinecal/kinematics/walk.hpp"
#include "kinecal/testing/comparison.hpp"
#include "kinecal/testing/random_input.hpp"

namespace kinecal {

namespace detail {

/// A robot with every kind of joint that a chain takes, randomly corrected and moved.
template <class S>
class WalkedRobot {
 public:
  WalkedRobot() {
    RandomInput random;
    using enum JointType;
    const auto joint = [&](const char* name, JointType type, const char* parent, const char* child,
                           const Vector3<double>& axis) {
      return Joint{name, type, parent, child, random.pose(), axis};
    };
    robot_ = Robot("walked", {joint("lift", prismatic, "base", "torso", {0, 0, 1}),
                              joint("pan", revolute, "torso", "shoulder", {0, 0, -1}),
                              joint("plate", fixed, "shoulder", "upper_arm", {1, 0, 0}),
                              joint("elbow", continuous, "upper_arm", "forearm", {1, 2, -1}),
                              joint("slide", prismatic, "forearm", "hand", {0.3, -1, 0.2}),
                              joint("bolt", fixed, "hand", "tool", {1, 0, 0}),
                              joint("yaw", revolute, "torso", "neck", {0, 1, 0}),
                              joint("roll", revolute, "neck", "head", {-1, 0, 0})});
    for (const Joint& of : robot_.joints()) {
      JointCorrection<S>& correction = corrections_[of.name];
      const auto each = [&] { return packed([&] { return random(-0.8, 0.8); }); };
      if (moves(of.type)) states_[of.name] = make_joint_state(each());
      if (moves(of.type)) correction.offset = make_joint_state(each());
      if (of.name == "bolt" || of.name == "roll") continue;  // not corrected
      corrected_.insert(of.name);
      // The same frame in all lanes: exp() of a vector compares numbers.
      JointCorrection<double> frame;
      frame.set_frame(random.vector(), random.vector());
      correction.frame.translation = frame.frame.translation.template cast<S>();
      correction.frame.rotation = frame.frame.rotation.template cast<S>();
      correction.left_jacobian = frame.left_jacobian.template cast<S>();
    }
  }

  [[nodiscard]] RuntimeChain chain(const std::string& base, const std::string& tip) const {
    return make_chain(robot_, base, tip, corrected_);
  }
  /// Walks a chain.
  template <class W>
  void walk(const RuntimeChain& chain, W& walker) const {
    std::vector<JointState<S>> states;
    std::vector<JointCorrection<S>> corrections;
    for (const ChainJoint& joint : chain.joints) {
      states.push_back(moves(joint.type) ? states_.at(joint.name) : JointState<S>{});
      corrections.push_back(corrections_.at(joint.name));
    }
    kinecal::walk(chain, std::span<const JointState<S>>(states),
                  std::span<const JointCorrection<S>>(corrections), walker);
  }
  /// base_T_tip from the definition of a joint: origin, correction, motion.
  [[nodiscard]] Pose<S> pose(const std::string& base, const std::string& tip) const {
    return in_root(base).inverse() * in_root(tip);
  }

 private:
  template <class Next>
  [[nodiscard]] static S packed(Next&& next) {
    S all{0.0};
    for (int i = 0; i < kLanes<S>; ++i) set_lane(all, i, next());
    return all;
  }
  [[nodiscard]] Pose<S> in_root(const std::string& link) const {
    const Joint* joint = robot_.parent_joint(link);
    if (joint == nullptr) return {};
    const JointCorrection<S>& correction = corrections_.at(joint->name);
    const Pose<S> placed = in_root(joint->parent) * joint->origin * correction.frame;
    if (!moves(joint->type)) return placed;
    return placed *
           joint_pose(joint->type, joint->axis, states_.at(joint->name) + correction.offset);
  }

  Robot robot_;
  std::set<std::string> corrected_;
  std::map<std::string, JointCorrection<S>> corrections_;
  std::map<std::string, JointState<S>> states_;
};

template <class S>
S scalar_of(const Pose<S>&);

/// (3 x 4) rotation and translation in one lane.
template <class S>
[[nodiscard]] Eigen::MatrixXd matrix_of(const Pose<S>& pose, int i) {
  Eigen::MatrixXd matrix(3, 4);
  matrix << lane_of(pose.rotation, i), lane_of(pose.translation, i);
  return matrix;
}

}  // namespace detail

/// Checks a walker that composes the pose of the tip, alone or among other things:
///
/// - The pose is the product of origin, correction and motion of each joint (1e-10), on chains from
///   parent to child, back, and from one branch to another.  So a joint with `reversed` set must be
///   undone: its motion first, then its correction.
///
/// Joints are prismatic, revolute, continuous and fixed, about axes of the frame and about others.
/// @param walker   in its initial state, or a function of a RuntimeChain that returns such a walker
/// @param pose_of  callable: a walker after its walk -> its base_T_tip, a Pose<S>
template <class W, class PoseOf>
[[nodiscard]] Verdict check_walker(const W& walker, const PoseOf& pose_of) {
  const auto start = [&](const RuntimeChain& chain) {
    if constexpr (std::invocable<const W&, const RuntimeChain&>) {
      return walker(chain);
    } else {
      return walker;
    }
  };
  using Walking = std::invoke_result_t<decltype(start), const RuntimeChain&>;
  using S = decltype(detail::scalar_of(pose_of(std::declval<const Walking&>())));
  static_assert(Walker<Walking, S>);
  const detail::WalkedRobot<S> robot;
  for (const auto& [base, tip] : {std::pair{"base", "tool"}, {"tool", "base"}, {"tool", "head"}}) {
    const RuntimeChain chain = robot.chain(base, tip);
    Walking walking = start(chain);
    robot.walk(chain, walking);
    const Pose<S> found = pose_of(walking), expected = robot.pose(base, tip);
    for (int i = 0; i < kLanes<S>; ++i) {
      const Eigen::MatrixXd of_walker = detail::matrix_of(found, i),
                            of_joints = detail::matrix_of(expected, i);
      const Verdict v = detail::compare(
          std::string("walker: from '") + base + "' to '" + tip +
              "' its pose is not that of the joints" +
              (std::string_view(base) == "base" ? "" : ", some of which it passes reversed"),
          {"walker", of_walker}, {"joints", of_joints}, detail::kOfRounding);
      if (!v) return v;
    }
  }
  return kLawsHold;
}

}  // namespace kinecal
