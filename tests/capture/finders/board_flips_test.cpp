#include "kinecal/capture/finders/board_flips.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "kinecal/capture/boards/board_order.hpp"
#include "kinecal/study/seeded_random.hpp"
#include "support/board_images.hpp"

namespace kinecal {
namespace {

using kinecal::test::camera_640;
using kinecal::test::pixel_of;

Pose<double> random_pose(SeededRandom& random, double angle) {
  Pose<double> pose;
  pose.rotation =
      Eigen::AngleAxisd(random.uniform(-angle, angle), random.direction()).toRotationMatrix();
  pose.translation = 0.3 * random.normal_vector();
  return pose;
}

/// A session: a board on a link, seen in many poses by a camera on another.  Neither mount is known.
struct Session {
  CheckerboardSettings board;
  std::vector<Sample> samples;
  std::vector<Pose<double>> links;  ///< by joints that are wrong by some degrees
};

Session session(int columns, int rows, int count, CornerKind kind, unsigned seed) {
  SeededRandom random(seed);
  Session s;
  s.board = {columns, rows, 0.03, {}};
  s.board.target.corners = kind;
  const Pose<double> link_T_board = random_pose(random, 3.0),
                     camera_link_T_camera = random_pose(random, 3.0);
  const Vector3<double> middle((columns - 1) * 0.015, (rows - 1) * 0.015, 0.0);
  for (int i = 0; i < count; ++i) {
    const Pose<double> camera_T_board = kinecal::test::facing(
        {random.uniform(-0.1, 0.1), random.uniform(-0.1, 0.1), random.uniform(0.4, 0.8)},
        random.uniform(-0.6, 0.6), random.uniform(-0.6, 0.6), random.uniform(-0.7, 0.7), middle);
    Pose<double> error;
    error.rotation =
        Eigen::AngleAxisd(random.uniform(0.0, 0.05), random.direction()).toRotationMatrix();
    s.links.push_back(link_T_board * camera_T_board.inverse() * camera_link_T_camera.inverse() *
                      error);
    Sample sample;
    Observation camera{"camera", {}, camera_640()}, arm{"arm", {}, {}};
    for (int k = 0; k < columns * rows; ++k) {
      const Vector3<double> p((k % columns) * 0.03, (k / columns) * 0.03, 0.0);
      const Eigen::Vector2d pixel = pixel_of(camera_640(), camera_T_board, p);
      const Vector3<double> noise = random.normal_vector();
      const Vector3<double> seen =
          kind == CornerKind::pixels
              ? Vector3<double>(pixel.x() + 0.2 * noise.x(), pixel.y() + 0.2 * noise.y(), 0.0)
              : Vector3<double>(camera_T_board * p + 0.002 * noise);
      camera.features.push_back({"optical", seen, {}, {}, k});
      arm.features.push_back({"checkerboard", p, {}, {}, k});
    }
    sample.observations = {camera, arm};
    s.samples.push_back(sample);
  }
  return s;
}

/// Renumbers the camera's corners of some samples, as a finder would that sees the board turned.
void turn(Session& s, std::size_t i, int turns) {
  auto& features = s.samples[i].observations[0].features;
  const auto seen = features;
  const auto order = turned_order(s.board.points_x, s.board.points_y, turns);
  for (std::size_t k = 0; k < order.size(); ++k) {
    features[k] = seen[order[k]];
    features[k].id = static_cast<int>(k);
  }
}

/// Number of samples whose camera features are not those of the truth.
int wrong(const Session& s, const Session& truth) {
  int count = 0;
  for (std::size_t i = 0; i < s.samples.size(); ++i) {
    const auto &a = s.samples[i].observations[0].features,
               &b = truth.samples[i].observations[0].features;
    if (a[0].point != b[0].point || a.back().point != b.back().point) ++count;
  }
  return count;
}

TEST(BoardFlips, GridsOfDiscsLookAlikeUnlessTheyAreAsymmetricWithAnOddNumberOfRows) {
  const auto turns = [](int columns, int rows, bool asymmetric) {
    return alike_board(CircleGridSettings{columns, rows, 0.02, asymmetric, {}}).turns;
  };
  EXPECT_EQ(turns(4, 11, true), 4);
  EXPECT_EQ(turns(4, 10, true), 2);
  EXPECT_EQ(turns(7, 6, false), 2);
  EXPECT_EQ(turns(6, 6, false), 1);
}

TEST(BoardFlips, SymmetricGridsOfDiscsArePutRight) {
  Session s =
      session(7, 6, 20, CornerKind::pixels, 4);  // as a checkerboard, it would not look alike
  const Session truth = s;
  for (const std::size_t i : {1u, 4u, 5u, 11u}) turn(s, i, 2);
  ASSERT_EQ(wrong(s, truth), 4);
  const CircleGridSettings grid{7, 6, 0.03, false, s.board.target};
  const Flips flips = resolve_flips(s.samples, alike_board(grid), s.links);
  EXPECT_EQ(wrong(s, truth), 0);
  EXPECT_TRUE(flips.undecided.empty());
}

TEST(BoardFlips, AllSamplesShowTheBoardTheSameWayRoundThoughNoMountIsKnown) {
  for (const CornerKind kind : {CornerKind::pixels, CornerKind::points}) {
    for (unsigned seed = 1; seed < 6; ++seed) {
      Session s = session(7, 5, 20, kind, seed);
      const Session truth = s;
      for (const std::size_t i : {1u, 4u, 5u, 11u, 13u, 17u, 19u}) turn(s, i, 2);
      EXPECT_GT(wrong(s, truth), 5);
      const Flips flips = resolve_flips(s.samples, alike_board(s.board), s.links);
      EXPECT_EQ(wrong(s, truth), 0) << "seed " << seed;
      EXPECT_EQ(std::count(flips.quarter_turns.begin(), flips.quarter_turns.end(), 2), 7);
      EXPECT_TRUE(flips.undecided.empty());
    }
  }
}

TEST(BoardFlips, ASquareBoardWithAnEvenNumberOfCornersHasFourWays) {
  Session s = session(6, 6, 20, CornerKind::pixels, 9);
  const Session truth = s;
  for (std::size_t i = 0; i < 9; ++i) turn(s, 2 * i, static_cast<int>(i % 3) + 1);
  (void)resolve_flips(s.samples, alike_board(s.board), s.links);
  EXPECT_EQ(wrong(s, truth), 0);
}

TEST(BoardFlips, WhatMostSamplesHaveStays) {
  Session s = session(7, 5, 9, CornerKind::pixels, 3);
  for (std::size_t i = 0; i < 8; ++i) turn(s, i, 2);
  const Flips flips = resolve_flips(s.samples, alike_board(s.board), s.links);
  EXPECT_EQ(flips.quarter_turns, (std::vector<int>{0, 0, 0, 0, 0, 0, 0, 0, 2}));
}

TEST(BoardFlips, ABoardWhoseColoursTellItIsNotTurned) {
  Session s = session(5, 4, 6, CornerKind::pixels, 3);
  turn(s, 2, 2);
  const Session before = s;
  (void)resolve_flips(s.samples, alike_board(s.board), s.links);
  EXPECT_EQ(wrong(s, before), 0);
}

TEST(BoardFlips, SamplesWithoutTheBoardAreLeftAlone) {
  Session s = session(7, 5, 6, CornerKind::pixels, 3);
  s.samples[1].observations.clear();
  s.samples[3].observations[0].features.pop_back();
  const Flips flips = resolve_flips(s.samples, alike_board(s.board), s.links);
  EXPECT_EQ(flips.quarter_turns, std::vector<int>(6, 0));
  EXPECT_THROW(resolve_flips(s.samples, alike_board(s.board), std::vector<Pose<double>>(2)),
               std::invalid_argument);
}

TEST(BoardFlips, TwoSamplesOfAnArmThatOnlyTurnedAboutTheBoardsNormalByAQuarterAreUndecided) {
  Session s = session(7, 5, 2, CornerKind::pixels, 3);
  // Turned by 90 degrees one way or the other: the joints alone cannot say which.
  s.samples[1] = s.samples[0];
  Pose<double> quarter;
  quarter.rotation =
      Eigen::AngleAxisd(std::numbers::pi / 2, Vector3<double>::UnitZ()).toRotationMatrix();
  s.links[1] = s.links[0] * quarter;
  EXPECT_FALSE(resolve_flips(s.samples, alike_board(s.board), s.links).undecided.empty());
}

}  // namespace
}  // namespace kinecal
