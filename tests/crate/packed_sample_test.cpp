#include "kinecal/crate/packed_sample.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "kinecal/errors.hpp"
#include "support/scene.hpp"

namespace kinecal {
namespace {

using Seen = std::vector<std::optional<PackedObservation<double>>>;

constexpr int kLanesOfPacket = kLanes<Packet>;

/// What camera and eye saw in samples that differ in all their numbers; the arm is absent.
std::vector<Seen> seen_in_samples(int count) {
  const Problem problem = test::scene_problem();
  const auto x = test::random_values(problem.table(), 0.02, 5);
  std::vector<Seen> all;
  for (Sample& sample : test::exact_samples(problem, x, count)) {
    const double n = static_cast<double>(all.size());
    for (Observation& observation : sample.observations) {
      if (!observation.camera) continue;
      observation.camera->p[0] += n;
      observation.camera->p[6] -= n;
      observation.camera->z_offset = 0.01 * n;
      observation.camera->z_scaling = 1.0 + 0.02 * n;
      if (observation.sensor == "eye") observation.camera->d = {0.01 * (n + 1), 0.02, 0.0, n, 0.0};
    }
    Seen& seen = all.emplace_back(3);
    for (std::size_t s = 1; s < 3; ++s) {
      seen[s] = problem.sensors()[s].pack(sample, sample.observations[s]);
    }
  }
  return all;
}

void expect_lane(const PackedObservation<Packet>& pack, int i, const PackedObservation<double>& one,
                 double weight) {
  ASSERT_EQ(one.measured.size(), 4u);
  ASSERT_EQ(pack.measured.size(), one.measured.size());
  EXPECT_EQ(pack.chain, one.chain);
  for (std::size_t f = 0; f < one.measured.size(); ++f) {
    for (int k = 0; k < 3; ++k) EXPECT_EQ(lane(pack.measured[f](k), i), one.measured[f](k));
    EXPECT_EQ(lane(pack.usable[f], i), weight * one.usable[f]);
  }
  ASSERT_EQ(pack.motions.size(), one.motions.size());
  for (std::size_t c = 0; c < one.motions.size(); ++c) {
    ASSERT_EQ(pack.motions[c].has_value(), one.motions[c].has_value());
    if (!one.motions[c]) continue;
    ASSERT_EQ(pack.motions[c]->size(), one.motions[c]->size());
    for (std::size_t j = 0; j < one.motions[c]->size(); ++j) {
      EXPECT_EQ(lane((*pack.motions[c])[j].position, i), (*one.motions[c])[j].position);
      EXPECT_EQ(lane((*pack.motions[c])[j].cos, i), (*one.motions[c])[j].cos);
      EXPECT_EQ(lane((*pack.motions[c])[j].sin, i), (*one.motions[c])[j].sin);
    }
  }
  ASSERT_EQ(pack.depth_camera != nullptr, one.depth_camera != nullptr);
  if (one.depth_camera) {
    EXPECT_EQ(lane(pack.depth_camera->fx, i), one.depth_camera->fx);
    EXPECT_EQ(lane(pack.depth_camera->fy, i), one.depth_camera->fy);
    EXPECT_EQ(lane(pack.depth_camera->cx, i), one.depth_camera->cx);
    EXPECT_EQ(lane(pack.depth_camera->cy, i), one.depth_camera->cy);
    EXPECT_EQ(lane(pack.depth_camera->z_offset, i), one.depth_camera->z_offset);
    EXPECT_EQ(lane(pack.depth_camera->z_scaling, i), one.depth_camera->z_scaling);
  }
  ASSERT_EQ(pack.pinhole_camera != nullptr, one.pinhole_camera != nullptr);
  if (one.pinhole_camera) {
    EXPECT_EQ(lane(pack.pinhole_camera->fx, i), one.pinhole_camera->fx);
    EXPECT_EQ(lane(pack.pinhole_camera->fy, i), one.pinhole_camera->fy);
    EXPECT_EQ(lane(pack.pinhole_camera->cx, i), one.pinhole_camera->cx);
    EXPECT_EQ(lane(pack.pinhole_camera->cy, i), one.pinhole_camera->cy);
    for (std::size_t k = 0; k < 5; ++k) {
      EXPECT_EQ(lane(pack.pinhole_camera->d[k], i), one.pinhole_camera->d[k]);
    }
  }
}

TEST(PackedSample, HoldsASampleInEachLaneUntilItIsFull) {
  const SampleShape shape;
  const std::vector<Seen> seen = seen_in_samples(kLanesOfPacket + 1);
  auto pack = make_pack<Packet>(shape, 10, seen[0]);
  for (int i = 1; i < kLanesOfPacket; ++i) {
    ASSERT_TRUE(add_to_pack(pack, 10 + 3 * i, seen[static_cast<std::size_t>(i)]));
  }
  EXPECT_FALSE(add_to_pack(pack, 99, seen.back()));
  EXPECT_EQ(pack.shape, &shape);
  ASSERT_EQ(std::ssize(pack.samples), kLanesOfPacket);
  ASSERT_EQ(pack.seen.size(), 3u);
  EXPECT_FALSE(pack.seen[0].has_value()) << "nothing was seen by the arm";
  for (int i = 0; i < kLanesOfPacket; ++i) {
    EXPECT_EQ(pack.samples[static_cast<std::size_t>(i)], 10 + 3 * i);
    for (const std::size_t s : {1u, 2u}) {
      expect_lane(*pack.seen[s], i, *seen[static_cast<std::size_t>(i)][s], 1.0);
    }
  }
}

/// They must be numbers and defined wherever the first sample is.
TEST(PackedSample, LanesWithoutASampleRepeatTheFirstWithWeightZero) {
  const SampleShape shape;
  const std::vector<Seen> seen = seen_in_samples(1);
  const auto pack = make_pack<Packet>(shape, 0, seen[0]);
  for (const std::size_t s : {1u, 2u}) {
    expect_lane(*pack.seen[s], 0, *seen[0][s], 1.0);
    for (int i = 1; i < kLanesOfPacket; ++i) expect_lane(*pack.seen[s], i, *seen[0][s], 0.0);
  }
}

TEST(PackedSample, OfDoublesHoldsOneSample) {
  const SampleShape shape;
  const std::vector<Seen> seen = seen_in_samples(2);
  auto pack = make_pack<double>(shape, 4, seen[0]);
  EXPECT_FALSE(add_to_pack(pack, 5, seen[1]));
  EXPECT_EQ(pack.samples, std::vector<int>{4});
  EXPECT_EQ(pack.seen[1]->measured, seen[0][1]->measured);
}

TEST(PackedSample, AFeatureThatIsNotANumberRepeatsAnotherWithWeightZero) {
  const Problem problem = test::scene_problem();
  const std::vector<double> zero(static_cast<std::size_t>(problem.table().size()), 0.0);
  Sample sample = test::exact_samples(problem, zero, 1)[0];
  sample.observations[0].features[0].point.y() = std::numeric_limits<double>::quiet_NaN();
  sample.observations[0].features[2].point.z() = std::numeric_limits<double>::infinity();
  const auto seen = problem.sensors()[0].pack(sample, sample.observations[0]);
  EXPECT_EQ(seen.usable, (std::vector<double>{0.0, 1.0, 0.0, 1.0}));
  EXPECT_EQ(seen.measured[0], seen.measured[1]);
  EXPECT_EQ(seen.measured[2], seen.measured[1]);
}

/// Samples share a pack only where sensors, features, their frames and terms agree.
TEST(PackedSample, SamplesOfDifferentShapesDoNotShareAPack) {
  Problem problem = test::scene_problem();
  problem.add_block("hand_eye", PointToPoint{}, {"camera", "arm"});
  problem.add_block("ground", PointToPlane(0, 0, 1, 0), {"camera"});
  const std::vector<double> zero(static_cast<std::size_t>(problem.table().size()), 0.0);
  const auto in_hand = test::exact_samples(problem, zero, 10);
  const auto on_board = test::exact_samples(problem, zero, 10, "board");
  for (std::size_t n = 0; n < 10; ++n) {
    Sample fewer = in_hand[n], no_arm = in_hand[n], both = in_hand[n];
    for (Observation& seen : fewer.observations) seen.features.pop_back();
    no_arm.observations.erase(no_arm.observations.begin());
    both.observations[0].features[1] = on_board[n].observations[0].features[1];
    for (const Sample& sample : {in_hand[n], on_board[n], fewer, no_arm, both}) {
      problem.add_sample(sample);
    }
  }
  EXPECT_EQ(std::ssize(problem.packs()), 5 * ((10 + kLanesOfPacket - 1) / kLanesOfPacket));
  std::vector<int> samples;
  for (const auto& pack : problem.packs()) {
    for (const int n : pack.samples) EXPECT_EQ(n % 5, pack.samples[0] % 5);
    samples.insert(samples.end(), pack.samples.begin(), pack.samples.end());
  }
  std::sort(samples.begin(), samples.end());
  ASSERT_EQ(samples.size(), 50u);
  for (int n = 0; n < 50; ++n) EXPECT_EQ(samples[static_cast<std::size_t>(n)], n);
}

/// What no block looks at is not evaluated and keeps no samples apart.
TEST(PackedSample, WhatNoBlockLooksAtDoesNotKeepSamplesApart) {
  Problem problem = test::scene_problem();
  problem.add_block("ground", PointToPlane(0, 0, 1, 0), {"camera"});
  const std::vector<double> zero(static_cast<std::size_t>(problem.table().size()), 0.0);
  auto samples = test::exact_samples(problem, zero, kLanesOfPacket);
  samples.back().observations.erase(samples.back().observations.begin());  // the arm
  for (const Sample& sample : samples) problem.add_sample(sample);
  ASSERT_EQ(problem.packs().size(), 1u);
  EXPECT_FALSE(problem.packs()[0].seen[0].has_value());
  EXPECT_TRUE(problem.packs()[0].seen[1].has_value());
}

}  // namespace
}  // namespace kinecal
