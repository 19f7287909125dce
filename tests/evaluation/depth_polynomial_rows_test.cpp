// The polynomial of a depth camera: rows against the oracle, sums against rows multiplied out, recovery of injected
// errors; with it held at zero, all numbers have the bits of a camera without it.
#include <gtest/gtest.h>

#include "kinecal/errors.hpp"
#include "support/oracle_problem.hpp"
#include "support/sums.hpp"

namespace kinecal {
namespace {

/// Camera against arm, with the coefficients in the table.
template <class S>
BasicProblem<S> bent_problem() {
  ParameterTable table = test::scene_table();
  test::add_depth_polynomial(table);
  BasicProblem<S> problem(test::mobile_manipulator(), "base_link", table, test::kSceneFrames);
  problem.add_sensor(ChainPoint{}, {"arm", "hand"});
  problem.add_sensor(DepthCamera{}, {"camera", "camera_optical_frame"});
  problem.add_sensor(PinholeCamera{}, {"eye", "camera_optical_frame"});
  problem.add_block("points", PointToPoint{}, {"camera", "arm"});
  problem.add_block("reprojection", PointToPixel{}, {"camera", "eye"}, {.scale = 0.01});
  return problem;
}

std::vector<std::string> bend_names() {
  std::vector<std::string> names;
  for (const ParameterInfo& info : kDepthPolynomial) {
    names.push_back(parameter_name("camera", info.name));
  }
  return names;
}

/// Values at which the polynomial bends depth by a few percent.
std::vector<double> bent_values(const ParameterTable& table) {
  std::vector<double> x = test::random_values(table, 0.02, 4);
  double value = 0.02;
  for (const std::string& name : bend_names()) {
    x[static_cast<std::size_t>(table.index(name))] = value = -1.1 * value;
  }
  return x;
}

TEST(DepthPolynomialRows, AreThoseOfTheOracle) {
  Problem packets = bent_problem<Packet>();
  BasicProblem<double> numbers = bent_problem<double>();
  test::OracleProblem oracle = test::oracle_of(packets);
  oracle.add_block("points", PointToPoint{}, {"camera", "arm"});
  oracle.add_block("reprojection", PointToPixel{}, {"camera", "eye"}, {.scale = 0.01});
  const std::vector<double> x = bent_values(packets.table());
  for (Sample& sample : test::exact_samples(packets, x, 11)) {
    sample.observations[0].features[0].point.x() += 0.01;
    packets.add_sample(sample);
    numbers.add_sample(sample);
    oracle.add_sample(sample);
  }
  const FreeSet all = test::all_free(packets.table());
  const test::OracleRows expected = oracle.rows(x);
  for (const auto& found : {test::rows_of(packets, x, &all), test::rows_of(numbers, x, &all)}) {
    ASSERT_EQ(found.size(), expected.size());
    for (const auto& [key, rows] : expected) {
      test::expect_rows_of_oracle(found.at(key), rows, 1e-11, 1e-11);
    }
  }
  const FreeSet held = test::free_of(packets.table(), {"camera_fx", "camera_z_scaling", "wrist"});
  const FreeSet some =
      test::free_of(packets.table(), {"camera_z_xy", "camera_z_quadratic", "camera_cy", "elbow"});
  for (const FreeSet& free : {all, held, some}) {
    const NormalEquations reference = oracle.multiplied_out(expected, x, free);
    test::expect_same(normal_equations(packets, x, &free), reference, 1e-10);
    test::expect_same(normal_equations(numbers, x, &free), reference, 1e-10);
  }
}

TEST(DepthPolynomialRows, HeldAtZeroHaveTheBitsOfACameraWithoutIt) {
  Problem with = bent_problem<Packet>(), without = test::scene_problem();
  without.add_block("points", PointToPoint{}, {"camera", "arm"});
  without.add_block("reprojection", PointToPixel{}, {"camera", "eye"}, {.scale = 0.01});
  const std::vector<double> x = test::random_values(without.table(), 0.02, 4);
  std::vector<double> wide = x;
  wide.resize(static_cast<std::size_t>(with.table().size()), 0.0);
  for (const Sample& sample : test::exact_samples(without, x, 11)) {
    with.add_sample(sample);
    without.add_sample(sample);
  }
  const std::vector<std::string> names = {"elbow", "camera_fx", "camera_cy", "camera_z_offset",
                                          "camera_z_scaling"};
  const FreeSet a = test::free_of(with.table(), names), b = test::free_of(without.table(), names);
  const NormalEquations sums = normal_equations(with, wide, &a);
  const NormalEquations expected = normal_equations(without, x, &b);
  EXPECT_EQ(sums.cost, expected.cost);
  EXPECT_TRUE(sums.gradient == expected.gradient);
  EXPECT_TRUE(sums.hessian == expected.hessian);
}

TEST(DepthPolynomialRows, LeadGaussNewtonToInjectedErrors) {
  Problem problem = bent_problem<Packet>();
  const std::vector<double> truth = bent_values(problem.table());
  for (const Sample& sample : test::exact_samples(problem, truth, 40)) problem.add_sample(sample);
  std::vector<std::string> names = bend_names();
  for (const char* more : {"camera_z_offset", "camera_z_scaling", "camera_fx", "camera_fy"}) {
    names.emplace_back(more);
  }
  const FreeSet free = test::free_of(problem.table(), names);
  Eigen::VectorXd found =
      Eigen::Map<const Eigen::VectorXd>(truth.data(), static_cast<Eigen::Index>(truth.size()));
  for (const int p : free.parameters()) found(p) = 0.0;
  constexpr int kSteps = 8;
  for (int step = 0; step < kSteps; ++step) {
    const NormalEquations sums = normal_equations(problem, {found.data(), truth.size()}, &free);
    found(free.parameters()) -= sums.hessian.ldlt().solve(sums.gradient);
  }
  for (const int p : free.parameters()) {
    EXPECT_NEAR(found(p), truth[static_cast<std::size_t>(p)], 1e-8) << problem.table()[p].name;
  }
}

}  // namespace
}  // namespace kinecal
