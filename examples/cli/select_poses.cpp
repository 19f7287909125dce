// kinecal select-poses: few poses of many, so that a calibration with them is as good as possible.
// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include "commands.hpp"
#include "explanations.hpp"
#include "kinecal/study/study_summary.hpp"
#include "kinecal/text/counted.hpp"
#include "output_file.hpp"
#include "pose_choice.hpp"
#include "pose_file.hpp"
#include "progress.hpp"
#include "remaining_error.hpp"
#include "terminal.hpp"

namespace kinecal::cli {
namespace {

/// What simulated calibrations of a robot without errors give.
struct Simulated {
  double varied = 0.0;  ///< spread of the pose, metres
  double off = 0.0;     ///< its error, RMS, metres
};

/// Simulates calibrations with some samples.
Simulated simulated(const StudyInput& input, const PoseChoice& choice,
                    const std::vector<int>& chosen, int trials, const ProgressMeter& meter) {
  StudySetup setup = input.setup;
  setup.samples.clear();
  for (const int i : chosen) setup.samples.push_back(choice.samples[static_cast<std::size_t>(i)]);
  StudyRobot robot{0, setup.drawn, setup.samples};
  std::vector<StudyTrial> done;
  const int count = static_cast<int>(chosen.size());
  for (int repeat = 0; repeat < trials; ++repeat) {
    if (meter) meter(static_cast<double>(repeat) / trials, "simulating calibrations");
    done.push_back(run_study_job(setup, robot, {0, count, repeat}));
  }
  std::vector<StudyGroup> groups = summarize(setup, {&robot, 1}, done, 1.0);
  return {std::sqrt(varied_variance(groups.at(0), done, choice.candidates.goal)),
          groups.at(0).position};
}

std::string simulated_text(const Simulated& of) {
  return fmt::format("varies by {}, is {} off", millimetres(of.varied), millimetres(of.off));
}

PoseSelection select(const SelectPosesOptions& options, const PoseChoice& choice) {
  const std::map<std::string, PoseCriterion> criteria = {{"gripper", PoseCriterion::gripper},
                                                         {"a", PoseCriterion::a},
                                                         {"d", PoseCriterion::d},
                                                         {"e", PoseCriterion::e}};
  const auto candidates = static_cast<int>(choice.candidates.information.size());
  std::optional<ProgressLine> line(std::in_place);
  PoseSelection selection =
      kinecal::select_poses(choice.candidates, {.count = std::min(options.count, candidates),
                                                .criterion = criteria.at(options.criterion),
                                                .least_distance = options.least_distance,
                                                .failures = options.failures,
                                                .meter = line->meter()});
  line.reset();
  const std::size_t found = selection.chosen.size();
  if (static_cast<int>(found) < options.count) {
    say(stderr, "warning: only {} of {} are further than {} of a joint's range apart\n", found,
        counted(choice.candidates.information.size(), "pose"), options.least_distance);
  }
  return selection;
}

/// What the selected poses are worth.
std::string selected_text(const StudyInput& input, const PoseChoice& choice,
                          const std::vector<int>& chosen, const ProgressMeter& meter) {
  const double selected = expected_position(choice, chosen);
  const std::string what = fmt::format("{} of {} selected: '{}' in '{}'", chosen.size(),
                                       counted(choice.candidates.information.size(), "pose"),
                                       input.setup.frame.name(), input.setup.in.name());
  if (!std::isfinite(selected)) {
    return what + " is not determined: they determine less than all poses do; choose more\n";
  }
  if (input.is_of_surface) {
    return what + " will be known to " + millimetres(selected) + " (one standard deviation)\n" +
           surface_text(input);
  }
  const double tolerated = tolerated_error(selected, selected);
  const RemainingError remaining =
      remaining_error(input, with_existing(choice, chosen), tolerated, meter);
  if (!(remaining.position > tolerated)) {
    return what + " will be known to " + millimetres(selected) + " (one standard deviation)\n";
  }
  return what +
         fmt::format(" will vary by {} (one standard deviation), but {} remain without noise\n  {}",
                     millimetres(selected), millimetres(remaining.position),
                     remaining_text(remaining));
}

/// Random sets, and all poses.
std::string comparison_text(const SelectPosesOptions& options, const StudyInput& input,
                            const PoseChoice& choice, const std::vector<int>& chosen,
                            const ProgressMeter& meter) {
  const RandomSets random = random_sets(choice.candidates, static_cast<int>(chosen.size()),
                                        options.random, PoseCriterion::gripper, 1);
  std::vector<int> all(choice.candidates.information.size());
  for (std::size_t i = 0; i < all.size(); ++i) all[i] = static_cast<int>(i);
  const double selected = expected_position(choice, chosen);
  if (!std::isfinite(selected)) {
    return "  all poses: " + millimetres(expected_position(choice, all)) + "\n";
  }
  std::string text = fmt::format("  best of {} random sets: {}; all poses: {}\n", options.random,
                                 millimetres(expected_position(choice, random.best)),
                                 millimetres(expected_position(choice, all)));
  const int equal = random_poses_for(choice, selected, meter);
  text += equal > static_cast<int>(all.size())
              ? "  random sets are never as good\n"
              : fmt::format("  random sets need {} for as much (median)\n",
                            counted(static_cast<std::size_t>(equal), "pose"));
  // Of the new ones alone; a calibration of the robot's surface would have to associate.
  const bool is_simulated = !input.is_of_surface && !input.is_touched;
  if (options.trials < 2 || !choice.have.empty() || !is_simulated) return text;
  const auto of = [&](const std::vector<int>& set) {
    return simulated_text(simulated(input, choice, set, options.trials, meter));
  };
  return text + fmt::format("  simulated {} times: {}; best random set: {}\n", options.trials,
                            of(chosen), of(random.best));
}

void check_options(const SelectPosesOptions& options) {
  if (options.failures >= options.count) {
    throw InputError(
        fmt::format("--failures: {} of --count {} may fail, which leaves no pose; "
                    "give fewer failures or more poses",
                    options.failures, counted(static_cast<std::size_t>(options.count), "pose")));
  }
  if (options.output.empty()) return;
  std::vector<std::string> inputs = options.samples;
  inputs.insert(inputs.end(),
                {options.urdf, options.config, options.pose_file, options.scene, options.have});
  check_output(options.output, inputs, options.force);
}

}  // namespace

int select_poses(const SelectPosesOptions& options) {
  check_options(options);
  const std::unique_ptr<StudyInput> input = read_study(options, options.candidates);
  drop_poses_of_have(*input, options.least_distance);
  PoseChoice choice = pose_choice(*input);
  const bool tells_apart = !options.tell_apart.empty();
  if (tells_apart) choose_between(*input, choice);
  const PoseSelection selection = select(options, choice);
  const std::vector<int> order = short_order(choice, selection.chosen);
  std::optional<ProgressLine> line(std::in_place);
  const std::string text =
      tells_apart ? explanations_text(*input, choice, selection.chosen)
                  : selected_text(*input, choice, selection.chosen, line->meter()) +
                        comparison_text(options, *input, choice, selection.chosen, line->meter());
  line.reset();
  say("{}  in this order: {} with the URDF's speeds and 3 s a stop\n", text,
      duration_text(session_seconds(choice, order)));
  if (options.output.empty()) return kDone;
  write_pose_file(options.output, poses_of_choice(*input, order));
  say("{}\n", options.output);
  return kDone;
}

}  // namespace kinecal::cli
