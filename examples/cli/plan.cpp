// kinecal plan: how many poses an accuracy takes, before anybody drives to the robot.
// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <optional>
#include <set>
#include <utility>

#include "commands.hpp"
#include "explanations.hpp"
#include "kinecal/files/results/file_set.hpp"
#include "kinecal/procedure/session_follower.hpp"
#include "kinecal/report/text.hpp"
#include "kinecal/text/counted.hpp"
#include "kinecal/text/frame_name.hpp"
#include "kinecal/trust/uncertainty/observability.hpp"
#include "output_file.hpp"
#include "plan_page.hpp"
#include "pose_choice.hpp"
#include "pose_file.hpp"
#include "progress.hpp"
#include "remaining_error.hpp"
#include "terminal.hpp"

namespace kinecal::cli {
namespace {

/// @throws InputError  in words of a plan
Accuracy accuracy_of_plan(const std::string& text) {
  try {
    return parse_accuracy(text);
  } catch (const InputError&) {
    throw InputError("--accuracy: '" + text +
                     "' is not the accuracy of a position; write a name, a number and mm, cm or m, "
                     "such as 'gripper 0.5 mm'");
  }
}

/// The accuracy that is asked for, metres.
/// @throws InputError  if it is not one of a position of what the calibration compares
double wanted_position(const std::string& text, const StudyInput& input) {
  const Accuracy accuracy = accuracy_of_plan(text);
  if (!accuracy.frame.empty() && !same_frame(accuracy.frame, input.setup.frame.name())) {
    const std::string& calibrated = input.setup.frame.name();
    std::string right = text;
    right.replace(right.find(accuracy.frame), accuracy.frame.size(), calibrated);
    throw InputError("--accuracy: '" + accuracy.frame + "' is not what is calibrated: '" +
                     calibrated + "' in '" + input.setup.in.name() + "'; write '" + right + "'");
  }
  if (!accuracy.position) {
    throw InputError("--accuracy: an angle is given; give a length, such as 'gripper 0.5 mm'");
  }
  return *accuracy.position;
}

/// Poses that are good together.
struct PoseSet {
  std::vector<int> chosen;
  double position = std::numeric_limits<double>::infinity();  ///< expected, metres

  [[nodiscard]] PoseAccuracy accuracy() const {
    return {static_cast<int>(chosen.size()), position};
  }
};

/// The best sets of poses that were found, by their number: the first few of a large set, or a set
/// of its own, which can be better but takes a search.
class PoseSets {
 public:
  PoseSets(const PoseChoice& choice, double wanted, ProgressMeter meter)
      : choice_(choice), meter_(std::move(meter)) {
    std::vector<int> every(static_cast<std::size_t>(candidates()));
    std::iota(every.begin(), every.end(), 0);
    of_all_ = expected_position(choice, every);
    for (int count = std::min(kFirst, candidates());; count = next(count)) {
      search(count);
      differ_ = most() < count;
      if (least_of(wanted) || differ_ || count == candidates() || of_all_ > wanted ||
          !is_quick(next(count), kWork))
        break;
    }
  }

  [[nodiscard]] int candidates() const {
    return static_cast<int>(choice_.candidates.information.size());
  }
  [[nodiscard]] int most() const { return static_cast<int>(largest_.size()); }
  [[nodiscard]] double of_all() const { return of_all_; }  ///< expected with all candidates, metres
  /// Whether the other candidates are like those of the largest set.
  [[nodiscard]] bool differ() const { return differ_; }

  /// The best set of a number of poses.
  [[nodiscard]] const PoseSet& at(int count) {
    const auto [known, is_new] = sets_.try_emplace(count);
    PoseSet& set = known->second;
    if (!is_new) return set;
    set = {{largest_.begin(), largest_.begin() + count}, firsts_[static_cast<std::size_t>(count)]};
    constexpr double kLittleWork = 2e4;
    if (count == 0 || count == most() || !is_quick(count, kLittleWork)) return set;
    std::vector<int> own = selected(count);
    const double position = expected_position(choice_, own);
    if (static_cast<int>(own.size()) == count && position < set.position) set = {own, position};
    return set;
  }

