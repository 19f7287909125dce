#include "kinecal/testing/check_walker.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "kinecal/kinematics/twist_walker.hpp"

namespace kinecal {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

TEST(CheckWalker, HoldsForTheBuiltInWalkers) {
  const auto pose = [](const auto& walker) { return walker.pose; };
  EXPECT_EQ(check_walker(PoseWalker<double>{}, pose), kLawsHold);
  EXPECT_EQ(check_walker(PoseWalker<Packet>{}, pose), kLawsHold);
  std::vector<JointIndices> none;
  ChainTwists<double> twists;
  const auto walker = [&](const RuntimeChain& chain) {
    none.assign(chain.joints.size(), {});
    return TwistWalker<double>(none, twists);
  };
  const auto pose_of = [](const TwistWalker<double>& w) { return w.walker.pose; };
  EXPECT_EQ(check_walker(walker, pose_of), kLawsHold);
}

/// A walker as a user would write it.
struct Composer {
  Pose<double> pose;
  void fixed(const Pose<double>& transform) { pose = pose * transform; }
  void correct(std::size_t, const ChainJoint& joint, const JointCorrection<double>& correction) {
    pose = pose * (joint.reversed ? correction.frame.inverse() : correction.frame);
  }
  void move(std::size_t, const ChainJoint& joint, const JointState<double>& state) {
    pose = pose * joint_pose(joint.type, joint.axis, joint.reversed ? state.inverse() : state);
  }
};
/// It does not undo the corrections.
struct OneWay : Composer {
  void correct(std::size_t, const ChainJoint&, const JointCorrection<double>& correction) {
    pose = pose * correction.frame;
  }
};
/// It takes all joints for revolute.
struct OnlyTurns : Composer {
  void move(std::size_t, const ChainJoint& joint, const JointState<double>& state) {
    pose = pose *
           joint_pose(JointType::revolute, joint.axis, joint.reversed ? state.inverse() : state);
  }
};

TEST(CheckWalker, FindsAWrongPoseAndPrintsBoth) {
  const auto pose = [](const Composer& walker) { return walker.pose; };
  EXPECT_EQ(check_walker(Composer{}, pose), kLawsHold);
  const Verdict back = check_walker(OneWay{}, pose), there = check_walker(OnlyTurns{}, pose);
  EXPECT_THAT(back.text, StartsWith("walker: from 'tool' to 'base' its pose is not that of the "
                                    "joints, some of which it passes reversed\nwalker:\n"));
  EXPECT_THAT(back.text, HasSubstr("\njoints:\n"));
  EXPECT_THAT(there.text,
              StartsWith("walker: from 'base' to 'tool' its pose is not that of the joints\n"));
}

}  // namespace
}  // namespace kinecal
