#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <limits>

#include "kinecal/errors.hpp"
#include "kinecal/evaluation/problem.hpp"
#include "support/repetitions.hpp"
#include "support/sums.hpp"

namespace kinecal {
namespace {

constexpr int kLanesOfPacket = kLanes<Packet>;
constexpr double kOrderOfSums = 1e-12;  // the same terms, added in another order

/// Camera against arm, the arm's points in the image, the camera's points on the ground.
template <class P>
void add_three_blocks(P& problem, const Loss& loss) {
  problem.add_block("hand_eye", PointToPoint{}, {"camera", "arm"}, {.scale = 2.0, .loss = loss});
  problem.add_block("reprojection", PointToPixel{}, {"arm", "eye"}, {.scale = 0.01});
  problem.add_block("ground", PointToPlane(0, 0, 1, 0), {"camera"}, {.scale = 0.5});
}

template <class S = Packet>
BasicProblem<S> three_blocks(const Loss& loss = {}) {
  BasicProblem<S> problem = test::scene_problem<S>();
  add_three_blocks(problem, loss);
  return problem;
}

/// Where the samples of this file are evaluated: a little beside where they are exact.
std::vector<double> near_values(const ParameterTable& table) {
  return test::random_values(table, 0.02, 5);
}

std::vector<Sample> near_samples(int count, const std::string& arm_frame = "hand") {
  const Problem problem = test::scene_problem();
  std::vector<double> truth = near_values(problem.table());
  for (std::size_t i = 0; i < truth.size(); ++i) truth[i] += 2e-3 * static_cast<double>(i % 3);
  return test::exact_samples(problem, truth, count, arm_frame);
}

/// Samples of many shapes: sensors that are absent, fewer features, features in the hand, on the
/// board and on both, features that are no numbers, at different places.
std::vector<Sample> mixed_samples(int count) {
  std::vector<Sample> samples = near_samples(count);
  const std::vector<Sample> on_board = near_samples(count, "board");
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (int n = 0; n < count; ++n) {
    Sample& sample = samples[static_cast<std::size_t>(n)];
    const Observation& board = on_board[static_cast<std::size_t>(n)].observations[0];
    Observation &arm = sample.observations[0], &camera = sample.observations[1],
                &eye = sample.observations[2];
    switch (n % 11) {
      case 1:  // no arm
        sample.observations.erase(sample.observations.begin());
        break;
      case 2:  // no camera
        sample.observations.erase(sample.observations.begin() + 1);
        break;
      case 3:  // fewer features
        for (Observation& seen : sample.observations) seen.features.pop_back();
        break;
      case 4:
        arm = board;
        break;
      case 5:  // on both, in turns
        arm.features[0] = board.features[0];
        arm.features[2] = board.features[2];
        break;
      case 6:
        arm.features[0].point.x() = nan;
        camera.features[1].point.z() = nan;
        break;
      case 7:
        camera.features[0].point.y() = nan;
        eye.features[3].point.x() = nan;
        break;
      case 8:  // all but one, and that one on the board
        for (std::size_t i = 0; i < 3; ++i) camera.features[i].point.setConstant(nan);
        arm.features[3] = board.features[3];
        break;
      case 9:  // the camera alone
        sample.observations = {camera};
        break;
      default:
        break;
    }
  }
  return samples;
}

NormalEquations sum_of_single_samples(const std::vector<Sample>& samples,
                                      const std::vector<double>& x, const FreeSet& free) {
  NormalEquations total(free.size());
  for (const Sample& sample : samples) {
    Problem one = three_blocks({LossType::huber, 0.02});
    one.add_sample(sample);
    total += normal_equations(one, x, &free);
  }
  return total;
}

TEST(Evaluate, APackThatIsNotFullCountsItsSamplesAndNothingElse) {
  for (int count = 1; count <= 2 * kLanesOfPacket + 1; ++count) {
    const std::vector<Sample> samples = near_samples(count);
    Problem problem = three_blocks({LossType::huber, 0.02});
    for (const Sample& sample : samples) problem.add_sample(sample);
    ASSERT_EQ(test::count_batches(problem), (count + kLanesOfPacket - 1) / kLanesOfPacket);
    const auto x = near_values(problem.table());
    const FreeSet free = test::all_free(problem.table());
    SCOPED_TRACE(std::to_string(count) + " samples");
    test::expect_same(normal_equations(problem, x, &free), sum_of_single_samples(samples, x, free),
                      kOrderOfSums);
    EXPECT_NEAR(normal_equations(problem, x, nullptr).cost,
                sum_of_single_samples(samples, x, free).cost,
                kOrderOfSums * normal_equations(problem, x, nullptr).cost);
  }
}

TEST(Evaluate, SamplesOfManyShapesCountAsIfEachWereAlone) {
  const std::vector<Sample> samples = mixed_samples(11 * (kLanesOfPacket + 1));
  Problem problem = three_blocks({LossType::huber, 0.02});
  test::OracleProblem oracle = test::oracle_of(problem);
  add_three_blocks(oracle, {LossType::huber, 0.02});
  for (const Sample& sample : samples) {
    problem.add_sample(sample);
    oracle.add_sample(sample);
  }
  const auto x = near_values(problem.table());
  const FreeSet free = test::all_free(problem.table());
  const NormalEquations all = normal_equations(problem, x, &free);
  test::expect_same(all, sum_of_single_samples(samples, x, free), kOrderOfSums);
  test::expect_same(all, oracle.multiplied_out(x, free), kOrderOfSums);
  BasicProblem<double> one_by_one = three_blocks<double>({LossType::huber, 0.02});
  for (const Sample& sample : samples) one_by_one.add_sample(sample);
  test::expect_same(all, normal_equations(one_by_one, x, &free), kOrderOfSums);
}

TEST(Evaluate, VisitsEachSampleOnceUnderItsOwnNumber) {
  const std::vector<Sample> samples = mixed_samples(11 * (kLanesOfPacket + 1));
  Problem problem = three_blocks();
  for (const Sample& sample : samples) problem.add_sample(sample);
  const auto x = near_values(problem.table());
  const FreeSet free = test::all_free(problem.table());
  const auto rows = test::rows_of(problem, x, &free);
  std::size_t expected = 0;
  Eigen::Index residuals = 0;
  for (int n = 0; n < std::ssize(samples); ++n) {
    Problem one = three_blocks();
    one.add_sample(samples[static_cast<std::size_t>(n)]);
    for (const auto& [key, alone] : test::rows_of(one, x, &free)) {
      const auto found = rows.find({key.first, n});
      ASSERT_NE(found, rows.end()) << "term " << key.first << ", sample " << n;
      const TermResiduals& together = found->second;
      ASSERT_EQ(together.residual.size(), alone.residual.size());
      // The same arithmetic in another lane: the same bytes.
      EXPECT_TRUE(together.residual == alone.residual) << "sample " << n;
      EXPECT_TRUE(together.jacobian == alone.jacobian) << "sample " << n;
      residuals += alone.residual.size();
      ++expected;
    }
  }
  EXPECT_GT(expected, samples.size()) << "most samples have two terms or more";
  EXPECT_EQ(rows.size(), expected);
  EXPECT_EQ(problem.num_residuals(), residuals);
}

TEST(Evaluate, AFeatureThatIsNotANumberCountsAsIfItWereNotThere) {
  std::vector<Sample> samples = near_samples(2 * kLanesOfPacket + 1);
  std::vector<Sample> without = samples;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (std::size_t n = 0; n < samples.size(); ++n) {
    // Each in a place of its own, so that lanes of one pack differ.
    const std::size_t i = n % 4;
    samples[n].observations[n % 3].features[i].point(static_cast<int>(n % 2)) = nan;
    for (Observation& seen : without[n].observations) {
      seen.features.erase(seen.features.begin() + static_cast<std::ptrdiff_t>(i));
    }
  }
  Problem some = test::scene_problem(), fewer = test::scene_problem();
  test::OracleProblem oracle = test::oracle_of(some);
  oracle.add_block("hand_eye", PointToPoint{}, {"camera", "arm"}, {});
  for (const Sample& s : samples) oracle.add_sample(s);
  for (Problem* problem : {&some, &fewer}) {
    problem->add_block("hand_eye", PointToPoint{}, {"camera", "arm"}, {});
    for (const Sample& s : problem == &some ? samples : without) problem->add_sample(s);
  }
  const auto x = near_values(some.table());
  const FreeSet free = test::all_free(some.table());
  const NormalEquations found = normal_equations(some, x, &free);
  // A sample whose eye misses a feature keeps it between camera and arm.
  double cost = normal_equations(fewer, x, nullptr).cost;
  for (const auto& [key, rows] : test::rows_of(some, x, nullptr)) {
    const auto n = static_cast<std::size_t>(key.second);
    if (n % 3 != 2) {
      EXPECT_EQ(rows.residual.size(), 9);
      continue;
    }
    ASSERT_EQ(rows.residual.size(), 12);
    cost += 0.5 * rows.residual.segment<3>(static_cast<Eigen::Index>(3 * (n % 4))).squaredNorm();
  }
  EXPECT_NEAR(found.cost, cost, kOrderOfSums * cost);
  test::expect_same(found, oracle.multiplied_out(x, free), kOrderOfSums);
}

void expect_same_bytes(const NormalEquations& a, const NormalEquations& b) {
  const auto same = [](const auto& u, const auto& v) {
    return u.size() == v.size() &&
           std::memcmp(u.data(), v.data(), sizeof(double) * static_cast<std::size_t>(u.size())) ==
               0;
  };
  EXPECT_EQ(std::memcmp(&a.cost, &b.cost, sizeof(double)), 0) << a.cost << " and " << b.cost;
  EXPECT_TRUE(same(a.gradient, b.gradient));
  EXPECT_TRUE(same(a.hessian, b.hessian))
      << "largest difference " << (a.hessian - b.hessian).cwiseAbs().maxCoeff();
}

template <class S>
void expect_the_same_for_any_threads(const BasicProblem<S>& problem) {
  const auto x = near_values(problem.table());
  const FreeSet free = test::all_free(problem.table());
  const NormalEquations one = normal_equations(problem, x, &free, Losses::as_given, 1);
  const std::vector<int> counts = {7, 2, 3};
  for (int i = 0; i < test::repetitions(3, 1); ++i) {
    const int threads = counts[static_cast<std::size_t>(i)];
    SCOPED_TRACE(std::to_string(threads) + " threads");
    Evaluator<S> evaluator(problem, free, threads);
    expect_same_bytes(evaluator.normal_equations(x), one);
    constexpr double kSums = 1e-13;  // of 5000 samples, in the same order
    EXPECT_NEAR(evaluator.normal_equations(x, false).cost, one.cost, kSums * one.cost);
    expect_same_bytes(evaluator.normal_equations(x), one);  // what it keeps changes nothing
  }
}

/// 5000 samples: five pieces of packs, the last of them not full.
template <class S>
BasicProblem<S> five_thousand(const std::vector<Sample>& samples) {
  BasicProblem<S> problem = three_blocks<S>({LossType::cauchy, 0.02});
  for (std::size_t n = 0; n < 5000; ++n) problem.add_sample(samples[n % samples.size()]);
  return problem;
}

/// Fifty times the same hundred samples, which are a piece of their own.
TEST(Evaluate, SeveralPiecesCountAllSamples) {
  const std::vector<Sample> samples = mixed_samples(100);
  const Problem pieces = five_thousand<Packet>(samples);
  Problem one_piece = three_blocks({LossType::cauchy, 0.02});
  for (const Sample& sample : samples) one_piece.add_sample(sample);
  const auto x = near_values(pieces.table());
  const FreeSet free = test::all_free(pieces.table());
  NormalEquations expected = normal_equations(one_piece, x, &free);
  expected.cost *= 50.0;
  expected.gradient *= 50.0;
  expected.hessian *= 50.0;
  test::expect_same(normal_equations(pieces, x, &free), expected, kOrderOfSums);
}

TEST(Evaluate, GivesTheSameBytesForAnyNumberOfThreads) {
  expect_the_same_for_any_threads(five_thousand<Packet>(near_samples(101)));
}

TEST(Evaluate, GivesTheSameBytesForAnyNumberOfThreadsWithSamplesOfManyShapes) {
  expect_the_same_for_any_threads(five_thousand<Packet>(mixed_samples(101)));
}

/// A thread that meets the board before the hand adds up their sums all the same in one order.
TEST(Evaluate, GivesTheSameBytesInWhateverOrderAThreadMeetsTheChains) {
  Problem problem = test::scene_problem();
  problem.add_block("hand_eye", PointToPoint{}, {"camera", "arm"}, {.scale = 2.0});
  problem.add_block("reprojection", PointToPixel{}, {"arm", "eye"}, {.scale = 0.01});
  const auto in_hand = near_samples(50), on_board = near_samples(50, "board");
  // The first pack, and with it the first piece, is of the hand; the other pieces start with the
  // board: hand, hand, board, hand, board, ...
  Sample first = in_hand[0];
  for (Observation& seen : first.observations) seen.features.pop_back();
  problem.add_sample(first);
  for (std::size_t n = 0; n < 5000; ++n) {
    problem.add_sample((n % 2 == 0 ? in_hand : on_board)[n % 50]);
  }
  expect_the_same_for_any_threads(problem);
}

TEST(Evaluate, RefusesFewerValuesThanParameters) {
  Problem problem = test::scene_problem();
  problem.add_block("b", PointToPoint{}, {"camera", "arm"});
  const std::vector<double> few(static_cast<std::size_t>(problem.table().size()) - 1, 0.0);
  const auto evaluator = problem.evaluator(FreeSet({}, problem.table().size()));
  EXPECT_THROW((void)evaluator->normal_equations(few), std::invalid_argument);
  EXPECT_THROW((void)evaluator->evaluate(few, false, [](int, int, auto&) {}),
               std::invalid_argument);
}

// An evaluator does not outlive its problem.
static_assert(std::is_constructible_v<Evaluator<double>, const BasicProblem<double>&, FreeSet>);
static_assert(!std::is_constructible_v<Evaluator<double>, BasicProblem<double>, FreeSet>);

TEST(Evaluate, AProblemWithoutSamplesCostsNothing) {
  for (const int threads : {0, 1, 7}) {
    const Problem problem = three_blocks();
    const auto x = near_values(problem.table());
    const FreeSet free = test::all_free(problem.table());
    Evaluator<Packet> evaluator(problem, free, threads);
    const NormalEquations normal = evaluator.normal_equations(x);
    EXPECT_EQ(normal.cost, 0.0);
    EXPECT_TRUE(normal.gradient.isZero(0.0));
    EXPECT_TRUE(normal.hessian.isZero(0.0));
    EXPECT_EQ(evaluator.normal_equations(x, false).cost, 0.0);
    EXPECT_EQ(undefined_residual(problem, x), std::nullopt);
    EXPECT_EQ(problem.num_residuals(), 0);
    EXPECT_TRUE(problem.touched_parameters().empty());
  }
}

TEST(Evaluate, ASampleThatNoBlockTakesCostsNothing) {
  Problem problem = three_blocks();
  Sample sample = near_samples(1)[0];
  sample.observations = {sample.observations[2]};  // the eye alone
  problem.add_sample(sample);
  const auto x = near_values(problem.table());
  const FreeSet free = test::all_free(problem.table());
  EXPECT_EQ(normal_equations(problem, x, &free).cost, 0.0);
  EXPECT_EQ(problem.num_samples(), 1);
  EXPECT_EQ(problem.num_residuals(), 0);
}

TEST(Evaluate, APriorWithoutSamplesCostsNothing) {
  Problem problem = three_blocks();
  problem.add_prior("restrict", {"camera_joint", 0.0, 2.0, 3.0}, {});
  const auto x = near_values(problem.table());
  const FreeSet free = test::all_free(problem.table());
  EXPECT_EQ(normal_equations(problem, x, &free).cost, 0.0);
}

// Residuals that are not defined.

/// The features of the arm as far behind the camera as they were in front of it.
Sample behind_the_camera(Sample sample, const Problem& problem, std::span<const double> values,
                         const std::vector<std::size_t>& features = {0, 1, 2, 3}) {
  const Pose<double> hand_T_camera =
      test::tip_pose(problem, 0, "hand", sample, values).inverse() *
      test::tip_pose(problem, 1, "camera_optical_frame", sample, values);
  for (const std::size_t i : features) {
    Vector3<double>& point = sample.observations[0].features[i].point;
    point = hand_T_camera * Vector3<double>(-(hand_T_camera.inverse() * point));
  }
  return sample;
}

template <class P>
void add_sights(P& problem, const Loss& loss) {
  problem.add_block("hand_eye", PointToPoint{}, {"camera", "arm"}, {.loss = loss});
  problem.add_block("reprojection", PointToPixel{}, {"arm", "eye"}, {.scale = 0.01, .loss = loss});
}

Problem sights(const Loss& loss) {
  Problem problem = test::scene_problem();
  add_sights(problem, loss);
  return problem;
}

class Undefined : public testing::TestWithParam<LossType> {};

TEST_P(Undefined, InOneLaneIsNamedAndLeavesTheOthersDefined) {
  const int count = 2 * kLanesOfPacket + 1;
  const std::vector<Sample> samples = near_samples(count);
  for (int bad = 0; bad < count; ++bad) {
    for (const std::size_t feature : {0u, 3u}) {
      Problem problem = sights({GetParam(), 0.05});
      const auto x = near_values(problem.table());
      for (int n = 0; n < count; ++n) {
        const Sample& sample = samples[static_cast<std::size_t>(n)];
        problem.add_sample(n == bad ? behind_the_camera(sample, problem, x, {feature}) : sample);
      }
      const FreeSet free = test::all_free(problem.table());
      EXPECT_FALSE(std::isfinite(normal_equations(problem, x, nullptr).cost));
      EXPECT_FALSE(std::isfinite(normal_equations(problem, x, &free).cost));
      const auto undefined = undefined_residual(problem, x);
      ASSERT_TRUE(undefined.has_value());
      EXPECT_EQ(undefined->term, "reprojection");
      EXPECT_EQ(undefined->source, "scene:" + std::to_string(bad));
      const auto rows = test::rows_of(problem, x, &free);
      EXPECT_EQ(std::ssize(rows), 2 * count - 1);
      EXPECT_FALSE(rows.contains({1, bad}));
      for (const auto& [key, of_sample] : rows) {
        EXPECT_TRUE(of_sample.residual.allFinite() && of_sample.jacobian.allFinite());
        if (key.first == 1) {
          EXPECT_EQ(of_sample.residual.size(), 8);
        }
      }
    }
  }
}

TEST_P(Undefined, IsTheCostOfAnInfiniteValue) {
  Problem problem = three_blocks({GetParam(), 0.05});
  for (const Sample& sample : near_samples(3)) problem.add_sample(sample);
  const FreeSet free = test::all_free(problem.table());
  for (const double value :
       {std::numeric_limits<double>::infinity(), std::numeric_limits<double>::quiet_NaN()}) {
    for (const char* name : {"camera_z_offset", "camera_joint_x", "elbow", "eye_fx"}) {
      auto x = near_values(problem.table());
      x[static_cast<std::size_t>(problem.table().index(name))] = value;
      EXPECT_FALSE(std::isfinite(normal_equations(problem, x, nullptr).cost)) << name;
      EXPECT_FALSE(std::isfinite(normal_equations(problem, x, &free).cost)) << name;
      const auto undefined = undefined_residual(problem, x);
      ASSERT_TRUE(undefined.has_value()) << name;
      EXPECT_EQ(undefined->source, "scene:0");
    }
  }
}

/// A residual so large that its square is not a number: a bounded loss must not hide it.
TEST_P(Undefined, IsTheCostOfAResidualThatOverflows) {
  Problem problem = test::scene_problem();
  problem.add_block("hand_eye", PointToPoint{}, {"camera", "arm"}, {.loss = {GetParam(), 0.05}});
  std::vector<Sample> samples = near_samples(kLanesOfPacket);
  samples.back().observations[0].features[1].point.x() = 1e200;
  for (const Sample& sample : samples) problem.add_sample(sample);
  const auto x = near_values(problem.table());
  const FreeSet free = test::all_free(problem.table());
  EXPECT_FALSE(std::isfinite(normal_equations(problem, x, nullptr).cost));
  EXPECT_FALSE(std::isfinite(normal_equations(problem, x, &free).cost));
}

/// What the eye did not see cannot be undefined: it may well be behind the camera.
TEST_P(Undefined, IsNotAPointBehindACameraThatDidNotSeeIt) {
  const int count = kLanesOfPacket + 1;
  const std::vector<Sample> samples = near_samples(count);
  for (const std::size_t feature : {0u, 2u}) {
    Problem problem = sights({GetParam(), 0.05});
    test::OracleProblem oracle = test::oracle_of(problem);
    add_sights(oracle, {GetParam(), 0.05});
    const auto x = near_values(problem.table());
    for (const Sample& sample : samples) {
      Sample unseen = behind_the_camera(sample, problem, x, {feature});
      unseen.observations[2].features[feature].point.setConstant(
          std::numeric_limits<double>::quiet_NaN());
      problem.add_sample(unseen);
      oracle.add_sample(unseen);
    }
    const FreeSet free = test::all_free(problem.table());
    EXPECT_EQ(undefined_residual(problem, x), std::nullopt);
    const NormalEquations normal = normal_equations(problem, x, &free);
    EXPECT_TRUE(std::isfinite(normal.cost)) << "feature " << feature;
    EXPECT_TRUE(std::isfinite(normal_equations(problem, x, nullptr).cost)) << "feature " << feature;
    EXPECT_TRUE(normal.gradient.allFinite() && normal.hessian.allFinite());
    test::expect_same(normal, oracle.multiplied_out(x, free), kOrderOfSums);
  }
}

INSTANTIATE_TEST_SUITE_P(WithAnyLoss, Undefined,
                         testing::Values(LossType::none, LossType::huber, LossType::cauchy,
                                         LossType::tukey));

}  // namespace
}  // namespace kinecal
