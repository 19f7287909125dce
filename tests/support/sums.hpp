// The scene with more sensors, and normal equations against those of the oracle.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <map>

#include "support/double_problem.hpp"
#include "support/oracle_problem.hpp"

namespace kinecal::test {

/// The scene's parameters and those of its further sensors.
inline ParameterTable wide_table() {
  ParameterTable table = scene_table();
  table.add({.name = "finger"});
  for (auto axis : kFrameAxes) table.add({.name = parameter_name("wrist_mimic", axis)});
  for (const ParameterInfo& info :
       std::span(DepthCamera::kParameters).first(DepthCamera::kWithoutPolynomial)) {
    table.add({.name = parameter_name("second", info.name)});
  }
  return table;
}

/// The scene with more sensors on its moving parts: points on a finger and on a counterweight that
/// both mimic other joints, a second depth camera, and a twin of the first with the same
/// parameters.
template <class S>
BasicProblem<S> wide_problem(const std::string& base = "base_link") {
  std::set<std::string> frames = kSceneFrames;
  frames.insert("wrist_mimic");
  BasicProblem<S> problem(mobile_manipulator(), base, wide_table(), frames);
  problem.add_sensor(ChainPoint{}, {"arm", "hand"});
  problem.add_sensor(DepthCamera{}, {"camera", "camera_optical_frame"});
  problem.add_sensor(PinholeCamera{}, {"eye", "camera_optical_frame"});
  problem.add_sensor(ChainPoint{}, {"finger", "finger_right"});
  problem.add_sensor(ChainPoint{}, {"counterweight", "counterweight"});
  problem.add_sensor(DepthCamera{}, {"second", "counterweight"});
  problem.add_sensor(DepthCamera{}, {"twin", "camera_link", "camera"});
  return problem;
}

/// exact_samples() for arm, camera and eye; what the other sensors saw is random, and so are the
/// settings of their cameras, in each sample.
template <class S>
std::vector<Sample> wide_samples(const BasicProblem<S>& problem, std::span<const double> values,
                                 int count, const std::string& arm_frame = "hand",
                                 unsigned seed = 1, int features = 4) {
  std::vector<Sample> samples = exact_samples(problem, values, count, arm_frame, seed, features);
  std::mt19937 random(seed + 77);
  std::uniform_real_distribution<double> side(-0.3, 0.3), depth(0.5, 1.2), near_one(0.9, 1.1);
  for (Sample& sample : samples) {
    for (const char* name : {"finger", "counterweight", "second", "twin"}) {
      Observation& seen = sample.observations.emplace_back(Observation{name, {}, {}});
      for (int i = 0; i < features; ++i) {
        seen.features.push_back({"", Vector3<double>{side(random), side(random), depth(random)}});
      }
      CameraInfo info = camera_info();
      info.p[0] *= near_one(random);
      info.p[6] *= near_one(random);
      info.z_offset = 0.1 * side(random);
      info.z_scaling = near_one(random);
      seen.camera = info;
    }
  }
  return samples;
}

inline FreeSet all_free(const ParameterTable& table) {
  std::vector<int> all;
  for (int i = 0; i < table.size(); ++i) all.push_back(i);
  return FreeSet(all, table.size());
}

inline FreeSet free_of(const ParameterTable& table, const std::vector<std::string>& names) {
  std::vector<int> indices;
  for (const std::string& name : names) indices.push_back(table.index(name));
  return FreeSet(indices, table.size());
}

/// Residuals and Jacobians of a problem by term and sample; each is visited once.
template <class S>
std::map<std::pair<int, int>, TermResiduals> rows_of(const BasicProblem<S>& problem,
                                                     std::span<const double> values,
                                                     const FreeSet* free) {
  std::map<std::pair<int, int>, TermResiduals> rows;
  (void)evaluate(problem, values, free, [&](int term, int sample, const TermResiduals& of_term) {
    EXPECT_TRUE(rows.emplace(std::pair(term, sample), of_term).second)
        << "term " << term << " visits sample " << sample << " again";
  });
  return rows;
}

/// How much of a parameter there is in normal equations: the root of its diagonal element, the
/// length of its column.  A parameter that moves both of two points alike has none, but the sums
/// that cancel were as large as the others: no column counts as shorter than kCancels of the
/// longest.
/// @param others  the longest column of parameters that are not free
inline Eigen::VectorXd column_lengths(const NormalEquations& n, double others = 0.0) {
  constexpr double kCancels = 0.03;  // rounding of 1e-16: 1e-13 of the product of two columns
  const Eigen::VectorXd lengths = n.hessian.diagonal().cwiseMax(0.0).cwiseSqrt();
  const double longest = lengths.size() == 0 ? 0.0 : lengths.maxCoeff();
  return lengths.cwiseMax(kCancels * std::max(longest, others));
}

/// Each number of two normal equations agrees, relative to what it is a sum of: products of columns
/// and of columns and the residual.
/// @param others  the longest column of parameters that are not free
inline void expect_same(const NormalEquations& found, const NormalEquations& expected,
                        double tolerance, double others = 0.0) {
  ASSERT_EQ(found.gradient.size(), expected.gradient.size());
  ASSERT_EQ(found.hessian.rows(), expected.hessian.rows());
  EXPECT_NEAR(found.cost, expected.cost, tolerance * expected.cost);
  const Eigen::VectorXd lengths = column_lengths(expected, others);
  const Eigen::VectorXd of_gradient = std::sqrt(2.0 * expected.cost) * lengths;
  const Eigen::MatrixXd of_hessian = lengths * lengths.transpose();
  const auto within = [tolerance](const auto& a, const auto& b, const auto& scale) {
    return ((a - b).cwiseAbs().array() <= tolerance * scale.array()).all();
  };
  EXPECT_TRUE(within(found.gradient, expected.gradient, of_gradient))
      << "gradient\n"
      << found.gradient.transpose() << "\nexpected\n"
      << expected.gradient.transpose();
  EXPECT_TRUE(within(found.hessian, expected.hessian, of_hessian))
      << "hessian\n"
      << found.hessian << "\nexpected\n"
      << expected.hessian;
  EXPECT_TRUE(found.hessian == found.hessian.transpose()) << "not symmetric";
}

}  // namespace kinecal::test
