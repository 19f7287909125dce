// Definitions of repeatability.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/study/repeatability.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>
#include <set>
#include <string>
#include <vector>

#include "kinecal/evaluation/any_evaluator.hpp"
#include "kinecal/trust/plain_equations.hpp"
#include "kinecal/trust/verify/pose_change.hpp"

namespace kinecal {

namespace detail {
namespace {

// The difference between a calibration's result and that of the linearized problem, for
// repeatability.cpp.

/// Picks the equivalent values nearest to the truth: angles of joints, and rotation vectors of
/// frames, modulo full turns.
void turn_nearest(const AnyProblem& problem, const std::vector<double>& truth,
                  std::vector<double>& values) {
  const ParameterTable& table = problem.table();
  constexpr double kTurn = 2.0 * std::numbers::pi;
  for (int p = 0; p < table.size(); ++p) {
    const Robot& robot = problem.robot();
    const std::string& name = table[p].name;
    if (!robot.has_joint(name) || !turns(robot.joint(name).type)) continue;
    const auto i = static_cast<std::size_t>(p);
    values[i] -= kTurn * std::round((values[i] - truth[i]) / kTurn);
  }
  for (const std::string& frame : problem.frames()) {
    Vector3<double> turn, of_truth;
    std::array<std::size_t, 3> places{};
    bool has_all = true;
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
      const auto k = static_cast<std::size_t>(axis);
      const int p = table.find(parameter_name(frame, kFrameAxes[k + 3]));
      has_all = has_all && p >= 0;
      if (p < 0) break;
      places[k] = static_cast<std::size_t>(p);
      turn(axis) = values[places[k]];
      of_truth(axis) = truth[places[k]];
    }
    const double angle = has_all ? turn.norm() : 0.0;
    if (!(angle > 0.0)) continue;
    const Vector3<double> other = turn * (1.0 - kTurn / angle);
    if ((other - of_truth).norm() >= (turn - of_truth).norm()) continue;
    for (std::size_t k = 0; k < 3; ++k) values[places[k]] = other(static_cast<Eigen::Index>(k));
  }
}

/// Weighted rows of a problem in evaluation order; the priors' part of the normal equations is
/// computed separately.
struct StackedRows {
  std::vector<double> residual;
  std::vector<double> moved;  ///< J step
};

[[nodiscard]] StackedRows stacked_rows(AnyEvaluator& evaluator, ParameterValues values,
                                       const Eigen::VectorXd& step) {
  StackedRows all;
  (void)evaluator.evaluate(values, step.size() > 0, [&](int term, int, const TermResiduals& rows) {
    const double weight = evaluator.problem().term(term).weight;
    for (Eigen::Index row = 0; row < rows.residual.size(); ++row) {
      const double factor = weight * rows.factor(row);
      all.residual.push_back(factor * rows.residual(row));
      if (step.size() > 0) all.moved.push_back(factor * rows.jacobian.row(row).dot(step));
    }
  });
  return all;
}

/// See StudyTrial::nonlinearity.
[[nodiscard]] double nonlinearity(const StudySetup& setup, const StudyRobot& robot,
                                  std::span<const Sample> measured,
                                  const std::vector<double>& found) {
  const std::unique_ptr<AnyProblem> problem = setup.make();
  for (const Sample& sample : measured) problem->add_sample(sample);
  const FreeSet free(setup.free, problem->table().size());
  const std::unique_ptr<AnyEvaluator> evaluator = problem->evaluator(free, 1);
  const PlainEquations at_truth = plain_equations(*problem, free, robot.truth);
  const Eigen::MatrixXd hessian = at_truth.hessian.matrix();
  const Eigen::VectorXd units =
      hessian.diagonal().unaryExpr([](double d) { return d > 0.0 ? 1.0 / std::sqrt(d) : 1.0; });
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(units.asDiagonal() * hessian *
                                                              units.asDiagonal());
  constexpr double kNothing = 1e-11;  // of the largest eigenvalue
  const double least = kNothing * solver.eigenvalues()(free.size() - 1);
  const Eigen::VectorXd slope =
      solver.eigenvectors().transpose() * units.cwiseProduct(at_truth.gradient.matrix().col(0));
  const Eigen::VectorXd along = slope.binaryExpr(
      solver.eigenvalues(), [&](double g, double e) { return e > least ? -g / e : 0.0; });
  const Eigen::VectorXd step = units.cwiseProduct(solver.eigenvectors() * along);
  const StackedRows before = stacked_rows(*evaluator, robot.truth, step),
                    after = stacked_rows(*evaluator, found, {});
  if (before.residual.size() != after.residual.size()) return 1.0;  // some are undefined
  double far = 0.0, off = 0.0;
  for (std::size_t i = 0; i < before.residual.size(); ++i) {
    const double linear = before.residual[i] + before.moved[i];
    far += before.moved[i] * before.moved[i];
    off += (after.residual[i] - linear) * (after.residual[i] - linear);
  }
  return far > 0.0 ? std::sqrt(off / far) : 0.0;
}

/// A seed for each combination of numbers.  Source: Steele, Lea, Flood, Fast Splittable
/// Pseudorandom Number Generators, 2014, for the mixing.
[[nodiscard]] std::uint64_t mixed_seed(std::initializer_list<std::uint64_t> numbers) {
  std::uint64_t seed = 0;
  for (const std::uint64_t number : numbers) {
    seed += 0x9e3779b97f4a7c15ULL + number;
    seed = (seed ^ (seed >> 30)) * 0xbf58476d1ce4e5b9ULL;
    seed = (seed ^ (seed >> 27)) * 0x94d049bb133111ebULL;
    seed ^= seed >> 31;
  }
  return seed;
}

/// Uses of the seed of a study.
enum class StudySeed : std::uint64_t { truth = 1, poses, noise, judged };

[[nodiscard]] SeededRandom study_random(const StudySetup& setup, StudySeed use,
                                        const StudyJob& job) {
  return SeededRandom(mixed_seed(
      {setup.seed, static_cast<std::uint64_t>(use), static_cast<std::uint64_t>(job.robot),
       static_cast<std::uint64_t>(job.poses), static_cast<std::uint64_t>(job.repeat)}));
}

/// The joints that affect observations.
[[nodiscard]] std::set<std::string> observed_joints(const AnyProblem& problem) {
  std::set<std::string> joints;
  for (const MountedSensor& sensor : problem.sensors()) {
    for (const SampledChain& chain : sensor.chains()) {
      for (const ChainJoint& joint : chain.chain().joints) {
        if (moves(joint.type)) joints.insert(std::string(joint.drive.joint));
      }
    }
  }
  return joints;
}

/// Moves one joint away from the sample's position.
void ruin(const StudySetup& setup, const std::set<std::string>& joints, Sample& sample,
          SeededRandom& random) {
  std::vector<std::size_t> those;
  for (std::size_t i = 0; i < sample.joint_names.size(); ++i) {
    if (joints.contains(sample.joint_names[i])) those.push_back(i);
  }
  if (those.empty()) return;
  const std::size_t i =
      those[static_cast<std::size_t>(random.integer(0, static_cast<int>(those.size()) - 1))];
  sample.joint_positions[i] += random.either_sign(setup.ruined_by, setup.ruined_by);
}

/// Mean distance of the features of the first error block that has any.
[[nodiscard]] double mean_reprojection(const StudySetup& setup, std::span<const Sample> samples,
                                       ParameterValues values) {
  const std::unique_ptr<AnyProblem> problem = setup.make();
  for (const Sample& sample : samples) problem->add_sample(sample);
  std::vector<double> sums(static_cast<std::size_t>(problem->num_terms()), 0.0), counts = sums;
  (void)problem->evaluator(FreeSet({}, problem->table().size()), 1)
      ->evaluate(values, false, [&](int term, int, const TermResiduals& rows) {
        const Eigen::Index size = problem->term(term).feature_size;
        const auto t = static_cast<std::size_t>(term);
        for (Eigen::Index row = 0; row < rows.residual.size(); row += size) {
          sums[t] += rows.residual.segment(row, size).norm();
          counts[t] += 1.0;
        }
      });
  for (std::size_t t = 0; t < sums.size(); ++t) {
    if (counts[t] > 0.0) return sums[t] / counts[t];
  }
  return 0.0;
}

}  // namespace
}  // namespace detail

