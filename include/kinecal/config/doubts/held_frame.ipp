// A frame of the robot that is held and whose change explains residuals: a link that is longer than in the URDF, an
// axis that is not where the drawing has it.
//
// All frames of joints are freed beside the free parameters, and the rows linearized once at the result.  The fall
// of the sum of squares with one frame's translation, or its rotation, follows by linear algebra.
// Source: Rao, Large Sample Tests of Statistical Hypotheses, 1948, the score test.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <optional>
#include <set>
#include <string>
#include <vector>

#include "kinecal/config/assemble.hpp"
#include "kinecal/config/doubts/find_doubts.hpp"
#include "kinecal/trust/calibrate_and_judge.hpp"
#include "kinecal/trust/unexplained.ipp"

namespace kinecal::detail {

/// Names of the joints on the chains of a problem's sensors.
[[nodiscard]] inline std::set<std::string> joints_of_sensors(const AnyProblem& problem) {
  std::set<std::string> names;
  for (const MountedSensor& sensor : problem.sensors()) {
    for (const Joint* joint : joints_to_root(problem.robot(), sensor.mount().frame)) {
      names.insert(joint->name);
    }
  }
  return names;
}

/// The last step with all axes of the frames of these joints free.
[[nodiscard]] inline Config with_free_frames(Config config, const std::set<std::string>& joints) {
  StepConfig& step = config.steps.back();
  constexpr std::array<bool, 6> kAll = {true, true, true, true, true, true};
  std::set<std::string> missing = joints;
  for (FreeFrameConfig& frame : step.free_frames) {
    if (missing.erase(frame.name) == 0 || frame.is_fixed) continue;
    frame.axes = kAll;
  }
  for (const std::string& joint : missing) step.free_frames.push_back({joint, kAll, step.place});
  return config;
}

/// All free parameters as coordinates.
[[nodiscard]] inline Coordinates plain_coordinates(int size) {
  return {Eigen::MatrixXd::Identity(size, size), Eigen::MatrixXd(size, 0),
          Eigen::VectorXd::Zero(size), Eigen::VectorXd::Ones(size)};
}

/// The rows of a result with more parameters than it had free.
class MoreParameters {
 public:
  MoreParameters(const AnyProblem& problem, const FreeSet& all, std::span<const double> values,
                 const std::set<std::string>& free)
      : problem_(problem), all_(all) {
    const auto evaluator = problem.evaluator(all);
    fit_ = linear_fit(*evaluator, values, plain_coordinates(all.size()));
    for (int c = 0; c < all.size(); ++c) {
      if (free.contains(name(c))) free_.push_back(c);
    }
    const Eigen::MatrixXd inside = information(fit_, fit_.loss)(free_, free_);
    inverse_ = Spectrum(inside).pseudo_inverse();
    squares_ = fit_.loss.dot(fit_.residual.cwiseAbs2());
  }

  [[nodiscard]] const std::string& name(int column) const {
    return problem_.table()[all_.parameters()[static_cast<std::size_t>(column)]].name;
  }
  [[nodiscard]] bool is_free(int column) const {
    return std::find(free_.begin(), free_.end(), column) != free_.end();
  }
  [[nodiscard]] const FreeSet& all() const { return all_; }
  [[nodiscard]] bool nothing_left() const { return is_exact(problem_, fit_); }

  /// Noise that is left with some held parameters, 1 without evidence; and their change.
  /// @param tests  number of hypotheses
  [[nodiscard]] std::pair<double, Eigen::VectorXd> left_with(const std::vector<int>& held,
                                                             double tests) const {
    constexpr double kChance = 1e-6;
    const Eigen::MatrixXd x = fit_.jacobian(Eigen::all, held);
    const Eigen::MatrixXd weighted = fit_.loss.asDiagonal() * x;
    const Eigen::MatrixXd inside = fit_.jacobian(Eigen::all, free_);
    const AddedColumns added{weighted.transpose() * x, weighted.transpose() * inside,
                             weighted.transpose() * fit_.residual};
    const Eigen::VectorXd scale = added.squared.diagonal().unaryExpr(
        [](double a) { return a > 0.0 ? 1.0 / std::sqrt(a) : 0.0; });
    const Fall fall = fall_of(added, scale, inverse_);
    const auto q = static_cast<int>(held.size());
    const auto freedom = static_cast<double>(fit_.residual.size() - std::ssize(free_));
    if (freedom <= 2.0 * q) return {1.0, fall.change};
    const double share = std::clamp(fall.squares / squares_, 0.0, 1.0);
    if (tests * chance_of_share(share, q, freedom) > kChance) return {1.0, fall.change};
    for (std::size_t i = 0; i < free_.size(); ++i) {
      const int p = all_.parameters()[static_cast<std::size_t>(free_[i])];
      const double moves = std::abs(fall.others(static_cast<Eigen::Index>(i)));
      if (plausible_change(problem_, p).exceeded(moves)) return {1.0, fall.change};
    }
    return {std::sqrt((1.0 - share) * freedom / (freedom - q)), fall.change};
  }