  /// The smallest set that gives what is asked for; none: not reached.
  [[nodiscard]] std::optional<PoseSet> enough(double wanted) {
    const std::optional<int> least = least_of(wanted);
    if (!least) return std::nullopt;
    int count = *least;
    while (count > 0 && at(count - 1).position <= wanted) --count;
    return at(count);
  }

 private:
  static constexpr int kFirst = 100;
  static constexpr double kWork = 1e5;  ///< of a search, poses times candidates: some seconds

  [[nodiscard]] bool is_quick(int count, double work) const {
    return static_cast<double>(count) * candidates() <= work;
  }
  [[nodiscard]] int next(int count) const { return std::min(count + count / 2, candidates()); }

  /// Poses of the large set that suffice.
  [[nodiscard]] std::optional<int> least_of(double wanted) const {
    const auto enough = std::find_if(firsts_.begin(), firsts_.end(),
                                     [&](double position) { return position <= wanted; });
    if (enough == firsts_.end()) return std::nullopt;
    return static_cast<int>(enough - firsts_.begin());
  }

  [[nodiscard]] std::vector<int> selected(int count) const {
    return kinecal::select_poses(choice_.candidates, {.count = count, .meter = meter_}).chosen;
  }

  void search(int count) {
    largest_ = selected(count);
    firsts_.clear();
    for (auto end = largest_.begin();; ++end) {
      firsts_.push_back(end == largest_.begin() && choice_.have.empty()
                            ? std::numeric_limits<double>::infinity()
                            : expected_position(choice_, {largest_.begin(), end}));
      if (end == largest_.end()) return;
    }
  }

