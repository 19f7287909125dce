// State and updates of a calibration that follows a session.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <utility>

#include "kinecal/geometry/ldlt.hpp"
#include "kinecal/solve/determined_spectrum.ipp"
#include "kinecal/trust/measured_numbers.hpp"
#include "kinecal/trust/online.hpp"
#include "kinecal/trust/pose_variance.ipp"

namespace kinecal {

struct OnlineCalibration::Impl {
  MakeProblem make;
  FreeSet free;
  std::vector<double> values;
  FrameOnRobot frame, in;
  std::unique_ptr<AnyProblem> problem = make();  ///< with the samples
  std::vector<Sample> samples = {};              ///< of the problem
  std::vector<int> numbers = {};                 ///< of each of them: of the call of add(), from 1
  int added = 0;                                 ///< calls of add()
  std::vector<Sample> ahead = {};                ///< poses where the pose is wanted as well
  Eigen::MatrixXd hessian = {};                  ///< (free x free) at the values
  double noise2 = 0.0;                           ///< s^2
  int freedom = 0;                               ///< residuals left for the noise
  int measured = 0;                              ///< numbers: see measured_numbers()

  void step_to_minimum(AnyEvaluator& evaluator);
  void estimate_noise(AnyEvaluator& evaluator, double cost);
  [[nodiscard]] double innovation(AnyEvaluator& evaluator, int& rows) const;
  void set_pose(OnlineState& state) const { set_pose(state, hessian); }
  void set_pose(OnlineState& state, const Eigen::MatrixXd& information) const;
  [[nodiscard]] bool add_if_it_fits(const Sample& sample, OnlineState& state);
  [[nodiscard]] std::optional<std::size_t> misfit(AnyEvaluator& evaluator) const;
  void leave_out(std::size_t sample);
  [[nodiscard]] std::vector<std::pair<NextMove, Sample>> candidates(double step) const;
};

namespace detail {

/// Rows and derivatives of one sample, weighted.
struct SampleRows {
  Eigen::VectorXd residual = {};
  Eigen::MatrixXd jacobian = {};
  double used = 0.0;  ///< of the rows, by the sample's own poses

