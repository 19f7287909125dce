// Calibrations of the scene with noise of a known size, and samples that are ruined.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <functional>
#include <set>

#include "kinecal/evaluation/any_evaluator.hpp"
#include "kinecal/solve/calibrate.hpp"
#include "kinecal/trust.hpp"
#include "support/scene.hpp"
#include "support/sums.hpp"

namespace kinecal::test {

/// What is calibrated: all of it is observable.
inline const std::vector<std::string> kNoisyFree = {
    "shoulder_lift", "elbow",      "wrist",           "head_tilt",
    "head_pan_x",    "head_pan_y", "camera_z_offset", "camera_z_scaling",
    "camera_fx",     "camera_cy"};

/// The scene's parameters with their units.
inline ParameterTable table_with_units() {
  ParameterTable table = scene_table();
  for (const char* name : {"torso_joint", "head_pan_x", "head_pan_y", "camera_z_offset"}) {
    table[name].unit = "m";
  }
  for (const char* name :
       {"camera_fx", "camera_fy", "camera_cx", "camera_cy", "camera_z_scaling"}) {
    table[name].unit = "1";
  }
  return table;
}

constexpr double kPointNoise = 1e-3;  ///< metres, of each coordinate

/// A calibration of arm and camera by points.
struct NoisyScene {
  Eigen::VectorXd truth;
  std::vector<Sample> samples;
  TermOptions options{.sigma = kPointNoise};
  std::vector<std::string> names = kNoisyFree;
  Calibration calibration = {};
  CalibrationResult result = {};

  /// @param count  samples, four features in each
  /// @param seed   of the noise and the poses
  explicit NoisyScene(int count, unsigned seed = 1) {
    const auto scene = scene_problem();
    truth = scene.table().values();
    const std::vector<double> far = random_values(scene.table(), 0.02, 7);
    for (const std::string& name : names) {
      truth(scene.table().index(name)) = far[static_cast<std::size_t>(scene.table().index(name))];
    }
    samples = exact_samples(scene, span(truth), count, "hand", seed);
    std::mt19937 random(seed + 1000);
    std::normal_distribution<double> noise(0.0, kPointNoise);
    for (Sample& sample : samples) {
      for (Feature& feature : sample.observations[0].features) {
        for (int k = 0; k < 3; ++k) feature.point(k) += noise(random);
      }
    }
  }

  static std::span<const double> span(const Eigen::VectorXd& v) {
    return {v.data(), static_cast<std::size_t>(v.size())};
  }

  /// A problem with these samples.
  [[nodiscard]] std::unique_ptr<AnyProblem> problem(const std::vector<Sample>& with) const {
    std::unique_ptr<AnyProblem> all =
        make_problem(mobile_manipulator(), "base_link", table_with_units(), kSceneFrames);
    all->add_built_in(ChainPoint{}, {"arm", "hand"});
    all->add_built_in(DepthCamera{}, {"camera", "camera_optical_frame"});
    all->add_built_in("points", PointToPoint{}, {"camera", "arm"}, options);
    for (const Sample& sample : with) all->add_sample(sample);
    return all;
  }
  [[nodiscard]] FreeSet free() const { return free_of(scene_table(), names); }

  /// Solves it.
  void solve() {
    calibration = {table_with_units(), {}};
    calibration.steps.push_back({"calibrate", 1000, problem(samples), free(), {}});
    result = calibrate(calibration);
    ASSERT_TRUE(result.converged) << result.termination;
  }
  [[nodiscard]] const AnyProblem& solved() const { return *calibration.steps[0].problem; }
  [[nodiscard]] Eigen::VectorXd values() const { return result.table.values(); }
  [[nodiscard]] Assessment assessment(const AssessOptions& assessing = {}) const {
    return assess(solved(), free(), span(values_), samples, assessing);
  }
  /// The same after solve().
  [[nodiscard]] Assessment solve_and_assess(const AssessOptions& assessing = {}) {
    solve();
    values_ = values();
    return assessment(assessing);
  }
  /// The rows at the solution.
  [[nodiscard]] LinearFit linear(AnyEvaluator& evaluator) {
    values_ = values();
    return linear_fit(evaluator, span(values_),
                      determined_coordinates(solved(), free(), span(values_)));
  }

  /// The solution without some samples, by a fit of its own.
  [[nodiscard]] Eigen::VectorXd values_without(const std::set<std::size_t>& left_out) const {
    std::vector<Sample> kept;
    for (std::size_t i = 0; i < samples.size(); ++i) {
      if (!left_out.contains(i)) kept.push_back(samples[i]);
    }
    const std::unique_ptr<AnyProblem> smaller = problem(kept);
    Eigen::VectorXd found = scene_table().values();
    EXPECT_TRUE(kinecal::solve(*smaller, free(), found).converged);
    return found;
  }

 private:
  Eigen::VectorXd values_;
};

/// Records other positions of a joint than it has.
/// @param error  of a sample, from its number and the joint's position
inline void misread(NoisyScene& scene, const std::string& joint,
                    const std::function<double(std::size_t, double)>& error) {
  for (std::size_t s = 0; s < scene.samples.size(); ++s) {
    Sample& sample = scene.samples[s];
    const auto at = std::find(sample.joint_names.begin(), sample.joint_names.end(), joint);
    ASSERT_NE(at, sample.joint_names.end());
    double& q = sample.joint_positions[static_cast<std::size_t>(at - sample.joint_names.begin())];
    q -= error(s, q);
  }
}

}  // namespace kinecal::test
