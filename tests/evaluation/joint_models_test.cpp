// Joint models: rows against the oracle and normal equations against rows multiplied out, also
// through a mimic joint, a sliding joint and a base on the moving arm; recovery of injected errors.
#include <gtest/gtest.h>

#include "kinecal/errors.hpp"
#include "support/oracle_problem.hpp"
#include "support/sums.hpp"

namespace kinecal {
namespace {

const std::vector<std::string> kModelled = {
    "elbow_gear_ratio",       "elbow_eccentric_sin",        "elbow_eccentric_cos",
    "torso_joint_gear_ratio", "shoulder_pan_eccentric_sin", "finger_gear_ratio",
    "wrist_gear_ratio"};

ParameterTable modelled_table() {
  ParameterTable table = test::scene_table();
  table.add({.name = "finger"});
  for (const std::string& name : kModelled) table.add({.name = name});
  return table;
}

template <class S>
BasicProblem<S> modelled_problem(const std::string& base = "base_link") {
  BasicProblem<S> problem(test::mobile_manipulator(), base, modelled_table(), test::kSceneFrames);
  problem.add_sensor(ChainPoint{}, {"arm", "hand"});
  problem.add_sensor(DepthCamera{}, {"camera", "camera_optical_frame"});
  problem.add_sensor(PinholeCamera{}, {"eye", "camera_optical_frame"});
  problem.add_sensor(ChainPoint{}, {"finger", "finger_right"});
  problem.add_sensor(ChainPoint{}, {"counterweight", "counterweight"});
  return problem;
}

std::vector<double> modelled_values(const ParameterTable& table) {
  std::vector<double> x = test::random_values(table, 0.05, 4);
  double value = 0.02;
  for (const std::string& name : kModelled) {
    x[static_cast<std::size_t>(table.index(name))] = value = -0.9 * value;
  }
  return x;
}

void check(const std::vector<std::string>& sensors, const std::string& base = "base_link") {
  SCOPED_TRACE(sensors[0] + " and " + sensors[1] + ", base " + base);
  Problem packets = modelled_problem<Packet>(base);
  BasicProblem<double> numbers = modelled_problem<double>(base);
  packets.add_block("b", PointToPoint{}, sensors);
  numbers.add_block("b", PointToPoint{}, sensors);
  test::OracleProblem oracle = test::oracle_of(packets);
  oracle.add_block("b", PointToPoint{}, sensors);
  const std::vector<double> x = modelled_values(packets.table());
  std::mt19937 random(3);
  std::uniform_real_distribution<double> side(-0.3, 0.3);
  for (Sample& sample : test::exact_samples(packets, x, 7)) {
    for (const char* name : {"finger", "counterweight"}) {
      Observation& seen = sample.observations.emplace_back(Observation{name, {}, {}});
      for (int i = 0; i < 4; ++i) {
        seen.features.push_back({"", Vector3<double>{side(random), side(random), side(random)}});
      }
    }
    for (auto& feature : sample.observations[0].features) feature.point.x() += 0.01;
    packets.add_sample(sample);
    numbers.add_sample(sample);
    oracle.add_sample(sample);
  }
  const FreeSet all = test::all_free(packets.table());
  const test::OracleRows expected = oracle.rows(x);
  for (const auto& found : {test::rows_of(packets, x, &all), test::rows_of(numbers, x, &all)}) {
    ASSERT_EQ(found.size(), expected.size());
    for (const auto& [key, rows] : expected) {
      test::expect_rows_of_oracle(found.at(key), rows, 1e-12, 1e-12);
    }
  }
  const FreeSet some = test::free_of(
      packets.table(), {"elbow_eccentric_cos", "camera_fx", "torso_joint_gear_ratio", "wrist"});
  for (const FreeSet& free : {all, some}) {
    const NormalEquations reference = oracle.multiplied_out(expected, x, free);
    test::expect_same(normal_equations(packets, x, &free), reference, 1e-10);
    test::expect_same(normal_equations(numbers, x, &free), reference, 1e-10);
  }
}

TEST(JointModels, HaveTheRowsOfTheOracle) {
  check({"camera", "arm"});
  check({"finger", "camera"});          // through joints that mimic
  check({"counterweight", "camera"});   // the same, turning the other way
  check({"arm", "camera"}, "forearm");  // joints passed from child to parent
}

TEST(JointModels, AreTheirFormulas) {
  const OfJointModels<double> v = {0.1, 0.02, -0.03};
  const double q = 0.7;
  EXPECT_DOUBLE_EQ(joint_model_change(q, v),
                   0.1 * q + 0.02 * std::sin(q) - 0.03 * (std::cos(q) - 1.0));
  const auto d = joint_model_derivatives(q, v);
  EXPECT_DOUBLE_EQ(d[0], q);
  EXPECT_DOUBLE_EQ(d[1], std::sin(q));
  EXPECT_DOUBLE_EQ(d[2], std::cos(q) - 1.0);
}

TEST(JointModels, AreRecoveredByGaussNewtonSteps) {
  Problem problem = modelled_problem<Packet>();
  problem.add_block("b", PointToPoint{}, {"camera", "arm"});
  const ParameterTable& table = problem.table();
  const std::vector<std::string> names = {"elbow", "elbow_gear_ratio", "elbow_eccentric_sin",
                                          "shoulder_pan_eccentric_sin"};
  std::vector<double> truth(static_cast<std::size_t>(table.size()), 0.0);
  double value = 0.03;
  for (const std::string& name : names) {
    truth[static_cast<std::size_t>(table.index(name))] = value = -0.8 * value;
  }
  for (const Sample& sample : test::exact_samples(problem, truth, 60)) problem.add_sample(sample);
  Eigen::VectorXd found = Eigen::VectorXd::Zero(table.size());
  const FreeSet free = test::free_of(table, names);
  constexpr int kSteps = 8;
  for (int step = 0; step < kSteps; ++step) {
    const NormalEquations sums =
        normal_equations(problem, {found.data(), static_cast<std::size_t>(found.size())}, &free);
    found(free.parameters()) -= sums.hessian.ldlt().solve(sums.gradient);
  }
  for (const std::string& name : names) {
    const int i = table.index(name);
    EXPECT_NEAR(found(i), truth[static_cast<std::size_t>(i)], 1e-8) << name;
  }
}

}  // namespace
}  // namespace kinecal
