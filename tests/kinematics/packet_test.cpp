// The walk in packets: as many samples at once as a register holds, the same numbers as one by one.
#include "kinecal/geometry/packet.hpp"

#include <gtest/gtest.h>

#include "kinecal/kinematics/twist_walker.hpp"
#include "support/robots.hpp"

namespace kinecal {
namespace {

TEST(Packet, IsAsWideAsTheInstructionSet) {
#if defined(__GNUC__) && !defined(__clang__)
  // The compiler aligns nothing more than the widest register; clang's figure is always 16.
  EXPECT_EQ(sizeof(Packet), std::size_t(__BIGGEST_ALIGNMENT__)) << instruction_set();
#endif
  EXPECT_EQ(sizeof(Packet), sizeof(double) * std::size_t(kLanes<Packet>));
  if (instruction_set() == "x86-64-v4") {
    EXPECT_EQ(kLanes<Packet>, 8);
  }
#ifndef __AVX512F__
  if (instruction_set() == "x86-64-v3") {
    EXPECT_EQ(kLanes<Packet>, 4);
  }
#endif
#ifndef __AVX__
  EXPECT_EQ(kLanes<Packet>, 2) << instruction_set();
#endif
}

TEST(Packet, WalksAsManySamplesAtOnceAsItHasLanes) {
  const Robot robot = test::mobile_manipulator();
  const RuntimeChain chain =
      make_chain(robot, "hand", "camera_optical_frame", {"wrist", "head_tilt"});
  Corrections<double> corrections(chain.joints.size());
  std::vector<JointIndices> columns(chain.joints.size());
  for (std::size_t i = 0; i < chain.joints.size(); ++i) {
    corrections[i].offset = make_joint_state(0.01 * static_cast<double>(i));
    columns[i].offset = static_cast<int>(i);
    if (!chain.joints[i].corrected) continue;
    corrections[i].set_frame({0.01, -0.02, 0.03}, {0.1, 0.2, -0.3});
    columns[i].frame = {10, 11, 12, 13, 14, 15};
  }
  const std::span<const JointCorrection<double>> all(corrections);

  // One sample in each lane.
  std::vector<std::vector<JointState<double>>> samples;
  std::vector<JointState<Packet>> packed(chain.joints.size());
  for (std::size_t lane = 0; lane < Packet::size(); ++lane) {
    test::RandomPositions positions(static_cast<unsigned>(lane));
    samples.push_back(
        measured_joint_states(chain, [&](const std::string& joint) { return positions(joint); }));
    for (std::size_t i = 0; i < packed.size(); ++i) {
      packed[i].position.set(lane, samples[lane][i].position);
      packed[i].cos.set(lane, samples[lane][i].cos);
      packed[i].sin.set(lane, samples[lane][i].sin);
    }
  }
  ChainTwists<Packet> packed_twists;
  twist_columns(chain, columns).resize(packed_twists);
  TwistWalker<Packet> at_once{columns, packed_twists};
  walk(chain, std::span<const JointState<Packet>>(packed), all, at_once);

  constexpr double kRounding = 1e-14;
  for (std::size_t lane = 0; lane < Packet::size(); ++lane) {
    ChainTwists<double> twists;
    twist_columns(chain, columns).resize(twists);
    TwistWalker<double> alone{columns, twists};
    walk(chain, std::span<const JointState<double>>(samples[lane]), all, alone);
    ASSERT_EQ(packed_twists.rotational.size(), twists.rotational.size());
    ASSERT_EQ(packed_twists.translational.size(), twists.translational.size());
    for (int k = 0; k < 3; ++k) {
      EXPECT_NEAR(at_once.walker.pose.translation(k)[lane], alone.walker.pose.translation(k),
                  kRounding);
      for (std::size_t t = 0; t < twists.rotational.size(); ++t) {
        EXPECT_NEAR(packed_twists.rotational[t].linear(k)[lane], twists.rotational[t].linear(k),
                    kRounding);
        EXPECT_NEAR(packed_twists.rotational[t].angular(k)[lane], twists.rotational[t].angular(k),
                    kRounding);
      }
      for (std::size_t t = 0; t < twists.translational.size(); ++t) {
        EXPECT_NEAR(packed_twists.translational[t](k)[lane], twists.translational[t](k), kRounding);
      }
    }
  }
}

}  // namespace
}  // namespace kinecal
