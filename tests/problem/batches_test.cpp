#include "kinecal/problem/batches.hpp"

#include <gtest/gtest.h>

#include <array>
#include <limits>
#include <optional>

#include "kinecal/errors.hpp"
#include "support/scene.hpp"

namespace kinecal {
namespace {

constexpr int kLanesOfPacket = kLanes<Packet>;

/// What the arm, the camera and the eye saw in a sample.
using Seen = std::array<std::optional<detail::ObservationNumbers>, 3>;

/// It as a row.
detail::SampleRow row_of(const Seen& seen) {
  detail::SampleRow row;
  for (const auto& of_sensor : seen) row.add_sensor(of_sensor ? &*of_sensor : nullptr);
  return row;
}

template <class S>
detail::Batches<S> batches_of(const std::vector<Seen>& all) {
  detail::Batches<S> batches(row_of(all[0]).layout);
  for (std::size_t n = 0; n < all.size(); ++n) {
    const detail::SampleRow row = row_of(all[n]);
    EXPECT_EQ(row.layout, batches.layout());
    EXPECT_EQ(row.numbers.size(), row.layout.size);
    batches.add(10 + 3 * static_cast<int>(n), row.numbers);
  }
  return batches;
}

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
    Seen& seen = all.emplace_back();
    for (std::size_t s = 1; s < 3; ++s) {
      seen[s] = problem.sensors()[s].numbers(sample, sample.observations[s]);
    }
  }
  return all;
}

template <class S>
void expect_lane(const detail::BatchObservation<S>& batch, int i,
                 const detail::ObservationNumbers& one, double weight) {
  ASSERT_EQ(one.usable.size(), 4u);
  ASSERT_EQ(batch.size(), one.usable.size());
  ASSERT_EQ(one.measured.size(), 12u);
  for (std::size_t f = 0; f < 4; ++f) {
    EXPECT_EQ(batch.chain(f), one.chain[f]);
    for (std::size_t k = 0; k < 3; ++k) {
      EXPECT_EQ(lane(batch.measured(f)[k], i), one.measured[3 * f + k]);
    }
    EXPECT_EQ(lane(batch.usable(f), i), weight * one.usable[f]);
  }
  for (std::size_t k = 0; k < one.settings.size(); ++k) {
    EXPECT_EQ(lane(batch.settings()[k], i), one.settings[k]);
  }
  for (std::size_t c = 0; c < one.joints.size(); ++c) {
    ASSERT_EQ(batch.has_joints(c), one.joints[c].has_value());
    if (!one.joints[c]) continue;
    const std::vector<double>& joints = *one.joints[c];
    for (std::size_t k = 0; k < joints.size(); ++k) {
      EXPECT_EQ(lane(batch.joints(c)[k], i), joints[k]);
    }
  }
}

TEST(JointStates, HaveWhatAJointMovesByAndWithModelsTheirEffects) {
  const std::array numbers = {0.1, 0.2, 0.3, 0.4, 0.5, 0.6};
  const JointState<double> turning = detail::JointStates<double, false>{numbers.data()}[1];
  EXPECT_EQ(turning.cos, 0.3);
  EXPECT_EQ(turning.sin, 0.4);
  const JointState<double> sliding = detail::JointStates<double, false>{numbers.data()}[2];
  EXPECT_EQ(sliding.position, 0.5);
  const detail::JointStates<double, true> modelled{numbers.data(), 1};  // one effect a joint
  EXPECT_EQ(modelled[1].cos, 0.4);
  EXPECT_EQ(modelled[1].sin, 0.5);
  EXPECT_EQ(modelled.effects(1)[0], 0.6);
}

TEST(Batches, HoldASampleInEachLane) {
  const std::vector<Seen> seen = seen_in_samples(2 * kLanesOfPacket + 1);
  const detail::Batches<Packet> batches = batches_of<Packet>(seen);
  ASSERT_EQ(batches.size(), 3u);
  EXPECT_EQ(batches.samples(2).size(), 1u);
  EXPECT_FALSE(batches.layout().sensors[0]) << "nothing was seen by the arm";
  for (std::size_t b = 0; b < 2; ++b) {
    ASSERT_EQ(std::ssize(batches.samples(b)), kLanesOfPacket);
    for (int i = 0; i < kLanesOfPacket; ++i) {
      const std::size_t n = b * kLanesOfPacket + static_cast<std::size_t>(i);
      EXPECT_EQ(batches.samples(b)[static_cast<std::size_t>(i)], 10 + 3 * static_cast<int>(n));
      for (const std::size_t s : {1u, 2u}) {
        ASSERT_TRUE(batches.layout().sensors[s]);
        expect_lane(batches.observation(b, s), i, *seen[n][s], 1.0);
      }
    }
  }
}