  void append(const TermResiduals& rows, double weight) {
    const Eigen::Index before = residual.size(), added = rows.residual.size();
    residual.conservativeResize(before + added);
    jacobian.conservativeResize(before + added, rows.jacobian.cols());
    residual.tail(added) = weight * rows.residual;
    jacobian.bottomRows(added) = weight * rows.jacobian;
    if (rows.used.size() > 0) used += rows.used.sum();
  }
};

/// The number of residuals that the poses of samples use up.
[[nodiscard]] inline double used_by_poses(AnyEvaluator& evaluator, ParameterValues values) {
  double used = 0.0;
  (void)evaluator.evaluate(values, false, [&](int, int, const TermResiduals& rows) {
    if (rows.used.size() > 0) used += rows.used.sum();
  });
  return used;
}

}  // namespace detail

/// Gauss-Newton steps, halved until the cost falls.
inline void OnlineCalibration::Impl::step_to_minimum(AnyEvaluator& evaluator) {
  constexpr int kSteps = 8, kHalves = 6;
  constexpr double kSettled = 1e-6;    // of the cost
  constexpr double kUncertain = 1e-4;  // of the largest singular value: no steps along these
  NormalEquations at = evaluator.normal_equations(values);
  for (int i = 0; i < kSteps && std::isfinite(at.cost); ++i) {
    const detail::Spectrum spectrum(at.hessian);
    const Eigen::VectorXd units = spectrum.scale.cwiseInverse();
    const Eigen::VectorXd slope = spectrum.vectors.transpose() * units.cwiseProduct(at.gradient);
    const double least = kUncertain * spectrum.singular.maxCoeff();
    const Eigen::VectorXd along = slope.binaryExpr(
        spectrum.singular, [&](double g, double s) { return s > least ? -g / (s * s) : 0.0; });
    const Eigen::VectorXd step = units.cwiseProduct(spectrum.vectors * along);
    const double before = at.cost;
    double factor = 1.0;
    for (int h = 0; h < kHalves; ++h, factor *= 0.5) {
      std::vector<double> trial = values;
      for (int c = 0; c < free.size(); ++c) {
        const Parameter& parameter =
            problem->table()[free.parameters()[static_cast<std::size_t>(c)]];
        double& value =
            trial[static_cast<std::size_t>(free.parameters()[static_cast<std::size_t>(c)])];
        value = std::clamp(value + factor * step(c), parameter.lower, parameter.upper);
      }
      NormalEquations there = evaluator.normal_equations(trial);
      if (!(there.cost <= before)) continue;
      values = std::move(trial);
      at = std::move(there);
      break;
    }
    if (before - at.cost <= kSettled * before) break;
  }
  hessian = at.hessian;
  estimate_noise(evaluator, at.cost);
  problem->set_poses_of_samples(evaluator.own_poses(values));
}

inline void OnlineCalibration::Impl::estimate_noise(AnyEvaluator& evaluator, double cost) {
  const detail::Spectrum spectrum(hessian);
  const auto rank = static_cast<int>(spectrum.singular.size() - spectrum.null);
  const int of_priors = static_cast<int>(problem->priors().size()) * Prior::kRows;
  const double used = problem->own_poses().empty() ? 0.0 : detail::used_by_poses(evaluator, values);
  freedom = problem->num_residuals() - of_priors - rank - static_cast<int>(std::lround(used));
  const double of_features = cost - detail::prior_equations(*problem, free, values).cost;
  noise2 = freedom > 0 ? std::max(0.0, 2.0 * of_features / freedom) : 0.0;
  measured = measured_numbers(*problem, values);
}

/// X of the last sample; zero if it has no residuals.
inline double OnlineCalibration::Impl::innovation(AnyEvaluator& evaluator, int& rows) const {
  detail::SampleRows last;
  const int number = problem->num_samples() - 1;
  (void)evaluator.evaluate(values, true, [&](int term, int sample, const TermResiduals& of_term) {
    if (sample == number) last.append(of_term, problem->term(term).weight);
  });
  rows = static_cast<int>(last.residual.size()) - static_cast<int>(std::lround(last.used));
  if (rows <= 0) return 0.0;
  const Eigen::MatrixXd covariance = noise2 * detail::Spectrum(hessian).pseudo_inverse();
  Eigen::MatrixXd expected = last.jacobian * covariance * last.jacobian.transpose();
  expected.diagonal().array() += noise2;
  return last.residual.dot(detail::Ldlt(expected).solve(last.residual)) / rows;
}

namespace detail {

/// A few samples, evenly over a session.
inline std::vector<const Sample*> some_of(const std::vector<Sample>& samples) {
  constexpr std::size_t kPoses = 16;
  std::vector<const Sample*> some;
  const std::size_t count = std::min(kPoses, samples.size());
  for (std::size_t i = 0; i < count; ++i) {
    some.push_back(&samples[(2 * i + 1) * samples.size() / (2 * count)]);
  }
  return some;
}

}  // namespace detail

/// The worse of captured poses and poses ahead.
inline void OnlineCalibration::Impl::set_pose(OnlineState& state,
                                              const Eigen::MatrixXd& information) const {
  const detail::Spectrum spectrum(information);
  const Eigen::MatrixXd covariance = noise2 * spectrum.pseudo_inverse();
  const Eigen::MatrixXd null =
      spectrum.scale.cwiseInverse().asDiagonal() * spectrum.vectors.leftCols(spectrum.null);
  detail::PoseDerivative derivative(*problem, free, values, frame, in);
  // With less redundancy, neither the noise nor the poses mean much.
  constexpr double kToSpare = 2.0;  // residuals per determined direction
  const auto rank = static_cast<double>(spectrum.singular.size() - spectrum.null);
  state.known = freedom >= kToSpare * rank && measured >= free.size();
  state.position = state.rotation = 0.0;
  for (const std::vector<Sample>* poses : {&samples, &ahead}) {
    detail::PoseVariance variance(0.0);
    for (const Sample* sample : detail::some_of(*poses)) {
      if (const auto jacobian = derivative.at(*sample)) variance.add(*jacobian, covariance, null);
    }
    const PoseUncertainty there = variance.result(frame, in);
    state.known = state.known && there.determined;
    state.position = std::max(state.position, there.position);
    state.rotation = std::max(state.rotation, there.rotation);
  }
}

}  // namespace kinecal
