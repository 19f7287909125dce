// Normal equations that never form a Jacobian against the rows of the oracle, stacked and
// multiplied out: for any error blocks, with each loss, for what is free and what is held, in
// packets and in doubles.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "support/sums.hpp"

namespace kinecal::test {

// A dozen samples of four features: a thousand products are summed, in another order.
inline constexpr double kOrderOfSums = 1e-10;
// The same operations in the same order but for what compilers fuse; sums of lanes.
inline constexpr double kSameArithmetic = 1e-12;
// The oracle's formulas are others: some dozen operations on metres, radians or residual_of.
inline constexpr double kOtherFormulas = 1e-12;

struct Scene {
  std::string base = "base_link", arm_frame = "hand";
  double residual_of = 1.0;  ///< what the residual is the difference of; for rounding
  bool either_sign = false;  ///< of the residual, as that of planes
};

/// Where the blocks of a scene are evaluated.
inline std::vector<double> scene_values() {
  return random_values(wide_table(), 0.05, 4);
}

/// Samples of other values, which leave residuals.
template <class S>
std::vector<Sample> scene_samples(const BasicProblem<S>& problem, const Scene& scene) {
  std::vector<double> truth = scene_values();
  for (std::size_t i = 0; i < truth.size(); ++i) truth[i] += 5e-3 * static_cast<double>(i % 5);
  return wide_samples(problem, truth, 9, scene.arm_frame);
}

/// The rows of a scene's error blocks by the oracle; they do not depend on weights and losses.
template <class AddBlocks>
OracleRows oracle_rows_of(const Scene& scene, AddBlocks&& add_blocks) {
  const Problem problem = wide_problem<Packet>(scene.base);
  OracleProblem oracle = oracle_of(problem);
  add_blocks(oracle, TermOptions{});
  for (const Sample& sample : scene_samples(problem, scene)) oracle.add_sample(sample);
  return oracle.rows(scene_values());
}

inline std::vector<std::pair<std::string, FreeSet>> free_sets(const ParameterTable& table) {
  const FreeSet all = all_free(table);
  std::vector<int> reversed(all.parameters().rbegin(), all.parameters().rend());
  std::vector<int> kinematics, cameras, some;
  for (int i = 0; i < table.size(); ++i) {
    const std::string& name = table[i].name;
    const bool joint = name.starts_with("camera_joint") || name.starts_with("second_joint");
    const bool camera = !joint && (name.starts_with("camera_") || name.starts_with("eye_") ||
                                   name.starts_with("second_"));
    (camera ? cameras : kinematics).push_back(i);
    if (i % 3 == 0) some.push_back(i);
  }
  std::vector<std::pair<std::string, FreeSet>> sets = {
      {"all", all},
      {"all, reversed", FreeSet(reversed, table.size())},
      {"none of the cameras", FreeSet(kinematics, table.size())},
      {"the cameras only", FreeSet(cameras, table.size())},
      {"every third", FreeSet(some, table.size())},
      {"nothing", FreeSet({}, table.size())},
  };
  for (const char* name : {"torso_joint", "wrist", "finger", "elbow_mount_y", "wrist_mimic_b",
                           "camera_z_scaling", "eye_cx", "second_fx"}) {
    sets.emplace_back(name, free_of(table, {name}));
  }
  return sets;
}

/// The gradient of the cost by central differences.
inline void expect_gradient_of_cost(const Problem& problem, const std::vector<double>& x,
                                    const NormalEquations& normal) {
  constexpr double kStep = 1e-6, kDifferences = 1e-5;  // also across the kinks of rho'
  const Eigen::VectorXd lengths = column_lengths(normal);
  for (int p = 0; p < problem.table().size(); ++p) {
    std::vector<double> up = x, down = x;
    up[static_cast<std::size_t>(p)] += kStep;
    down[static_cast<std::size_t>(p)] -= kStep;
    const double numeric = (normal_equations(problem, up, nullptr).cost -
                            normal_equations(problem, down, nullptr).cost) /
                           (2 * kStep);
    EXPECT_NEAR(normal.gradient(p), numeric,
                kDifferences * lengths(p) * std::sqrt(2.0 * normal.cost))
        << problem.table()[p].name;
  }
}

/// The rows in packets, for what is free, are columns of those in doubles for all parameters.
inline void expect_same_rows(const Problem& packets, const BasicProblem<double>& numbers,
                             const std::vector<double>& x, const FreeSet& free,
                             const Scene& scene) {
  const FreeSet all = all_free(numbers.table());
  const auto expected = rows_of(numbers, x, &all);
  const auto found = rows_of(packets, x, &free);
  ASSERT_EQ(found.size(), expected.size());
  for (const auto& [key, rows] : expected) {
    ASSERT_TRUE(found.contains(key));
    const TermResiduals& same = found.at(key);
    ASSERT_EQ(same.residual.size(), rows.residual.size());
    EXPECT_LE((same.residual - rows.residual).norm(), kSameArithmetic * scene.residual_of);
    ASSERT_EQ(same.jacobian.cols(), free.size());
    for (int c = 0; c < free.size(); ++c) {
      const int p = free.parameters()[static_cast<std::size_t>(c)];
      EXPECT_LE((same.jacobian.col(c) - rows.jacobian.col(p)).norm(),
                kSameArithmetic * rows.jacobian.norm())
          << numbers.table()[p].name << "\npackets\n"
          << same.jacobian.col(c) << "\ndoubles\n"
          << rows.jacobian.col(p);
    }
  }
}

/// The rows in doubles for all parameters are those of the oracle.
inline void expect_rows_of_oracle(const BasicProblem<double>& numbers, const OracleRows& oracle,
                                  const std::vector<double>& x, const Scene& scene) {
  const FreeSet all = all_free(numbers.table());
  const auto found = rows_of(numbers, x, &all);
  ASSERT_EQ(found.size(), oracle.size());
  for (const auto& [key, rows] : found) {
    SCOPED_TRACE("term " + std::to_string(key.first) + ", sample " + std::to_string(key.second));
    ASSERT_TRUE(oracle.contains(key));
    expect_rows_of_oracle(rows, oracle.at(key), kOtherFormulas * scene.residual_of, kOtherFormulas,
                          scene.either_sign);
  }
}

/// @param add_blocks   adds the error blocks under test to a problem, with the options given
/// @param oracle_rows  theirs
/// @param residual     the scale of the losses
template <class AddBlocks>
void check_sums(const Scene& scene, AddBlocks&& add_blocks, const OracleRows& oracle_rows,
                double residual) {
  ASSERT_FALSE(oracle_rows.empty());
  for (const LossType type : {LossType::none, LossType::huber, LossType::cauchy, LossType::tukey}) {
    SCOPED_TRACE("loss " + std::to_string(static_cast<int>(type)) + ", base " + scene.base +
                 ", the arm's points in " + scene.arm_frame);
    TermOptions options;
    options.scale = 2.5;
    options.loss = {type, options.scale * residual};
    Problem packets = wide_problem<Packet>(scene.base);
    BasicProblem<double> numbers = wide_problem<double>(scene.base);
    OracleProblem oracle = oracle_of(packets);
    add_blocks(packets, options);
    add_blocks(numbers, options);
    add_blocks(oracle, options);
    const std::vector<double> x = scene_values();
    for (const Sample& s : scene_samples(packets, scene)) {
      packets.add_sample(s);
      numbers.add_sample(s);
      oracle.add_sample(s);
    }
    expect_rows_of_oracle(numbers, oracle_rows, x, scene);
    const auto expected = [&](const FreeSet& free, Losses losses = Losses::as_given) {
      return oracle.multiplied_out(oracle_rows, x, free, losses);
    };
    const FreeSet all = all_free(packets.table());
    const double longest = column_lengths(expected(all)).maxCoeff();
    for (const auto& [name, free] : free_sets(packets.table())) {
      SCOPED_TRACE("free: " + name);
      const NormalEquations in_packets = normal_equations(packets, x, &free);
      const NormalEquations in_numbers = normal_equations(numbers, x, &free);
      expect_same(in_packets, expected(free), kOrderOfSums, longest);
      expect_same(in_numbers, expected(free), kOrderOfSums, longest);
      expect_same(in_packets, in_numbers, kSameArithmetic * scene.residual_of, longest);
      expect_same_rows(packets, numbers, x, free, scene);
      const NormalEquations convex = normal_equations(packets, x, &free, Losses::convex);
      expect_same(convex, expected(free, Losses::convex), kOrderOfSums, longest);
    }
    const NormalEquations normal = normal_equations(packets, x, &all);
    EXPECT_GT(normal.cost, 0.0);
    EXPECT_GT(normal.hessian.norm(), 0.0) << "the losses leave all features out";
    expect_gradient_of_cost(packets, x, normal);
    // The cost alone: a jet divides by multiplying with the inverse, a number does not.  An error d
    // of a residual r is one of r d in the cost.
    constexpr double kDivision = 4e-15;
    EXPECT_NEAR(normal_equations(packets, x, nullptr).cost, normal.cost,
                kDivision * scene.residual_of * (normal.cost + std::sqrt(normal.cost)));
  }
}

/// The same for one block between sensors, half of its features beyond the scale of the losses.
template <ErrorBlock B>
void check_sums_of(const Scene& scene, const B& block, const std::vector<std::string>& sensors) {
  SCOPED_TRACE(sensors.front() + " and " + sensors.back());
  const auto add_block = [&](auto& problem, const TermOptions& options) {
    problem.add_block("block", block, sensors, options);
  };
  const OracleRows rows = oracle_rows_of(scene, add_block);
  std::vector<double> norms;
  for (const auto& [key, of_sample] : rows) {
    for (Eigen::Index i = 0; i < of_sample.residual.size(); i += kResiduals<B>) {
      norms.push_back(of_sample.residual.segment(i, kResiduals<B>).norm());
    }
  }
  ASSERT_GE(norms.size(), 9u);
  std::sort(norms.begin(), norms.end());
  check_sums(scene, add_block, rows, 0.5 * (norms[norms.size() / 2] + norms[norms.size() / 2 + 1]));
}

}  // namespace kinecal::test
