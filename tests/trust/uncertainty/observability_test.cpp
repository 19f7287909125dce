#include "kinecal/trust/uncertainty/observability.hpp"

#include <gtest/gtest.h>

#include <Eigen/SVD>
#include <algorithm>
#include <set>

#include "kinecal/errors.hpp"
#include "kinecal/evaluation/problem.hpp"
#include "kinecal/solve/stack.hpp"
#include "support/calibrated.hpp"
#include "support/data.hpp"
#include "support/oracle_problem.hpp"
#include "support/repetitions.hpp"

namespace kinecal {
namespace {

Observability of(const test::Calibrated& c) {
  const Eigen::VectorXd values = c.result.table.values();
  const CalibrationStep& step = c.calibration.steps[0];
  return observability(*step.problem, step.free,
                       {values.data(), static_cast<std::size_t>(values.size())});
}

/// The factor of a parameter in a combination, 0 if it is not in it.
double factor(const Combination& combination, int parameter) {
  const auto it = std::find_if(combination.begin(), combination.end(),
                               [&](const auto& entry) { return entry.first == parameter; });
  return it == combination.end() ? 0.0 : it->second;
}

/// Rank, condition and the two directions that the independent implementation found.
TEST(Observability, FindsTheTwoDirectionsThatFetchCannotTell) {
  KINECAL_NEEDS_DATA("fetch");
  const auto folder = test::data_folder() / "fetch/synth";
  const auto fetch = test::calibrate_files(folder / "fetch_arm_head.urdf",
                                           folder / "calibrate.yaml", folder / "samples.yaml");
  const Observability found = of(fetch);
  EXPECT_EQ(found.rank, 24);
  ASSERT_EQ(found.unobservable.size(), 2u);
  const auto has = [&](const char* one, const char* other, double ratio) {
    const int a = fetch.result.table.index(one), b = fetch.result.table.index(other);
    return std::any_of(found.unobservable.begin(), found.unobservable.end(), [&](const auto& c) {
      return factor(c, a) != 0.0 && std::abs(factor(c, b) / factor(c, a) - ratio) < 0.01;
    });
  };
  EXPECT_TRUE(has("head_tilt_joint", "head_camera_rgb_joint_b", -1.0));
  EXPECT_TRUE(has("shoulder_pan_joint", "head_pan_joint_c", 1.0));
}

struct RankCase {
  const char *urdf, *config, *samples;
  int rank;
  double condition;
};

TEST(Observability, HasTheRankAndConditionOfTheReference) {
  KINECAL_NEEDS_DATA("ur5_tracker");
  KINECAL_NEEDS_DATA("mukca_panda");
  std::vector<RankCase> cases = {
      {"ur5_tracker/ur5.urdf", "ur5_tracker/base_tool.yaml", "ur5_tracker/grid.yaml", 9, 0},
      {"mukca_panda/panda.urdf", "mukca_panda/panda_6/minimal.yaml",
       "mukca_panda/panda_6/front.yaml", 30, 377},
      {"mukca_panda/panda.urdf", "mukca_panda/panda_2/minimal.yaml",
       "mukca_panda/panda_2/front_center.yaml", 30, 4963},
      {"mukca_panda/panda.urdf", "mukca_panda/panda_2/stable.yaml",
       "mukca_panda/panda_2/front_center.yaml", 28, 141},
      {"mukca_panda/panda.urdf", "mukca_panda/panda_6/redundant.yaml",
       "mukca_panda/panda_6/front.yaml", 30, 0},
      {"ur5_tracker/ur5.urdf", "ur5_tracker/full.yaml", "ur5_tracker/grid.yaml", 25, 97},
      {"ur5_tracker/ur5.urdf", "ur5_tracker/weak.yaml", "ur5_tracker/grid.yaml", 27, 1.7e5},
      {"ur5_tracker/ur5.urdf", "ur5_tracker/redundant.yaml", "ur5_tracker/grid.yaml", 27, 0}};
  const int all = static_cast<int>(cases.size());
  cases.resize(static_cast<std::size_t>(test::repetitions(all, 5)));
  for (const RankCase& c : cases) {
    const auto data = test::data_folder();
    const auto calibrated = test::calibrate_files(data / c.urdf, data / c.config, data / c.samples);
    const Observability found = of(calibrated);
    EXPECT_EQ(found.rank, c.rank) << c.config;
    if (c.condition > 0) {
      EXPECT_NEAR(found.condition / c.condition, 1.0, 0.02) << c.config;
    }
  }
}

/// All residuals of a problem, in the order in which they are visited.
Eigen::VectorXd residuals(const Problem& problem, const std::vector<double>& values) {
  std::vector<double> all;
  (void)evaluate(problem, values, nullptr, [&](int, int, const TermResiduals& out) {
    all.insert(all.end(), out.residual.begin(), out.residual.end());
  });
  return Eigen::Map<Eigen::VectorXd>(all.data(), std::ssize(all));
}

FreeSet free_of(const Problem& problem, const std::vector<std::string>& names) {
  std::vector<int> free;
  for (const std::string& name : names) free.push_back(problem.table().index(name));
  return FreeSet(free, problem.table().size());
}

/// Camera against arm, nearly exact at zero: with residuals one sees whether they change.
Problem hand_eye(int samples) {
  Problem problem = test::scene_problem();
  problem.add_block("hand_eye", PointToPoint{}, {"camera", "arm"}, {});
  const std::vector<double> truth = test::random_values(problem.table(), 0.01, 6);
  for (const Sample& s : test::exact_samples(problem, truth, samples)) problem.add_sample(s);
  return problem;
}

/// At exact samples the weighted Jacobian is that of stack().
TEST(Observability, WeighsAFeatureByItsOwnSigma) {
  Problem problem = test::scene_problem();
  problem.add_block("hand_eye", PointToPoint{}, {"camera", "arm"}, {.sigma = 0.01});
  const std::vector<double> truth = test::random_values(problem.table(), 0.01, 6);
  std::vector<Sample> samples = test::exact_samples(problem, truth, 6);
  for (Sample& sample : samples) {
    for (Feature& feature : sample.observations[1].features) feature.sigma = 1e-3;
    sample.observations[1].features[0].sigma = {};
  }
  for (const Sample& sample : samples) problem.add_sample(sample);
  const FreeSet free = free_of(problem, {"elbow", "camera_joint_x", "camera_joint_b"});
  Eigen::MatrixXd columns = stack(problem, free, truth).jacobian;
  for (Eigen::Index c = 0; c < columns.cols(); ++c) columns.col(c).normalize();
  const Eigen::VectorXd singular = Eigen::JacobiSVD<Eigen::MatrixXd>(columns).singularValues();
  EXPECT_NEAR(observability(problem, free, truth).condition / (singular(0) / singular(2)), 1.0,
              1e-9);
}

/// However far one goes along it.
TEST(Observability, ResidualsDoNotChangeAlongAnUnobservableCombination) {
  const Problem problem = hand_eye(30);
  const std::vector<double> zero(static_cast<std::size_t>(problem.table().size()), 0.0);
  const std::vector<std::string> names = {"torso_joint", "shoulder_pan", "head_pan",
                                          "elbow",       "head_pan_z",   "head_pan_c"};
  const FreeSet free = free_of(problem, names);
  const Observability found = observability(problem, free, zero);
  // The torso carries arm and head alike; both pans turn about parallel axes, but not the same one;
  // the head's pan turns about the axis of its own frame.
  EXPECT_EQ(found.rank, 4);
  ASSERT_EQ(found.unobservable.size(), 2u);
  const Eigen::VectorXd before = residuals(problem, zero);
  ASSERT_EQ(before.size(), 30 * 4 * 3);
  ASSERT_GT(before.norm(), 1e-2);
  const auto change = [&](const Combination& combination, double far) {
    std::vector<double> values = zero;
    for (const auto& [p, factor] : combination) values[static_cast<std::size_t>(p)] = far * factor;
    return (residuals(problem, values) - before).norm();
  };
  constexpr double kRounding = 1e-12;  // of 360 residuals of a metre or two
  std::set<std::string> involved;
  for (const Combination& combination : found.unobservable) {
    ASSERT_FALSE(combination.empty());
    EXPECT_EQ(combination[0].second, 1.0) << "the largest effect has factor one";
    for (const double far : {1e-3, -0.1, 1.0})
      EXPECT_LE(change(combination, far), kRounding) << far;
    for (const auto& [p, factor] : combination) involved.insert(problem.table()[p].name);
  }
  EXPECT_EQ(involved, (std::set<std::string>{"torso_joint", "head_pan", "head_pan_c"}));
  // They do change along what is observable: each of the others, and part of a combination.
  for (const std::string& name : names) {
    if (name == "torso_joint") continue;
    EXPECT_GT(change({{problem.table().index(name), 1.0}}, 1e-3), 1e-4) << name;
  }
}

/// Along y these three frames are moved alike, so two combinations of them are unobservable.
TEST(Observability, EachCombinationHasAParameterOfItsOwn) {
  ParameterTable table;
  for (const char* name : {"head_tilt_y", "elbow", "camera_joint_y", "camera_optical_x"}) {
    table.add({.name = name});
  }
  Problem problem(test::mobile_manipulator(), "base_link", table,
                  {"head_tilt", "camera_joint", "camera_optical"});
  problem.add_sensor(ChainPoint{}, {"arm", "hand"});
  problem.add_sensor(DepthCamera{}, {"camera", "camera_optical_frame"});
  problem.add_block("hand_eye", PointToPoint{}, {"camera", "arm"}, {});
  const Problem scene = test::scene_problem();
  const std::vector<double> zero(static_cast<std::size_t>(scene.table().size()), 0.0);
  for (const Sample& s : test::exact_samples(scene, zero, 5)) problem.add_sample(s);
  const Observability found =
      observability(problem, FreeSet({0, 1, 2, 3}, 4), std::vector<double>(4, 0.0));
  EXPECT_EQ(found.rank, 2);
  ASSERT_EQ(found.unobservable.size(), 2u);
  for (const Combination& combination : found.unobservable) {
    ASSERT_EQ(combination.size(), 2u);
    double along_y = 0.0;
    for (const auto& [p, factor] : combination) {
      EXPECT_NE(table[p].name, "elbow");
      EXPECT_NEAR(std::abs(factor), 1.0, 1e-6);
      along_y += table[p].name == "camera_optical_x" ? -factor : factor;
    }
    EXPECT_NEAR(along_y, 0.0, 1e-6);
  }
}

/// Weighted rows of the oracle, their columns scaled to length one, and their singular values.
TEST(Observability, ItsConditionIsThatOfTheWeightedJacobian) {
  const std::vector<std::string> names = {"elbow", "wrist", "head_tilt", "camera_joint_x",
                                          "eye_fx"};
  std::vector<double> conditions;
  for (const double weight : {1.0, 0.001}) {  // of pixels
    Problem problem = test::scene_problem();
    test::OracleProblem oracle = test::oracle_of(problem);
    const auto add_to = [&](auto& to) {
      to.add_block("hand_eye", PointToPoint{}, {"camera", "arm"}, {.scale = 3.0});
      to.add_block("reprojection", PointToPixel{}, {"arm", "eye"}, {.scale = weight});
    };
    add_to(problem);
    add_to(oracle);
    const std::vector<double> x = test::random_values(problem.table(), 0.02, 6);
    for (const Sample& s : test::exact_samples(problem, x, 6)) {  // no residuals: error-free
      problem.add_sample(s);
      oracle.add_sample(s);
    }
    const FreeSet free = free_of(problem, names);
    Eigen::MatrixXd normal = oracle.multiplied_out(x, free).hessian;
    const Eigen::VectorXd scale = normal.diagonal().cwiseSqrt().cwiseInverse();
    normal = scale.asDiagonal() * normal * scale.asDiagonal();
    const Eigen::VectorXd squares = Eigen::JacobiSVD<Eigen::MatrixXd>(normal).singularValues();
    const Observability found = observability(problem, free, x);
    EXPECT_EQ(found.rank, free.size());
    conditions.push_back(std::sqrt(squares(0) / squares(free.size() - 1)));
    EXPECT_NEAR(found.condition, conditions.back(), 1e-6 * conditions.back());
  }
  EXPECT_GT(std::abs(conditions[1] / conditions[0] - 1.0), 0.01) << "the weight does not matter";
}

TEST(Observability, AJacobianOfZerosHasRankZeroAndListsEachParameter) {
  Problem problem = test::scene_problem();
  problem.add_block("ground", PointToPlane(0, 0, 1, 0), {"camera"}, {});
  const std::vector<double> zero(static_cast<std::size_t>(problem.table().size()), 0.0);
  for (const Sample& s : test::exact_samples(problem, zero, 5)) problem.add_sample(s);
  // On these the camera does not depend.
  const std::vector<std::string> names = {"wrist", "elbow", "board_x"};
  const Observability found = observability(problem, free_of(problem, names), zero);
  EXPECT_EQ(found.rank, 0);
  EXPECT_EQ(found.condition, 1.0);
  ASSERT_EQ(found.unobservable.size(), names.size());
  std::set<std::string> listed;
  for (const Combination& combination : found.unobservable) {
    ASSERT_EQ(combination.size(), 1u);
    EXPECT_EQ(combination[0].second, 1.0);
    listed.insert(problem.table()[combination[0].first].name);
  }
  EXPECT_EQ(listed, std::set<std::string>(names.begin(), names.end()));
}

TEST(Observability, WithoutSamplesNothingIsObservable) {
  Problem problem = test::scene_problem();
  problem.add_block("ground", PointToPlane(0, 0, 1, 0), {"camera"}, {});
  const std::vector<double> zero(static_cast<std::size_t>(problem.table().size()), 0.0);
  const Observability found = observability(problem, free_of(problem, {"head_tilt"}), zero);
  EXPECT_EQ(found.rank, 0);
  EXPECT_EQ(found.condition, 1.0);
  ASSERT_EQ(found.unobservable.size(), 1u);
}

TEST(Observability, WithoutFreeParametersTheRankIsZeroAndNothingIsListed) {
  const Problem problem = hand_eye(3);
  const std::vector<double> zero(static_cast<std::size_t>(problem.table().size()), 0.0);
  const Observability found = observability(problem, FreeSet({}, problem.table().size()), zero);
  EXPECT_EQ(found.rank, 0);
  EXPECT_EQ(found.condition, 1.0);
  EXPECT_TRUE(found.unobservable.empty());
}

}  // namespace
}  // namespace kinecal