TEST(Batches, HoldPrecisionsWhereFeaturesHaveSigmasAndConditions) {
  const std::vector<Seen> seen = seen_in_samples(kLanesOfPacket + 1);
  std::optional<detail::Batches<Packet>> batches;
  for (std::size_t n = 0; n < seen.size(); ++n) {
    const auto number = static_cast<double>(n);
    detail::SampleRow row = row_of(seen[n]);
    row.add_term(3, {}, {20.0 + number}, 0);
    row.add_term(5, {1.0, 2.0 + number}, {}, 0);
    if (!batches) batches.emplace(row.layout);
    EXPECT_EQ(row.layout, batches->layout());
    batches->add(static_cast<int>(n), row.numbers);
  }
  const std::vector<detail::TermLayout>& terms = batches->layout().terms;
  ASSERT_EQ(terms.size(), 2u);
  EXPECT_EQ(terms[0].term, 3);
  EXPECT_EQ(terms[1].term, 5);
  EXPECT_EQ(batches->of_term(0, terms[0].inverse_sigmas), nullptr);
  for (int i = 0; i < kLanesOfPacket; ++i) {
    EXPECT_EQ(lane(batches->of_term(0, terms[0].conditions)[0], i), 20.0 + i);
    EXPECT_EQ(lane(batches->of_term(0, terms[1].inverse_sigmas)[0], i), 1.0);
    EXPECT_EQ(lane(batches->of_term(0, terms[1].inverse_sigmas)[1], i), 2.0 + i);
    EXPECT_EQ(lane(batches->of_term(1, terms[1].inverse_sigmas)[1], i), 2.0 + kLanesOfPacket)
        << "repeated";
  }
}

/// They must be numbers and defined wherever the first sample is.
TEST(Batches, LanesWithoutASampleRepeatTheFirstWithWeightZero) {
  const std::vector<Seen> seen = seen_in_samples(1);
  const detail::Batches<Packet> batches = batches_of<Packet>(seen);
  for (const std::size_t s : {1u, 2u}) {
    expect_lane(batches.observation(0, s), 0, *seen[0][s], 1.0);
    for (int i = 1; i < kLanesOfPacket; ++i) {
      expect_lane(batches.observation(0, s), i, *seen[0][s], 0.0);
    }
  }
}

TEST(Batches, OfDoublesHoldOneSample) {
  const std::vector<Seen> seen = seen_in_samples(2);
  const detail::Batches<double> batches = batches_of<double>(seen);
  ASSERT_EQ(batches.size(), 2u);
  for (const std::size_t b : {0u, 1u}) {
    EXPECT_EQ(batches.samples(b)[0], static_cast<int>(10 + 3 * b));
    expect_lane(batches.observation(b, 1), 0, *seen[b][1], 1.0);
  }
}

TEST(Batches, HoldAWeightOfEachFeatureOnlyIfOneIsMissing) {
  std::vector<Seen> seen = seen_in_samples(1);
  const detail::Batches<double> whole = batches_of<double>(seen);
  seen[0][1]->usable[2] = 0.0;
  const detail::Batches<double> missing = batches_of<double>(seen);
  expect_lane(missing.observation(0, 1), 0, *seen[0][1], 1.0);
  EXPECT_NE(missing.layout(), whole.layout());
  EXPECT_EQ(missing.numbers(0).size(), whole.numbers(0).size() + 3) << "four in place of one";
  EXPECT_TRUE(missing.numbers(1).empty()) << "there is one batch only";
}

TEST(Batches, AFeatureThatIsNotANumberRepeatsAnotherWithWeightZero) {
  const Problem problem = test::scene_problem();
  const std::vector<double> zero(static_cast<std::size_t>(problem.table().size()), 0.0);
  Sample sample = test::exact_samples(problem, zero, 1)[0];
  sample.observations[0].features[0].point.y() = std::numeric_limits<double>::quiet_NaN();
  sample.observations[0].features[2].point.z() = std::numeric_limits<double>::infinity();
  const detail::ObservationNumbers seen =
      problem.sensors()[0].numbers(sample, sample.observations[0]);
  EXPECT_EQ(seen.usable, (std::vector<double>{0.0, 1.0, 0.0, 1.0}));
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_EQ(seen.measured[k], seen.measured[3 + k]);
    EXPECT_EQ(seen.measured[6 + k], seen.measured[3 + k]);
  }
}

/// Samples share batches only where sensors, features, their frames and terms agree.
TEST(Batches, AreOfOneLayoutEach) {
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
  ASSERT_EQ(problem.batches().size(), 5u);
  std::vector<int> samples;
  for (const auto& batches : problem.batches()) {
    EXPECT_EQ(std::ssize(problem.batches()[0].samples(0)), std::min(10, kLanesOfPacket));
    for (std::size_t b = 0; b < batches.size(); ++b) {
      for (const int n : batches.samples(b)) {
        EXPECT_EQ(n % 5, batches.samples(0)[0] % 5);
        samples.push_back(n);
      }
    }
  }
  std::sort(samples.begin(), samples.end());
  ASSERT_EQ(samples.size(), 50u);
  for (int n = 0; n < 50; ++n) EXPECT_EQ(samples[static_cast<std::size_t>(n)], n);
}

/// What no block takes is not evaluated and keeps no samples apart.
TEST(Batches, WhatNoBlockTakesDoesNotKeepSamplesApart) {
  Problem problem = test::scene_problem();
  problem.add_block("ground", PointToPlane(0, 0, 1, 0), {"camera"});
  const std::vector<double> zero(static_cast<std::size_t>(problem.table().size()), 0.0);
  auto samples = test::exact_samples(problem, zero, kLanesOfPacket);
  samples.back().observations.erase(samples.back().observations.begin());  // the arm
  for (const Sample& sample : samples) problem.add_sample(sample);
  ASSERT_EQ(problem.batches().size(), 1u);
  EXPECT_EQ(problem.batches()[0].size(), 1u);
  EXPECT_FALSE(problem.batches()[0].layout().sensors[0]);
  EXPECT_TRUE(problem.batches()[0].layout().sensors[1]);
}

}  // namespace
}  // namespace kinecal