std::vector<double> study_truth(const StudySetup& setup, int number) {
  const std::unique_ptr<AnyProblem> problem = setup.make();
  SeededRandom random = detail::study_random(setup, detail::StudySeed::truth, {number, 0, 0});
  std::vector<double> truth = setup.drawn;
  for (const int p : setup.free) {
    const double size = error_size(problem->robot(), problem->table()[p].name, setup.errors);
    truth[static_cast<std::size_t>(p)] += random.either_sign(0.5 * size, size);
  }
  return truth;
}

StudyRobot study_robot(const StudySetup& setup, int number) {
  StudyRobot robot{number, study_truth(setup, number), {}};
  robot.samples = exact_samples(setup.make, robot.truth, setup.samples);
  return robot;
}

std::vector<int> study_poses(const StudySetup& setup, const StudyJob& job) {
  std::vector<int> all(setup.samples.size());
  std::iota(all.begin(), all.end(), 0);
  SeededRandom random = detail::study_random(setup, detail::StudySeed::poses, {0, job.poses, 0});
  const int count = std::min(job.poses, static_cast<int>(all.size()));
  for (int i = 0; i < count; ++i) {
    std::swap(all[static_cast<std::size_t>(i)],
              all[static_cast<std::size_t>(random.integer(i, static_cast<int>(all.size()) - 1))]);
  }
  all.resize(static_cast<std::size_t>(count));
  std::sort(all.begin(), all.end());
  return all;
}

