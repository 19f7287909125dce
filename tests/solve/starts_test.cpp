#include "kinecal/solve/starts.hpp"

#include <gtest/gtest.h>

#include "kinecal/errors.hpp"
#include "support/repetitions.hpp"
#include "support/scene.hpp"

namespace kinecal {
namespace {

using Vector6 = Eigen::Matrix<double, 6, 1>;
const std::vector<std::string> kJoints = {"shoulder_lift", "elbow", "head_tilt"};

UnknownFrame board(const ParameterTable& table, bool has_guess = false) {
  UnknownFrame frame{"board"};
  for (std::size_t k = 0; k < 6; ++k) {
    frame.axes[k] = table.index(parameter_name("board", kFrameAxes[k]));
  }
  frame.has_guess = has_guess;
  return frame;
}

/// Joints and the board.
FreeSet all_free(const ParameterTable& table) {
  std::vector<int> free;
  for (const std::string& joint : kJoints) free.push_back(table.index(joint));
  for (const int p : board(table).axes) free.push_back(p);
  return FreeSet(free, table.size());
}

/// Joints that are 2 degrees off, and a board beyond the hand; 1 mm of noise.
Problem board_problem(const Vector6& pose, int samples, unsigned seed = 1) {
  Problem problem = test::scene_problem();
  problem.add_block("hand_eye", PointToPoint{}, {"camera", "arm"});
  const ParameterTable& table = problem.table();
  std::vector<double> truth(static_cast<std::size_t>(table.size()), 0.0);
  for (const std::string& joint : kJoints)
    truth[static_cast<std::size_t>(table.index(joint))] = 0.035;
  for (int k = 0; k < 6; ++k) {
    truth[static_cast<std::size_t>(table.index("board_x") + k)] = pose(k);
  }
  std::mt19937 random(seed);
  std::normal_distribution<double> normal(0.0, 1e-3);
  for (Sample& sample : test::exact_samples(problem, truth, samples, "board", seed)) {
    for (Feature& feature : sample.observations[1].features) {
      feature.point += Vector3<double>{normal(random), normal(random), normal(random)};
    }
    problem.add_sample(sample);
  }
  return problem;
}

/// A result with its values.
struct Ended {
  StepResult result;
  Eigen::VectorXd values;
};
Ended search(const Problem& problem, bool has_guess = false, int random = 0, int threads = 1,
             const AnyProblem* excerpt = nullptr) {
  Ended ended{{}, Eigen::VectorXd::Zero(problem.table().size())};
  SolveOptions options;
  options.threads = threads;
  options.random_starts = random;
  const std::vector<UnknownFrame> unknown = {board(problem.table(), has_guess)};
  ended.result = solve_from_starts(problem, all_free(problem.table()), ended.values, options,
                                   unknown, excerpt);
  return ended;
}
Ended plain(const Problem& problem) {
  Ended ended{{}, Eigen::VectorXd::Zero(problem.table().size())};
  ended.result = solve(problem, all_free(problem.table()), ended.values);
  return ended;
}

const Vector6 kNear = (Vector6() << 0.02, 0.0, 0.01, 0.05, 0.0, -0.05).finished();
const Vector6 kFar = (Vector6() << 4.0, -7.0, 2.0, 1.9, -1.4, 1.6).finished();

TEST(Starts, FindAFrameAnywhere) {
  const double cost_near = plain(board_problem(kNear, 30)).result.final_cost;
  for (int turn = 0; turn < test::repetitions(12, 3); ++turn) {
    Vector6 pose = kFar;
    pose.tail<3>() = 0.26 * turn * Vector3<double>(2, turn % 3 - 1, 2).normalized();
    const Ended ended = search(board_problem(pose, 30));
    EXPECT_TRUE(ended.result.converged) << ended.result.termination;
    // Where the board is changes the arm's points by rounding only, and neither noise nor camera.
    EXPECT_NEAR(ended.result.final_cost / cost_near, 1.0, 1e-6) << turn;
    const StartSummary& starts = ended.result.starts;
    EXPECT_EQ(starts.starts, 60);
    EXPECT_EQ(starts.frames, std::vector<std::string>{"board"});
    ASSERT_EQ(starts.taken, 0);
    EXPECT_NEAR(starts.minima[0].cost / ended.result.final_cost, 1.0, 1e-6);
  }
}

TEST(Starts, FromFewSamplesFindItAsWell) {
  const Problem all = board_problem(kFar, 40), few = board_problem(kFar, 6, 3);
  const Ended ended = search(all, false, 0, 1, &few);
  EXPECT_NEAR(ended.result.final_cost / search(all).result.final_cost, 1.0, 1e-9);
}

TEST(Starts, KeepThePlainStartByteForByteWhereItIsAsGood) {
  const Problem problem = board_problem(kNear, 20);
  const Ended usual = plain(problem), ended = search(problem);
  EXPECT_TRUE(usual.values == ended.values);
  EXPECT_EQ(usual.result.final_cost, ended.result.final_cost);
  EXPECT_TRUE(ended.result.starts.searched());
}

TEST(Starts, AGuessThatEndsWellIsNotDoubted) {
  EXPECT_FALSE(search(board_problem(kNear, 20), true).result.starts.searched());
}

TEST(Starts, AGuessThatEndsBadlyIsDoubted) {
  const Ended ended = search(board_problem(kFar, 20), true);
  EXPECT_TRUE(ended.result.starts.searched());
  EXPECT_EQ(ended.result.starts.given, std::vector<std::string>{"board"});
  EXPECT_TRUE(ended.result.starts.frames.empty()) << "it was not unknown";
  EXPECT_NEAR(ended.result.final_cost / search(board_problem(kFar, 20)).result.final_cost, 1.0,
              1e-6);
}

TEST(Starts, GiveTheSameBytesForAnyNumberOfThreads) {
  const Problem problem = board_problem(kFar, 20);
  const Ended one = search(problem, false, 5, 1), three = search(problem, false, 5, 3);
  EXPECT_TRUE(one.values == three.values);
  EXPECT_EQ(to_string(one.result.starts), to_string(three.result.starts));
}

TEST(Starts, AtRandomEndAtTheSameMinimum) {
  const Ended ended = search(board_problem(kNear, 20), true, 8);
  const StartSummary& starts = ended.result.starts;
  EXPECT_EQ(starts.random_starts, 8);
  EXPECT_EQ(starts.starts, 0);
  ASSERT_EQ(starts.minima.size(), 1u);
  EXPECT_EQ(starts.minima[0].solves, 9) << "the plain one and eight at random";
  EXPECT_EQ(starts.failed, 0);
  EXPECT_TRUE(ended.values == plain(board_problem(kNear, 20)).values);
}

TEST(Starts, SayHowManyAreDone) {
  const Problem problem = board_problem(kNear, 20);
  Eigen::VectorXd values = Eigen::VectorXd::Zero(problem.table().size());
  std::vector<double> done;
  SolveOptions options;
  options.threads = 2;
  options.random_starts = 4;
  options.meter = [&](double fraction, const std::string&) { done.push_back(fraction); };
  (void)solve_from_starts(problem, all_free(problem.table()), values, options, {});
  EXPECT_EQ(done, (std::vector<double>{0.25, 0.5, 0.75, 1.0}));
}

TEST(Starts, ThatFailLeaveTheValuesAlone) {
  const Problem problem = board_problem(kNear, 1);
  Eigen::VectorXd values = Eigen::VectorXd::Zero(problem.table().size());
  std::vector<int> all;
  for (int p = 0; p < problem.table().size(); ++p) all.push_back(p);
  const std::vector<UnknownFrame> unknown = {board(problem.table())};
  const StepResult result =
      solve_from_starts(problem, FreeSet(all, problem.table().size()), values, {}, unknown);
  EXPECT_FALSE(result.converged);
  EXPECT_TRUE(result.termination.starts_with("failed: 12 residuals cannot determine"))
      << result.termination;
  EXPECT_TRUE(values.isZero(0.0));
  EXPECT_TRUE(result.starts.minima.empty());
  EXPECT_EQ(result.starts.taken, -1);
}

}  // namespace
}  // namespace kinecal
