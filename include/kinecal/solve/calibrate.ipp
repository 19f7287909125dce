// Solving the steps of a calibration.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <set>
#include <stdexcept>

#include "kinecal/solve/calibrate.hpp"
#include "kinecal/solve/settle.hpp"
#include "kinecal/text/nearest_name.hpp"

namespace kinecal {

namespace detail {

KINECAL_INLINE void add_step(StepResult step, const FreeSet& free, CalibrationResult& result) {
  for (const int parameter : free.parameters()) {
    const auto& known = result.calibrated;
    if (std::find(known.begin(), known.end(), parameter) == known.end()) {
      result.calibrated.push_back(parameter);
    }
  }
  result.converged = step.converged;
  result.termination = step.termination;
  result.steps.push_back(std::move(step));
}

KINECAL_INLINE void merge_statistics(std::vector<BlockStatistics>& all,
                                     std::vector<BlockStatistics> more) {
  for (BlockStatistics& block : more) {
    const auto same = std::find_if(all.begin(), all.end(),
                                   [&](const auto& known) { return known.name == block.name; });
    if (same == all.end()) {
      all.push_back(std::move(block));
    } else {
      *same = std::move(block);
    }
  }
}

/// The parameters of a free set that affect some residual of a problem, in their order.
[[nodiscard]] inline FreeSet affecting(const AnyProblem& problem, const FreeSet& free) {
  const std::vector<int> touched = problem.touched_parameters();
  std::vector<int> kept = free.parameters();
  std::erase_if(kept,
                [&](int p) { return !std::binary_search(touched.begin(), touched.end(), p); });
  return {std::move(kept), problem.table().size()};
}

/// The frames whose pose is searched for where the start fails: virtual ones, and fixed joints of which all
/// axes are free, a bracket or a stand.
[[nodiscard]] inline std::vector<UnknownFrame> doubtful_frames(const AnyProblem& problem,
                                                               const FreeSet& free) {
  std::vector<UnknownFrame> frames;
  for (const std::string& name : problem.frames()) {
    UnknownFrame frame = unknown_frame(name, problem.table(), free, true);
    const Robot& robot = problem.robot();
    const bool on_robot = robot.has_joint(name);
    if (on_robot && robot.joint(name).type != JointType::fixed) continue;
    const auto held = std::count(frame.axes.begin(), frame.axes.end(), -1);
    if (frame.turns() && (!on_robot || held == 0)) frames.push_back(std::move(frame));
  }
  return frames;
}

}  // namespace detail

KINECAL_INLINE void CalibrationStep::set_sigma(int term, double sigma) {
  problem->set_sigma(term, sigma);
  if (excerpt == nullptr) return;
  const Term& changed = problem->term(term);
  for (int t = 0; t < excerpt->num_terms(); ++t) {
    const Term& same = excerpt->term(t);  // unless it compares lines of sight in place of pixels
    if (same.name == changed.name && same.options.type == changed.options.type) {
      excerpt->set_sigma(t, sigma);
    }
  }
}

KINECAL_INLINE void CalibrationStep::exclude(const std::set<int>& samples) {
  std::vector<int> now;  // number of each sample that is left
  for (int i = 0, left = 0; i < problem->num_samples(); ++i) {
    now.push_back(samples.contains(i) ? -1 : left++);
  }
  problem->exclude(samples);
  free = detail::affecting(*problem, free);
  if (free.size() == 0) {
    throw std::invalid_argument("step '" + name +
                                "': the samples that are left determine none of its free "
                                "parameters");
  }
  if (excerpt == nullptr) return;
  std::set<int> gone;
  std::vector<int> kept;
  for (std::size_t i = 0; i < of_excerpt.size(); ++i) {
    const int number = now[static_cast<std::size_t>(of_excerpt[i])];
    if (number < 0) {
      gone.insert(static_cast<int>(i));
    } else {
      kept.push_back(number);
    }
  }
  excerpt->exclude(gone);
  of_excerpt = std::move(kept);
  if (excerpt->num_residuals() == 0) excerpt.reset();
}

KINECAL_INLINE void exclude(Calibration& calibration, const std::set<int>& samples,
                            std::vector<Sample>& list) {
  for (CalibrationStep& step : calibration.steps) step.exclude(samples);
  for (auto i = samples.rbegin(); i != samples.rend(); ++i) list.erase(list.begin() + *i);
}

KINECAL_INLINE CalibrationResult calibrate(const Calibration& calibration, const Progress& progress,
                                           const SolveOptions& solving) {
  CalibrationResult result;
  result.table = calibration.table;
  const Eigen::VectorXd initial = calibration.table.values();
  Eigen::VectorXd values = initial;
  if (!calibration.begin.empty()) {
    values = Eigen::Map<const Eigen::VectorXd>(calibration.begin.data(), values.size());
  }
  for (const CalibrationStep& step : calibration.steps) {
    for (const auto& [parameter, value] : step.assignments) values(parameter) = value;
    SolveOptions options = solving;
    options.max_num_iterations = step.max_num_iterations;
    options.progress = {};
    if (progress) {
      options.progress = [&](int iteration, double cost) { progress(step.name, iteration, cost); };
    }
    const Eigen::VectorXd start = values;
    StepResult solved = solve_from_starts(*step.problem, step.free, values, options,
                                          step.unknown_frames, step.excerpt.get());
    if (solved.converged) {
      wrap_angles(*step.problem, step.free, values);
      if (solving.hold_undetermined) {
        solved.final_cost = hold_undetermined(*step.problem, step.free, start, values);
      }
    }
    if (!step.problem->sample_poses().empty()) {
      step.problem->set_poses_of_samples(
          step.problem->evaluator(step.free, 1)
              ->sample_poses({values.data(), static_cast<std::size_t>(values.size())}));
    }
    solved.name = step.name;
    detail::add_step(std::move(solved), step.free, result);
    if (!result.converged) break;
  }
  const auto span = [](const Eigen::VectorXd& v) {
    return std::span<const double>(v.data(), static_cast<std::size_t>(v.size()));
  };
  for (std::size_t s = 0; s < result.steps.size(); ++s) {
    detail::merge_statistics(result.blocks, block_statistics(*calibration.steps[s].problem,
                                                             span(initial), span(values)));
  }
  for (int i = 0; i < result.table.size(); ++i) {
    result.table[i].initial = initial(i);
    result.table[i].value = values(i);
  }
  return result;
}

namespace detail {

/// Checks that each sensor is observed, where a sensor of nearly the same name is.
inline void check_names_of_sensors(const AnyProblem& problem, std::span<const Sample> samples) {
  std::set<std::string> observed;
  for (const Sample& sample : samples) {
    for (const Observation& seen : sample.observations) observed.insert(seen.sensor);
  }
  std::vector<std::string> unknown(observed.begin(), observed.end());
  for (const MountedSensor& sensor : problem.sensors()) {
    std::erase(unknown, sensor.mount().name);
  }
  for (const MountedSensor& sensor : problem.sensors()) {
    const std::string& name = sensor.mount().name;
    if (observed.contains(name) || !nearest_name(name, unknown)) continue;
    throw std::invalid_argument("no sample has an observation of sensor '" + name + "'" +
                                did_you_mean(name, unknown));
  }
}

}  // namespace detail

KINECAL_INLINE Calibration make_calibration(std::unique_ptr<AnyProblem> problem,
                                            const FreeSet& free, std::span<const Sample> samples,
                                            const std::string& step) {
  problem->check(free);
  detail::check_names_of_sensors(*problem, samples);
  for (const Sample& sample : samples) problem->add_sample(sample);
  if (problem->touched_parameters().empty()) {
    throw std::invalid_argument("no sample has usable features of all sensors of an error block");
  }
  FreeSet columns = detail::affecting(*problem, free);
  std::vector<UnknownFrame> doubtful = detail::doubtful_frames(*problem, columns);
  Calibration calibration{problem->table(), {}};
  calibration.steps.push_back({step,
                               SolveOptions{}.max_num_iterations,
                               std::move(problem),
                               std::move(columns),
                               {},
                               std::move(doubtful)});
  return calibration;
}

}  // namespace kinecal
