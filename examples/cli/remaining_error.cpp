// SPDX-License-Identifier: Apache-2.0
#include "remaining_error.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <span>

#include "kinecal/text/counted.hpp"
#include "kinecal/trust/verify/pose_change.hpp"
#include "pose_choice.hpp"

namespace kinecal::cli {
namespace {

constexpr int kRobots = 3;  // drawn ones, of which it is checked what their calibrations leave

/// A study of some samples, and after them of others at which the result is judged.
StudySetup setup_of_set(const StudyInput& input, const std::vector<int>& set) {
  StudySetup setup = input.setup;
  setup.samples.clear();
  for (const int i : set) {
    setup.samples.push_back(input.setup.samples[static_cast<std::size_t>(i)]);
  }
  constexpr std::size_t kJudged = 50;
  const std::size_t all = input.setup.samples.size();
  for (std::size_t i = 0; i < all; i += std::max<std::size_t>(1, all / kJudged)) {
    setup.samples.push_back(input.setup.samples[i]);
  }
  return setup;
}

/// Calibrations of drawn robots with exact samples.
/// @param count    the first samples of the setup, to calibrate with
/// @param change   of each robot's true values
/// @param meter    called for each robot
/// @returns  of the error: robots and position
template <class Change>
RemainingError calibrate_exactly(const StudyInput& input, const StudySetup& setup,
                                 std::size_t count, const Config& config, Change change,
                                 const ProgressMeter& meter) {
  RemainingError remaining;
  double sum = 0.0;
  const std::unique_ptr<AnyProblem> problem = setup.make();
  for (int number = 0; number < kRobots; ++number) {
    if (meter) meter(static_cast<double>(number) / kRobots, "calibrating without noise");
    std::vector<double> truth = study_truth(setup, number);
    change(truth);
    try {
      const std::vector<Sample> exact = exact_samples(setup.make, truth, setup.samples);
      const StudyFit fit = fit_study(input, config, std::span(exact).first(count));
      const PoseChange off =
          pose_change({*problem, truth}, {*problem, fit.values}, exact, setup.frame, setup.in);
      sum += off.position * off.position;
      ++remaining.robots;
    } catch (const StudyError&) {
      continue;  // a point behind the camera of this robot says nothing of the others
    }
  }
  remaining.position = std::sqrt(sum / std::max(1, remaining.robots));
  return remaining;
}

/// The configuration without one of its priors, or without all.
Config without_priors(Config config, const std::string& only = "") {
  for (StepConfig& step : config.steps) {
    std::erase_if(step.error_blocks, [&](const BlockConfig& block) {
      return block.type == "outrageous" && (only.empty() || block.name == only);
    });
  }
  return config;
}

/// Names of the last step's priors.
std::vector<std::string> priors_of(const Config& config) {
  std::vector<std::string> names;
  for (const BlockConfig& block : config.steps.back().error_blocks) {
    if (block.type == "outrageous") names.push_back(block.name);
  }
  return names;
}

/// Parameters that are held at another value than they are simulated with, by index.
std::vector<int> held_elsewhere(const StudyInput& input) {
  std::vector<int> held;
  const std::vector<int>& free = input.setup.free;
  for (std::size_t p = 0; p < input.configured.size(); ++p) {
    const auto index = static_cast<int>(p);
    constexpr double kSame = 1e-9;  // metres, radians
    if (std::abs(input.configured[p] - input.setup.drawn[p]) < kSame) continue;
    if (std::find(free.begin(), free.end(), index) == free.end()) held.push_back(index);
  }
  return held;
}

/// "'a', 'b'"
std::string listed(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "'" : ", '") + name + "'";
  return text;
}

}  // namespace

RemainingError remaining_error(const StudyInput& input, const std::vector<int>& set,
                               double tolerated, const ProgressMeter& meter) {
  const StudySetup setup = setup_of_set(input, set);
  const std::vector<std::string> priors = priors_of(input.config);
  const std::vector<int> held = held_elsewhere(input);
  const auto left_by = [&](const Config& config, bool as_configured) {
    const auto change = [&](std::vector<double>& truth) {
      for (const int p : held) {
        const auto i = static_cast<std::size_t>(p);
        if (as_configured) truth[i] = input.configured[i];
      }
    };
    return calibrate_exactly(input, setup, set.size(), config, change, meter);
  };
  const auto helps = [&](const Config& config, bool as_configured) {
    const RemainingError left = left_by(config, as_configured);
    return left.robots > 0 && left.position <= tolerated;
  };
  RemainingError remaining = left_by(input.config, false);
  if (!(remaining.position > tolerated)) return remaining;
  const Config without = without_priors(input.config);
  const bool by_priors = !priors.empty() && helps(without, false);
  const bool by_held = !by_priors && !held.empty() && helps(input.config, true);
  const bool by_both =
      !by_priors && !by_held && !priors.empty() && !held.empty() && helps(without, true);
  if (by_priors || by_both) {
    const auto cause = std::find_if(priors.begin(), priors.end(), [&](const std::string& name) {
      return helps(without_priors(input.config, name), by_both);
    });
    remaining.priors = cause == priors.end() ? priors : std::vector<std::string>{*cause};
  }
  if (!by_held && !by_both) return remaining;
  for (const int p : held) remaining.held.push_back(input.calibration.table[p].name);
  return remaining;
}

std::string remaining_text(const RemainingError& remaining) {
  const std::string text =
      fmt::format("Without noise the calibrations of {1} are still {0} off (RMS)",
                  millimetres(remaining.position),
                  counted(static_cast<std::size_t>(remaining.robots), "drawn robot"));
  std::vector<std::string> causes;
  if (!remaining.priors.empty()) {
    causes.push_back(fmt::format("the prior{} {} {}", remaining.priors.size() == 1 ? "" : "s",
                                 listed(remaining.priors),
                                 remaining.priors.size() == 1 ? "pulls" : "pull"));
  }
  if (!remaining.held.empty()) {
    causes.push_back("the simulated target is not where the configuration holds " +
                     listed(remaining.held));
  }
  if (causes.empty()) {
    return text + "; what the configuration frees cannot describe these robots or this target\n";
  }
  return text + ": " + causes.front() + (causes.size() > 1 ? "; " + causes.back() : "") + "\n";
}

}  // namespace kinecal::cli