  const PoseChoice& choice_;
  ProgressMeter meter_;
  double of_all_ = 0.0;
  bool differ_ = false;
  std::vector<int> largest_;    ///< the most useful first
  std::vector<double> firsts_;  ///< positions with its first 0, 1, 2, ...
  std::map<int, PoseSet> sets_;
};

/// What a number of poses gives, between those of a curve: a power of it.
double position_at(const PoseCurve& curve, int poses) {
  const auto after = std::find_if(curve.selected.begin(), curve.selected.end(),
                                  [&](const PoseAccuracy& point) { return point.poses >= poses; });
  if (after->poses == poses || after == curve.selected.begin()) return after->position;
  const PoseAccuracy& before = *(after - 1);
  if (!std::isfinite(before.position)) return before.position;
  const auto all = [&](int more) { return std::log(std::max(1, curve.have + more)); };
  const double share = (all(poses) - all(before.poses)) / (all(after->poses) - all(before.poses));
  return before.position * std::pow(after->position / before.position, share);
}

/// The number of poses after which five more improve by less than a twentieth; none within the curve.
std::optional<int> knee_of(const PoseCurve& curve) {
  constexpr int kMore = 5;
  constexpr double kLittle = 0.05;
  for (int i = curve.selected.front().poses; i + kMore <= curve.selected.back().poses; ++i) {
    const double position = position_at(curve, i);
    if (std::isfinite(position) && position_at(curve, i + kMore) > (1.0 - kLittle) * position) {
      return i;
    }
  }
  return std::nullopt;
}

/// Accuracy by number of poses, selected and random.
/// @param enough  a number of poses that must be there
PoseCurve curve_of(const PoseChoice& choice, PoseSets& sets, double wanted,
                   std::optional<int> enough, const ProgressMeter& meter) {
  PoseCurve curve;
  curve.wanted = wanted;
  curve.have = static_cast<int>(choice.have.size());
  std::set<int> counts = {1, 2, 4, 6, 12, sets.most()}, compared = {sets.most()};
  if (!choice.have.empty()) counts.insert(0);
  if (enough && *enough > 0) compared.insert(*enough);
  for (const int count : {3, 5, 8, 10, 15, 20, 25, 30, 40, 50, 75, 100, 150, 200, 300, 500, 1000}) {
    compared.insert(count);
  }
  counts.insert(compared.begin(), compared.end());
  for (const int count : counts) {
    if (count > sets.most()) break;
    curve.selected.push_back({count, sets.at(count).position});
    if (!compared.contains(count)) continue;
    curve.random.push_back({count, random_position(choice, count, meter)});
  }
  curve.knee = knee_of(curve);
  if (!curve.knee || counts.contains(*curve.knee)) return curve;
  const auto after =
      std::find_if(curve.selected.begin(), curve.selected.end(),
                   [&](const PoseAccuracy& point) { return point.poses > *curve.knee; });
  curve.selected.insert(after, {*curve.knee, position_at(curve, *curve.knee)});
  return curve;
}

std::string curve_text(const PoseCurve& curve) {
  TextTable table({curve.have > 0 ? "more poses" : "poses", "selected, mm", "random, mm"}, 0);
  const auto shown = [](double metres) {
    return std::isfinite(metres) ? fmt::format("{:.3f}", 1e3 * metres) : std::string("-");
  };
  for (const PoseAccuracy& random : curve.random) {
    table.add({std::to_string(random.poses), shown(position_at(curve, random.poses)),
               shown(random.position)});
  }
  const auto poses = [](int count) { return counted(static_cast<std::size_t>(count), "pose"); };
  return table.str() +
         (curve.knee ? fmt::format("Knee: after {} five more improve it by less than 5 %\n",
                                   poses(*curve.knee))
                     : fmt::format("No knee within {}: five more still improve it by 5 % or more\n",
                                   poses(curve.selected.back().poses)));
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
std::string poses_text(const PoseChoice& choice, int count) {
  return counted(static_cast<std::size_t>(count), choice.have.empty() ? "pose" : "more pose");
}

/// What is said of a plan that does not reach its accuracy.
void not_reached(const PoseChoice& choice, const PoseSets& sets, const PoseSet& best, double wanted,
                 PlanFindings& findings) {
  const bool by_all = sets.of_all() <= wanted;
  findings.title =
      millimetres(wanted) + (by_all ? " is not reached with " + poses_text(choice, sets.most())
                                    : std::string(" cannot be reached with poses like these"));
  findings.about +=
      fmt::format("{} give {}", poses_text(choice, sets.most()), millimetres(best.position));
  if (sets.most() < sets.candidates()) {
    findings.about +=
        fmt::format("; all {} give {}", sets.candidates(), millimetres(sets.of_all()));
    if (by_all) {
      findings.about += sets.differ() ? ", but the others are like these"
                                      : ", but plan looks at no larger sets of so many";
    }
  }
  findings.about += "; " + findings.title;
  const double more = best.position / wanted;
  findings.about +=
      std::isfinite(more) && !by_all
          ? fmt::format(": that takes {:.0f} times as many samples, or less noise\n", more * more)
          : "\n";
}

/// What is said of one that does.
void reached(const PoseChoice& choice, const PoseSet& set, PlanFindings& findings) {
  findings.reached = true;
  findings.curve.enough = set.accuracy();
  if (set.chosen.empty()) {
    findings.title = "no more poses are needed";
    findings.about += "which is enough: no more poses are needed\n";
    return;
  }
  findings.title =
      poses_text(choice, findings.curve.enough->poses) + " give " + millimetres(set.position);
  findings.about +=
      fmt::format("{}: {} with the URDF's speeds and 3 s a stop\n", findings.title,
                  duration_text(session_seconds(choice, short_order(choice, set.chosen))));
}

/// Says what calibrations leave without noise, if that spoils the accuracy.
void check_remaining(const StudyInput& input, const PoseChoice& choice, const PoseSet& set,
                     double wanted, PlanFindings& findings, const ProgressMeter& meter) {
  if (!std::isfinite(set.position) || input.is_of_surface || input.is_touched) return;
  const double tolerated = tolerated_error(set.position, std::max(wanted, set.position));
  const RemainingError remaining =
      remaining_error(input, with_existing(choice, set.chosen), tolerated, meter);
  if (!(remaining.position > tolerated)) return;
  findings.reached = false;
  findings.curve.enough.reset();
  findings.curve.remaining = remaining.position;
  findings.title += ", but " + millimetres(remaining.position) + " remain without noise";
  findings.about = remaining_text(remaining) + "What follows is the spread only: " + findings.about;
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

/// Writes what is asked for.
void write_outputs(const PlanOptions& options, const StudyInput& input, const PoseChoice& choice,
                   const PoseSet& set, const PlanFindings& findings) {
  if (!options.output.empty() && !set.chosen.empty()) {
    const std::vector<int> order = short_order(choice, set.chosen);
    write_pose_file(options.output, poses_of_choice(input, order));
    say("{}{}\n", options.output,
        findings.reached ? std::string()
                         : fmt::format(": the best {}, which do not reach {}",
                                       poses_text(choice, static_cast<int>(order.size())),
                                       millimetres(findings.curve.wanted)));
  } else if (!options.output.empty()) {
    say("{}: not written, no more poses are needed\n", options.output);
  }
  if (options.report.empty()) return;
  write_output(options.report, plan_page(input, findings));
  say("{}\n", options.report);
}

/// How many poses tell two explanations apart, and which.
int plan_between(const PlanOptions& options) {
  const std::unique_ptr<StudyInput> input = read_study(options, options.candidates);
  drop_poses_of_have(*input, SelectOptions{}.least_distance);
  PoseChoice choice = pose_choice(*input);
  choose_between(*input, choice);
  std::optional<ProgressLine> line(std::in_place);
  const DecidingPoses found = deciding_poses(*input, choice, line->meter());
  const std::vector<int> order = short_order(choice, found.chosen);
  const std::string details =
      order.empty() ? std::string() : explanations_text(*input, choice, found.chosen);
  line.reset();
  const std::string names =
      fmt::format("'{}' and '{}'", input->explanations[0].front(), input->explanations[1].front());
  if (order.empty()) {
    say("no more poses are needed: those you have tell {} apart (correlation {:.3f})\n", names,
        found.correlation);
  } else {
    say("{} {} {} apart: correlation {:.3f}, and from {} on they look alike\n{} with the URDF's "
        "speeds and 3 s a stop\n\n{}{}",
        poses_text(choice, static_cast<int>(order.size())), found.decide ? "tell" : "do not tell",
        names, found.correlation, kAlike, duration_text(session_seconds(choice, order)), details,
        found.curve);
  }
  if (!options.output.empty() && !order.empty()) {
    write_pose_file(options.output, poses_of_choice(*input, order));
    say("{}\n", options.output);
  } else if (!options.output.empty()) {
    say("{}: not written, no more poses are needed\n", options.output);
  }
  return found.decide ? kDone : kNotUsable;
}

}  // namespace

int plan(const PlanOptions& options) {
  check_outputs(options);
  if (!options.tell_apart.empty()) return plan_between(options);
  (void)accuracy_of_plan(options.accuracy);
  const std::unique_ptr<StudyInput> input = read_study(options, options.candidates);
  const double wanted = wanted_position(options.accuracy, *input);
  drop_poses_of_have(*input, SelectOptions{}.least_distance);
  const PoseChoice choice = pose_choice(*input);
  std::optional<ProgressLine> line(std::in_place);
  PoseSets sets(choice, wanted, line->meter());
  const std::optional<PoseSet> enough = sets.enough(wanted);
  const PoseSet set = enough ? *enough : sets.at(sets.most());
  PlanFindings findings;
  findings.curve =
      curve_of(choice, sets, wanted, enough ? std::optional(set.accuracy().poses) : std::nullopt,
               line->meter());
  findings.lost = lost_text(*input, choice);
  findings.about = fmt::format("'{}' in '{}', one standard deviation\n", input->setup.frame.name(),
                               input->setup.in.name());
  if (!choice.have.empty()) {
    findings.about += fmt::format("with your {}: {}\n", counted(choice.have.size(), "pose"),
                                  millimetres(sets.at(0).position));
  }
  if (enough) {
    reached(choice, set, findings);
  } else {
    not_reached(choice, sets, set, wanted, findings);
  }
  check_remaining(*input, choice, set, wanted, findings, line->meter());
  line.reset();
  if (input->is_of_surface) findings.about += surface_text(*input);
  say("{}", findings.about + "\n" + curve_text(findings.curve) + "\n" + findings.lost);
  write_outputs(options, *input, choice, set, findings);
  return findings.reached ? kDone : kNotUsable;
}

}  // namespace kinecal::cli
