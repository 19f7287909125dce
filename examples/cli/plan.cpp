// kinecal plan: how many poses an accuracy takes, before anybody drives to the robot.
// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "commands.hpp"
#include "kinecal/io/capture/session_follower.hpp"
#include "kinecal/io/printable.hpp"
#include "kinecal/report/text.hpp"
#include "kinecal/trust/observability.hpp"
#include "output_file.hpp"
#include "plan_page.hpp"
#include "pose_choice.hpp"
#include "pose_file.hpp"
#include "words.hpp"

namespace kinecal::cli {
namespace {

std::string millimetres(double metres) {
  return std::isfinite(metres) ? fmt::format("{:.3f} mm", 1e3 * metres) : "not determined";
}

/// The accuracy that is asked for, metres.
/// @throws InputError  if it is not one of a position of what the calibration compares
double wanted_position(const std::string& text, const StudyInput& input) {
  const Accuracy accuracy = parse_accuracy(text);
  if (!accuracy.frame.empty() && accuracy.frame != input.setup.frame.name()) {
    throw InputError("--accuracy: '" + accuracy.frame + "' is not what is calibrated: '" +
                     input.setup.frame.name() + "' in '" + input.setup.in.name() +
                     "'; write \"gripper 0.5 mm\"");
  }
  if (!accuracy.position) {
    throw InputError("--accuracy: an angle is given; give a length, such as \"gripper 0.5 mm\"");
  }
  return *accuracy.position;
}

/// Expected position with the first 0, 1, 2, ... chosen poses.
std::vector<double> positions_of(const PoseChoice& choice, const std::vector<int>& chosen) {
  std::vector<double> positions;
  for (std::size_t count = 0; count <= chosen.size(); ++count) {
    const auto end = chosen.begin() + static_cast<std::ptrdiff_t>(count);
    positions.push_back(count + choice.have.size() == 0
                            ? std::numeric_limits<double>::infinity()
                            : expected_position(choice, {chosen.begin(), end}));
  }
  return positions;
}

/// The number of poses after which five more improve by less than a twentieth.
std::size_t knee_of(const std::vector<double>& positions) {
  constexpr std::size_t kMore = 5;
  constexpr double kLittle = 0.05;
  for (std::size_t i = 0; i + kMore < positions.size(); ++i) {
    if (std::isfinite(positions[i]) && positions[i + kMore] > (1.0 - kLittle) * positions[i]) {
      return i;
    }
  }
  return positions.size() - 1;
}

/// Accuracy by number of poses, selected and random; what is enough is not known yet.
PoseCurve curve_of(const PoseChoice& choice, const std::vector<double>& positions, double wanted) {
  PoseCurve curve;
  for (std::size_t i = choice.have.empty() ? 1 : 0; i < positions.size(); ++i) {
    curve.selected.push_back({static_cast<int>(i), positions[i]});
  }
  for (const int count : {3, 5, 8, 10, 15, 20, 25, 30, 40, 50, 75, 100}) {
    if (static_cast<std::size_t>(count) >= positions.size()) break;
    curve.random.push_back({count, random_position(choice, count)});
  }
  curve.wanted = wanted;
  const std::size_t knee = knee_of(positions);
  if (std::isfinite(positions[knee])) curve.knee = static_cast<int>(knee);
  curve.have = static_cast<int>(choice.have.size());
  return curve;
}

std::string curve_text(const PoseCurve& curve, const std::vector<double>& positions) {
  TextTable table({"poses", "selected, mm", "random, mm"}, 0);
  const auto shown = [](double metres) {
    return std::isfinite(metres) ? fmt::format("{:.3f}", 1e3 * metres) : std::string("-");
  };
  for (const PoseAccuracy& random : curve.random) {
    table.add({std::to_string(random.poses),
               shown(positions[static_cast<std::size_t>(random.poses)]), shown(random.position)});
  }
  return table.str() + fmt::format("Knee: after {} five more improve it by less than 5 %\n",
                                   counted(knee_of(positions), "pose"));
}

/// Combinations of parameters that no pose determines.
std::string lost_text(const StudyInput& input, const PoseChoice& choice) {
  const std::unique_ptr<AnyProblem> problem = input.setup.make();
  for (const Sample& sample : choice.samples) problem->add_sample(sample);
  const FreeSet free(input.setup.free, problem->table().size());
  const Observability known = observability(*problem, free, input.setup.drawn);
  if (known.unobservable.empty()) return "All parameters can be had from these poses\n";
  return "Parameters that no number of these poses determines\n" +
         observability_text(input.config.steps.back().name, known, input.calibration.table);
}

/// "14 poses", "3 more poses".
std::string poses_text(const PoseChoice& choice, std::size_t count) {
  return counted(count, choice.have.empty() ? "pose" : "more pose");
}

/// What is said of a plan that does not reach its accuracy with all poses.
void not_reached(const PoseChoice& choice, const std::vector<double>& positions, double wanted,
                 PlanFindings& findings) {
  const double least = positions.back(), more = least / wanted;
  findings.title = millimetres(wanted) + " cannot be reached with poses like these";
  findings.about += fmt::format("{} give {}; {}", poses_text(choice, positions.size() - 1),
                                millimetres(least), findings.title);
  findings.about +=
      std::isfinite(more)
          ? fmt::format(": that takes {:.0f} times as many samples, or less noise\n", more * more)
          : "\n";
}

/// What is said of one that does.
/// @param count  of the first poses of a large set that reach it
/// @returns      the poses, in an order of short ways
std::vector<int> reached(const PoseChoice& choice, int count, double wanted,
                         PlanFindings& findings) {
  findings.reached = true;
  std::vector<int> chosen;
  // A set of its own size can be better than the first few of a larger one.
  for (int fewer = count; fewer > 0; --fewer) {
    const PoseSelection set = kinecal::select_poses(choice.candidates, {.count = fewer});
    if (fewer < count && expected_position(choice, set.chosen) > wanted) break;
    chosen = set.chosen;
  }
  if (count == 0) {
    findings.curve.enough = findings.curve.selected.front();
    findings.title = "no more poses are needed";
    findings.about += "which is enough: no more poses are needed\n";
    return {};
  }
  std::vector<int> order = short_order(choice, chosen);
  const double position = expected_position(choice, chosen);
  findings.curve.enough = {static_cast<int>(chosen.size()), position};
  findings.title = poses_text(choice, chosen.size()) + " give " + millimetres(position);
  findings.about += fmt::format("{}: {} with the URDF's speeds and 3 s a stop\n", findings.title,
                                duration_text(session_seconds(choice, order)));
  return order;
}

/// Checks what is to be written.
void check_outputs(const PlanOptions& options) {
  std::vector<std::string> inputs = {options.urdf, options.config, options.pose_file, options.scene,
                                     options.have};
  inputs.insert(inputs.end(), options.samples.begin(), options.samples.end());
  if (!options.output.empty()) check_output(options.output, inputs, options.force);
  inputs.push_back(options.output);
  if (!options.report.empty()) check_page(options.report, inputs, options.force);
}

}  // namespace

int plan(const PlanOptions& options) {
  check_outputs(options);
  (void)parse_accuracy(options.accuracy);
  const std::unique_ptr<StudyInput> input = read_study(options, options.candidates);
  const double wanted = wanted_position(options.accuracy, *input);
  const PoseChoice choice = pose_choice(*input);
  constexpr int kMost = 100;
  const PoseSelection all = kinecal::select_poses(choice.candidates, {.count = kMost});
  const std::vector<double> positions = positions_of(choice, all.chosen);
  const auto enough =
      std::find_if(positions.begin(), positions.end(), [&](double p) { return p <= wanted; });
  PlanFindings findings;
  findings.curve = curve_of(choice, positions, wanted);
  findings.lost = lost_text(*input, choice);
  findings.about = fmt::format("'{}' in '{}', one standard deviation\n", input->setup.frame.name(),
                               input->setup.in.name());
  if (!choice.have.empty()) {
    findings.about += fmt::format("with your {}: {}\n", counted(choice.have.size(), "pose"),
                                  millimetres(positions.front()));
  }
  std::vector<int> chosen;
  if (enough == positions.end()) {
    not_reached(choice, positions, wanted, findings);
  } else {
    chosen = reached(choice, static_cast<int>(enough - positions.begin()), wanted, findings);
  }
  fmt::print("{}", printable(findings.about + "\n" + curve_text(findings.curve, positions) + "\n" +
                             findings.lost));
  if (!options.output.empty() && !chosen.empty()) {
    write_pose_file(options.output, poses_of_choice(*input, chosen));
    fmt::print("{}\n", options.output);
  }
  if (!options.report.empty()) {
    write_file(options.report, plan_page(*input, findings));
    fmt::print("{}\n", options.report);
  }
  return findings.reached ? kDone : kNotUsable;
}

}  // namespace kinecal::cli
