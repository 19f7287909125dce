// Definitions of find_lenses.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/tools/cameras/find_lenses.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>

#include "kinecal/config/assemble.hpp"
#include "kinecal/config/choose_images.hpp"
#include "kinecal/config/choose_lenses.hpp"
#include "kinecal/config/doubts/used_joints.hpp"
#include "kinecal/evaluation/any_evaluator.hpp"
#include "kinecal/solve/calibrate.hpp"
#include "kinecal/tools/cameras/start_cameras.hpp"
#include "kinecal/tools/cameras/trial_config.ipp"
#include "kinecal/tools/cameras/tried_lens.ipp"
#include "kinecal/trust/folded_lens.hpp"

namespace kinecal {

namespace detail {
namespace {

/// Mean square of each sample at some values; zero without residuals.
void add_squares(const AnyProblem& problem, const Eigen::VectorXd& values,
                 const std::vector<std::size_t>& numbers, std::vector<double>& squares) {
  std::vector<double> sum(numbers.size(), 0.0), left(numbers.size(), 0.0);
  const FreeSet none({}, problem.table().size());
  (void)problem.evaluator(none, 1)->evaluate(
      {values.data(), static_cast<std::size_t>(values.size())}, false,
      [&](int t, int sample, const TermResiduals& rows) {
        const auto s = static_cast<std::size_t>(sample);
        sum[s] += (problem.term(t).weight * rows.factor.cwiseProduct(rows.residual)).squaredNorm();
        left[s] += static_cast<double>(rows.residual.size()) - rows.used.sum();
      });
  for (std::size_t s = 0; s < numbers.size(); ++s) {
    if (left[s] > 0.5) squares[numbers[s]] = 2.0 * sum[s] / left[s];  // of both coordinates
  }
}

/// Calibrates a lens and predicts what was held out.
void try_lens(const Robot& robot, TriedLens& lens) {
  Diagnostics diagnostics;
  start_cameras(lens.config, robot, lens.samples, diagnostics);
  choose_lenses(lens.config, lens.samples, diagnostics);
  choose_images(lens.config, robot, lens.samples, diagnostics);
  constexpr int kEnough = 100;  // iterations: a lens that does not fit is not worth more
  for (StepConfig& step : lens.config.steps) {
    step.max_num_iterations = std::min(step.max_num_iterations, kEnough);
  }
  const Calibration calibration = assemble(lens.config, robot, lens.samples, diagnostics);
  if (!diagnostics.errors.empty()) {
    lens.fault = diagnostics.errors.front();
    return;
  }
  const CalibrationResult result = calibrate(calibration);
  if (!result.converged) {
    lens.fault = "does not fit";
    return;
  }
  const Eigen::VectorXd solution = result.table.values();
  const CalibrationStep& last = calibration.steps.back();
  const std::vector<FoldedLens> folds =
      folded_lenses(*last.problem, last.free,
                    {solution.data(), static_cast<std::size_t>(solution.size())}, lens.samples);
  if (!folds.empty() && folds.front().is_among_features()) {
    lens.fault = fmt::format("folds over {:.0f} px from the center", folds.front().radius);
    return;
  }
  constexpr std::size_t kFolds = 5;
  lens.squares.assign(lens.samples.size(), 0.0);
  const auto& poses = last.problem->poses_of_samples();
  for (std::size_t fold = 0; fold < kFolds; ++fold) {
    std::unique_ptr<AnyProblem> fitted = last.problem->without_samples();
    const std::unique_ptr<AnyProblem> held_out = last.problem->without_samples();
    std::vector<std::size_t> numbers;
    std::vector<std::vector<Pose<double>>> of_fitted, of_held_out;
    for (std::size_t s = 0; s < lens.samples.size(); ++s) {
      const bool out = s % kFolds == fold;
      (out ? held_out : fitted)->add_sample(lens.samples[s]);
      if (!poses.empty()) (out ? of_held_out : of_fitted).push_back(poses[s]);
      if (out) numbers.push_back(s);
    }
    fitted->set_poses_of_samples(of_fitted);
    held_out->set_poses_of_samples(of_held_out);
    Calibration of_fold{result.table, {}};
    of_fold.steps.push_back(
        {"fold", last.max_num_iterations, std::move(fitted), last.free, {}, {}});
    constexpr double kSettled = 1e-8;  // of the cost
    const Eigen::VectorXd values =
        calibrate(of_fold, {}, {.function_tolerance = kSettled}).table.values();
    add_squares(*held_out, values, numbers, lens.squares);
  }
}

/// "plumb_bob 22.7 px, equidistant 0.84 px, double_sphere: folds over"
[[nodiscard]] std::string errors_text(const std::vector<TriedLens>& tried) {
  std::string text;
  for (const TriedLens& lens : tried) {
    text += text.empty() ? "" : ", ";
    text += lens.fault.empty() ? fmt::format("{} {:.4g} px", lens.name, lens.error())
                               : fmt::format("{}: {}", lens.name, lens.fault);
  }
  return text;
}

}  // namespace
}  // namespace detail

void find_lenses(Config& config, const Robot& robot, std::vector<Sample>& samples,
                 Diagnostics& diagnostics) {
  for (const ModelConfig& camera : detail::models_of(config)) {
    if (camera.lens != kAnyLens) continue;
    std::vector<detail::TriedLens> tried;
    const Config alone = detail::without_others(config, robot, camera);
    for (const std::string_view lens : {DoubleSphere::kName, Equidistant::kName, PlumbBob::kName,
                                        RationalPolynomial::kName, ThinPrism::kName}) {
      const std::string name(lens);
      tried.push_back({name, detail::with_lens(alone, camera, name), samples, {}, {}});
      detail::try_lens(robot, tried.back());
    }
    const auto fits = [](const detail::TriedLens& lens) { return lens.fault.empty(); };
    const auto best = std::find_if(tried.begin(), tried.end(), [&](const detail::TriedLens& one) {
      return fits(one) &&
             std::none_of(tried.begin(), tried.end(), [&](const detail::TriedLens& other) {
               return fits(other) && other.beats(one);
             });
    });
    if (best == tried.end()) {
      const std::string& fault = tried.front().fault;
      const bool same = std::all_of(tried.begin(), tried.end(),
                                    [&](const auto& lens) { return lens.fault == fault; });
      if (same) {
        diagnostics.errors.push_back(fault);
      } else {
        diagnostics.error(camera.place, fmt::format("sensor '{}': no lens fits: {}", camera.name,
                                                    detail::errors_text(tried)));
      }
      continue;
    }
    diagnostics.note(
        camera.place,
        fmt::format("sensor '{}': lens by the error on views held out: {}: taken as {}",
                    camera.name, detail::errors_text(tried), best->name));
    config = detail::with_lens(config, camera, best->name);
    detail::take_camera(camera.name, best->samples, samples);
  }
}

}  // namespace kinecal
