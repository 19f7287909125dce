#include "kinecal/solve/fit_frames.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "kinecal/errors.hpp"
#include "support/scene.hpp"

namespace kinecal {
namespace {

using Vector6 = Eigen::Matrix<double, 6, 1>;

/// The board of the scene, with the axes that are free.
UnknownFrame board(const ParameterTable& table, const std::string& free = "xyzabc") {
  UnknownFrame frame{"board"};
  for (std::size_t k = 0; k < 6; ++k) {
    if (free.find(kFrameAxes[k]) == std::string::npos) continue;
    frame.axes[k] = table.index(parameter_name("board", kFrameAxes[k]));
  }
  return frame;
}

/// Camera against points of a board that is somewhere beyond the hand.
Problem board_problem(const Vector6& pose, int samples) {
  Problem problem = test::scene_problem();
  problem.add_block("hand_eye", PointToPoint{}, {"camera", "arm"});
  std::vector<double> truth(static_cast<std::size_t>(problem.table().size()), 0.0);
  const int first = problem.table().index("board_x");
  for (int k = 0; k < 6; ++k) truth[static_cast<std::size_t>(first + k)] = pose(k);
  for (const Sample& sample : test::exact_samples(problem, truth, samples, "board")) {
    problem.add_sample(sample);
  }
  return problem;
}

Vector6 pose_of(const ParameterTable& table, const Eigen::VectorXd& values) {
  return values.segment<6>(table.index("board_x"));
}

TEST(FitFrames, FindsAFrameAnywhere) {
  for (const double turn : {0.1, 1.5, 3.0, std::numbers::pi}) {
    Vector6 pose;
    pose << 3.0, -5.0, 1.0, turn * Vector3<double>(2, -1, 2) / 3.0;
    const Problem problem = board_problem(pose, 6);
    const std::vector<UnknownFrame> frames = {board(problem.table())};
    const detail::FrameFits all =
        detail::fit_frames(problem, frames, Eigen::VectorXd::Zero(problem.table().size()), 1);
    EXPECT_EQ(all.starts % 60, 0);
    const auto& fits = all.minima;
    ASSERT_FALSE(fits.empty());
    const Vector6 found = pose_of(problem.table(), fits[0].values);
    EXPECT_TRUE(found.head<3>().isApprox(pose.head<3>(), 1e-4)) << found.transpose();
    EXPECT_TRUE(
        exp(Vector3<double>(found.tail<3>())).isApprox(exp(Vector3<double>(pose.tail<3>())), 1e-4));
    EXPECT_LT(fits[0].cost, 1e-8);
    for (std::size_t i = 1; i < fits.size(); ++i) EXPECT_GE(fits[i].cost, fits[i - 1].cost);
  }
}

TEST(FitFrames, AQuickSearchEndsAtTheSameMinimum) {
  for (const double turn : {0.1, 1.5, 3.0, std::numbers::pi}) {
    Vector6 pose;
    pose << 3.0, -5.0, 1.0, turn * Vector3<double>(2, -1, 2) / 3.0;
    const Problem problem = board_problem(pose, 6);
    const detail::FrameFits fits =
        detail::fit_frames(problem, std::vector{board(problem.table())},
                           Eigen::VectorXd::Zero(problem.table().size()), 1, kQuickSearch);
    EXPECT_EQ(fits.starts, kQuickSearch.starts);
    ASSERT_FALSE(fits.minima.empty());
    EXPECT_LT(fits.minima[0].cost, 1e-8) << turn;
  }
}

TEST(FitFrames, TurnsOnlyAboutFreeAxes) {
  Vector6 pose;
  pose << 0.5, 0.2, 0.0, 0.0, 0.0, 2.8;
  const Problem problem = board_problem(pose, 6);
  const std::vector<UnknownFrame> frames = {board(problem.table(), "xyc")};
  const auto fits =
      detail::fit_frames(problem, frames, Eigen::VectorXd::Zero(problem.table().size()), 1).minima;
  ASSERT_FALSE(fits.empty());
  const Vector6 found = pose_of(problem.table(), fits[0].values);
  EXPECT_TRUE(found.isApprox(pose, 1e-4)) << found.transpose();
  EXPECT_EQ(found(3), 0.0);
}

TEST(FitFrames, GivesTheSameBytesForAnyNumberOfThreads) {
  Vector6 pose;
  pose << 1.0, 0.2, 0.3, 1.0, -2.0, 0.5;
  const Problem problem = board_problem(pose, 5);
  const std::vector<UnknownFrame> frames = {board(problem.table())};
  const Eigen::VectorXd from = Eigen::VectorXd::Zero(problem.table().size());
  const auto one = detail::fit_frames(problem, frames, from, 1).minima,
             three = detail::fit_frames(problem, frames, from, 3).minima;
  ASSERT_EQ(one.size(), three.size());
  for (std::size_t i = 0; i < one.size(); ++i) {
    EXPECT_TRUE(one[i].values == three[i].values);
    EXPECT_EQ(one[i].starts, three[i].starts);
  }
}

TEST(FitFrames, FramesThatOnlyShiftNeedNoStarts) {
  const ParameterTable table = test::scene_table();
  const UnknownFrame turns = board(table), shifts = board(table, "xyz");
  EXPECT_TRUE(detail::any_turns(std::vector{turns}));
  EXPECT_TRUE(detail::any_turns(std::vector{shifts, turns}));
  EXPECT_FALSE(detail::any_turns(std::vector{shifts}));
}

}  // namespace
}  // namespace kinecal