StudyTrial run_study_job(const StudySetup& setup, const StudyRobot& robot, const StudyJob& job) {
  const std::unique_ptr<AnyProblem> problem = setup.make();
  const std::set<std::string> measuring = measuring_sensors(*problem, robot.samples);
  const std::set<std::string> joints = detail::observed_joints(*problem);
  SeededRandom random = detail::study_random(setup, detail::StudySeed::noise, job);
  StudyTrial trial{.job = job};
  std::vector<Sample> measured;
  for (const int i : study_poses(setup, job)) {
    const Sample& exact = robot.samples[static_cast<std::size_t>(i)];
    measured.push_back(with_noise(exact, *problem, measuring, setup.noise, random));
    if (!(random.uniform(0.0, 1.0) < setup.ruined)) continue;
    detail::ruin(setup, joints, measured.back(), random);
    ++trial.ruined;
  }
  StudyFit fit = setup.fit(measured);
  detail::turn_nearest(*problem, robot.truth, fit.values);
  trial.converged = fit.converged;
  trial.left_out = fit.left_out;
  trial.seconds = fit.seconds;
  trial.solves = fit.solves;
  for (const int p : setup.free) {
    trial.values.push_back(fit.values[static_cast<std::size_t>(p)]);
  }
  trial.nonlinearity = detail::nonlinearity(setup, robot, measured, fit.values);
  const PoseChange off = pose_change({*problem, robot.truth}, {*problem, fit.values}, robot.samples,
                                     setup.frame, setup.in);
  trial.position = off.position;
  trial.rotation = off.rotation;
  SeededRandom judged = detail::study_random(setup, detail::StudySeed::judged, {job.robot, 0, 0});
  std::vector<Sample> others;
  for (const Sample& exact : robot.samples) {
    others.push_back(with_noise(exact, *problem, measuring, setup.noise, judged));
  }
  trial.reprojection = detail::mean_reprojection(setup, others, fit.values);
  trial.systematic = detail::mean_reprojection(setup, robot.samples, fit.values);
  return trial;
}

double error_before(const StudySetup& setup, ParameterValues truth) {
  const std::unique_ptr<AnyProblem> problem = setup.make();
  return pose_change({*problem, truth}, {*problem, setup.drawn}, setup.samples, setup.frame,
                     setup.in)
      .position;
}

}  // namespace kinecal