 private:
  const AnyProblem& problem_;
  const FreeSet& all_;
  LinearFit fit_;
  std::vector<int> free_;
  Eigen::MatrixXd inverse_;
  double squares_ = 0.0;
};

/// Whether residuals are larger than what robots are good to: a thousandth of their size, or a pixel.
[[nodiscard]] inline bool matters(const Assessment& step) {
  constexpr double kOfSize = 1e-3, kPixel = 1.0;
  return std::any_of(step.noise.begin(), step.noise.end(), [&](const BlockNoise& noise) {
    const double distance = noise.sigma * std::sqrt(static_cast<double>(noise.components));
    return distance > (noise.unit == "m" ? kOfSize * step.size : kPixel);
  });
}

/// A held frame whose change explains residuals, as a sentence; nullopt if none does.
[[nodiscard]] inline std::optional<std::string> held_frame(const CalibrationInput& input,
                                                           const JudgedResult& judged) {
  const CalibrationStep& last = input.calibration.steps.back();
  const std::set<std::string> joints = joints_of_sensors(*last.problem);
  Diagnostics quiet;
  const Calibration more =
      assemble(with_free_frames(input.config, joints), input.robot, input.samples, quiet);
  if (!quiet.errors.empty() || more.steps.size() != input.calibration.steps.size()) return {};
  const AnyProblem& problem = *more.steps.back().problem;
  if (problem.num_terms() != last.problem->num_terms()) return {};
  for (int t = 0; t < problem.num_terms(); ++t) {
    more.steps.back().problem->set_sigma(t, last.problem->term(t).sigma);
  }
  Eigen::VectorXd values = problem.table().values();
  for (int p = 0; p < problem.table().size(); ++p) {
    const int known = judged.result.table.find(problem.table()[p].name);
    if (known >= 0) values(p) = judged.result.table[known].value;
  }
  std::set<std::string> free;
  for (const int p : last.free.parameters()) free.insert(last.problem->table()[p].name);
  const MoreParameters rows(problem, more.steps.back().free,
                            {values.data(), static_cast<std::size_t>(values.size())}, free);
  if (rows.nothing_left() || !matters(judged.assessments.back())) return {};
  constexpr double kLeft = 0.75;
  double best = judged.assessments.back().pattern
                    ? std::min(kLeft, kLeft * judged.assessments.back().pattern->noise_left)
                    : kLeft;
  std::optional<std::string> sentence;
  for (const std::string& joint : joints) {
    for (const bool rotation : {false, true}) {
      std::vector<int> held;
      for (int c = 0; c < rows.all().size(); ++c) {
        for (std::size_t i = 0; i < 3; ++i) {
          const std::string name = parameter_name(joint, kFrameAxes[i + (rotation ? 3 : 0)]);
          if (rows.name(c) == name && !rows.is_free(c)) held.push_back(c);
        }
      }
      if (held.empty()) continue;
      const auto [left, change] = rows.left_with(held, 2.0 * static_cast<double>(joints.size()));
      if (!(left < best)) continue;
      best = left;
      const double size = change.norm();
      sentence = fmt::format(
          "with '{}' {} from where the URDF has it, which is held, the noise falls to {}; free its "
          "frame, or is the URDF of another robot?",
          joint,
          rotation ? fmt::format("turned by {:.2g} deg", size * 180.0 / std::numbers::pi)
                   : fmt::format("{:.2g} mm away", 1e3 * size),
          fmt::format("{:.3g} %", 1e2 * left));
    }
  }
  return sentence;
}

}  // namespace kinecal::detail
