// Rows of one error block in the scene with all sensors: against the oracle, against central differences,
// and normal equations against rows multiplied out.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <limits>

#include "support/open_scene.hpp"
#include "support/oracle_problem.hpp"
#include "support/sums.hpp"

namespace kinecal::test {

/// Parameter values where derivatives could go wrong.
inline std::vector<double> values_at(const std::string& where, const ParameterTable& table) {
  std::vector<double> values(static_cast<std::size_t>(table.size()), 0.0);
  if (where == "tiny") values = random_values(table, 1e-8, 3);
  if (where == "random" || where == "near_pi") values = random_values(table, 0.05, 4);
  const auto set = [&](const std::string& name, double value) {
    if (const int i = table.find(name); i >= 0) values[static_cast<std::size_t>(i)] = value;
  };
  if (where == "near_pi") {
    for (const char* frame : {"head_pan", "elbow_mount", "board"}) {
      const Vector3<double> w = Vector3<double>(1, -2, 0.5).normalized() * (M_PI - 1e-6);
      for (int k = 0; k < 3; ++k) {
        set(parameter_name(frame, kFrameAxes[static_cast<std::size_t>(3 + k)]), w(k));
      }
    }
  }
  for (const char* of_block : {"u", "v", "length", "radius", "expansion"}) {
    set(parameter_name("block", of_block), 0.3);
  }
  return values;
}

/// The scene's samples, not exact at x: residuals that are zero would hide errors.
/// @param distorted  one image of the camera "eye"; the oracle knows distorted pixels and no distorted rays
template <class S>
std::vector<Sample> samples_near(const BasicProblem<S>& problem, std::vector<double> x, int count,
                                 const std::string& arm_frame, bool distorted) {
  for (std::size_t i = 0; i < x.size(); ++i) x[i] += 1e-3 * static_cast<double>(i % 3);
  std::vector<Sample> samples = open_samples(problem, x, count, arm_frame);
  if (distorted) samples[1].observations[2].camera->d = {-0.2, 0.1, 2e-3, -1e-3, 0.05};
  samples[2].observations[4].features[1].point.x() = std::numeric_limits<double>::quiet_NaN();
  for (const std::size_t i : {0, 2, 3}) {  // of the second sensor; one of the first comes before it
    samples[1].observations[3].features[i].conditions = {{"load", 5.0 * static_cast<double>(i)}};
  }
  samples[1].observations[1].features[2].conditions = {{"load", 7.0}, {"temperature", 30.0}};
  return samples;
}

/// Rows with derivatives are those of the oracle; without, the same residuals.
template <class S>
void check_rows_against(const OracleRows& expected, const BasicProblem<S>& problem,
                        const std::vector<double>& x, bool either_sign) {
  const FreeSet all = all_free(problem.table());
  const OracleRows found = rows_of(problem, x, &all), plain = rows_of(problem, x, nullptr);
  ASSERT_EQ(found.size(), expected.size());
  ASSERT_EQ(plain.size(), expected.size());
  for (const auto& [key, rows] : expected) {
    ASSERT_TRUE(found.contains(key) && plain.contains(key));
    const Eigen::VectorXd& residual = found.at(key).residual;
    EXPECT_GT(rows.residual.norm(), 0.0);
    expect_rows_of_oracle(found.at(key), rows, 1e-12 * (1.0 + rows.residual.norm()), 1e-12,
                          either_sign);
    EXPECT_LE((plain.at(key).residual - residual).norm(), 1e-13 * (1.0 + residual.norm()));
  }
}

/// Derivatives are central differences: these are good to 1e-8 of the derivative's size, at a step of
/// 1e-6.
template <class S>
void check_central_differences(const BasicProblem<S>& problem, const std::vector<double>& x) {
  const FreeSet all = all_free(problem.table());
  const OracleRows rows = rows_of(problem, x, &all);
  for (int p = 0; p < problem.table().size(); ++p) {
    constexpr double kStep = 1e-6;
    std::vector<double> up = x, down = x;
    up[static_cast<std::size_t>(p)] += kStep;
    down[static_cast<std::size_t>(p)] -= kStep;
    const OracleRows above = rows_of(problem, up, nullptr), below = rows_of(problem, down, nullptr);
    for (const auto& [key, of_sample] : rows) {
      const Eigen::VectorXd numeric =
          (above.at(key).residual - below.at(key).residual) / (2.0 * kStep);
      EXPECT_LE((numeric - of_sample.jacobian.col(p)).norm(),
                1e-7 * (1.0 + of_sample.jacobian.norm()))
          << problem.table()[p].name << ", sample " << key.second;
    }
  }
}

/// Sums over the samples are the rows of the oracle multiplied out, of all parameters and of every other.
template <class S>
void check_sums_against(const OracleProblem& oracle, const OracleRows& rows,
                        const BasicProblem<S>& problem, const std::vector<double>& x) {
  const int count = problem.table().size();
  std::vector<int> some;
  for (int p = 0; p < count; p += 2) some.push_back(p);
  for (const FreeSet& free : {all_free(problem.table()), FreeSet(some, count)}) {
    const NormalEquations expected = oracle.multiplied_out(rows, x, free);
    EXPECT_GT(expected.hessian.norm(), 0.0);
    expect_same(normal_equations(problem, x, &free), expected, 1e-10);
  }
}

/// Checks a block in packets and in doubles, with a weight and a loss, wherever derivatives could go wrong.
/// @param arm_frame  in which the arm's features are
template <ErrorBlock B>
void check_rows_of(const B& block, const std::vector<std::string>& sensors,
                   const std::string& arm_frame = "hand", const std::string& base = "base_link") {
  TermOptions options;
  options.scale = 1.7;
  options.loss = {LossType::cauchy, 0.5};
  for (const std::string where : {"zero", "tiny", "random", "near_pi"}) {
    SCOPED_TRACE(where + ", features of the arm in " + arm_frame + ", base " + base);
    Problem packets = open_problem<Packet>(block, sensors, options, base);
    BasicProblem<double> numbers = open_problem<double>(block, sensors, options, base);
    OracleProblem oracle = oracle_of(packets);
    oracle.add_block("block", block, sensors, options);
    const std::vector<double> x = values_at(where, packets.table());
    const int count = where == "random" ? 9 : 3;  // 9: more than a packet has lanes
    for (const Sample& sample : samples_near(packets, x, count, arm_frame, PixelBlock<B>)) {
      packets.add_sample(sample);
      numbers.add_sample(sample);
      oracle.add_sample(sample);
    }
    const OracleRows expected = oracle.rows(x);
    ASSERT_FALSE(expected.empty());
    check_rows_against(expected, packets, x, PlanePairBlock<B>);
    check_rows_against(expected, numbers, x, PlanePairBlock<B>);
    check_central_differences(packets, x);
    check_sums_against(oracle, expected, packets, x);
    check_sums_against(oracle, expected, numbers, x);
  }
}

}  // namespace kinecal::test
