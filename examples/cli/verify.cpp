// kinecal verify: does a result still hold, and what has moved?
// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>

#include "commands.hpp"
#include "input.hpp"
#include "kinecal/files/json/json_text.hpp"
#include "kinecal/files/results/file_set.hpp"
#include "kinecal/procedure/calibrate_robot.hpp"
#include "kinecal/procedure/surface_rounds.hpp"
#include "kinecal/text/counted.hpp"
#include "kinecal/trust/verify/pose_change.hpp"
#include "kinecal/trust/verify/solution_change.hpp"
#include "moved_text.hpp"
#include "new_samples.hpp"
#include "output_file.hpp"
#include "terminal.hpp"

namespace kinecal::cli {
namespace {

/// What is written about a check.
struct Check {
  const StoredResult& result;
  const NewSamples& fresh;
  Drift drift;
  double level;

  [[nodiscard]] const ParameterTable& table() const { return fresh.problem().table(); }
};

std::string name_of(const Check& check, const Mover& mover) {
  return mover_name(check.result, mover.owner, mover.is_frame);
}

/// "0.57 deg +- 0.01 deg"
std::string change_text(const Check& check, const Mover& mover) {
  return change_text(named_change(mover, check.table()));
}

/// By how much the pose in question is off if this has moved; poses of 0: it is not known.
PoseChange change_of_pose(const Check& check, const Mover& mover) {
  if (!check.result.pose) return {};
  std::vector<double> moved = check.fresh.values;
  for (std::size_t i = 0; i < mover.parameters.size(); ++i) {
    moved[static_cast<std::size_t>(mover.parameters[i])] += mover.change[i];
  }
  const AnyProblem& problem = check.fresh.problem();
  return pose_change({problem, check.fresh.values}, {problem, moved}, check.fresh.samples,
                     check.result.pose->frame, check.result.pose->in);
}

std::string pose_text(const Check& check, const Mover& mover) {
  const PoseChange change = change_of_pose(check, mover);
  if (change.poses == 0) return "";
  const std::string rotation =
      change.rotation > 0.0 ? " and " + reading(change.rotation, "rad") : "";
  return fmt::format("So '{}' in '{}' is off by {}{}, {} at the worst of these poses\n",
                     check.result.pose->frame.name(), check.result.pose->in.name(),
                     reading(change.position, "m"), rotation, reading(change.worst_position, "m"));
}

std::string source_of(const Check& check, int sample) {
  return fmt::format("{} (sample {})", check.fresh.samples[static_cast<std::size_t>(sample)].source,
                     sample + 1);
}

std::string missed_text(const Check& check, const std::vector<MissedSample>& missed) {
  std::string text;
  for (const MissedSample& sample : missed) {
    text +=
        fmt::format("  - {} does not fit the others ({:.1f} times the noise): capture it again\n",
                    source_of(check, sample.sample), sample.times);
  }
  return text;
}

std::string confidence_text(double probability) {
  constexpr double kLeast = 1e-6;
  if (probability < kLeast) return "confidence above 99.9999 %";
  const int digits = 2 + static_cast<int>(std::ceil(-std::log10(probability)));
  return fmt::format("confidence {:.{}g} %", 100.0 * (1.0 - probability), digits);
}

/// Samples below which more are asked for.
constexpr std::size_t kEnough = 5;

/// True unless a joint would have to slip by more than 30 degrees, or anything by more than 10 cm.
bool is_shown(const SmallestChange& change) {
  return change.size < (change.unit == "rad" ? 0.5236 : 0.1);
}

/// "joints off by 0.012 deg ('lift') to 0.3 deg ('roll')": the smallest changes of joints that turn, of
/// those that slide, or of frames; empty if absent.
std::string visible_text(const Drift& drift, bool is_frame, const std::string& unit) {
  std::vector<SmallestChange> all = drift.visible;
  std::erase_if(all, [&](const SmallestChange& change) {
    return change.is_frame != is_frame || change.unit != unit || !is_shown(change);
  });
  if (all.empty()) return "";
  const auto named = [](const SmallestChange& change) {
    return fmt::format("{} ('{}')", reading(change.size, change.unit), change.owner);
  };
  std::string text = is_frame ? "frames shifted by " : "joints off by ";
  text += named(all.front());
  return all.size() > 1 ? text + " to " + named(all.back()) : text;
}

std::string visible_text(const Drift& drift) {
  std::string text, hidden;
  const auto add = [](std::string& to, const std::string& part) {
    if (!part.empty()) to += (to.empty() ? "" : ", ") + part;
  };
  for (const auto& [is_frame, unit] : {std::pair(false, "rad"), {false, "m"}, {true, "m"}}) {
    add(text, visible_text(drift, is_frame, unit));
  }
  for (const SmallestChange& change : drift.visible) {
    if (!is_shown(change)) add(hidden, "'" + change.owner + "'");
  }
  if (!text.empty()) text = "  - would have found, 9 times of 10: " + text + "\n";
  if (!hidden.empty()) text += "  - would not have found changes of " + hidden + "\n";
  return text;
}

std::string verdict_text(const Check& check) {
  const Drift& drift = check.drift;
  std::string text = drift.holds ? "verdict: holds\n" : "verdict: does not hold\n";
  const std::string size =
      fmt::format("residuals are {:.2f} times what noise and the uncertainty of the result make",
                  std::sqrt(drift.statistic / std::max(1.0, drift.freedom)));
  if (drift.holds) {
    text += fmt::format("  - {} of {} fit: {} (p = {:.2f})\n",
                        check.fresh.samples.size() - drift.missed.size(),
                        counted(check.fresh.samples.size(), "sample"), size, drift.probability);
    text += visible_text(drift);
  } else {
    text += fmt::format("  - {}: {}\n", confidence_text(drift.probability), size);
  }
  if (!check.result.knows_common) {
    text += "  - " + check.result.report +
            " does not say what noise the features of a pose share (common_noise), as an older "
            "version wrote it: less noise is expected, and a change may be reported where nothing "
            "moved; calibrate again\n";
  }
  text += missed_text(check, drift.missed);
  if (check.fresh.samples.size() < kEnough) {
    text += fmt::format("  - only {}; {} or more in different poses show more\n",
                        counted(check.fresh.samples.size(), "sample"), kEnough);
  }
  return text;
}

/// What to record if a change that matters would not have been found; empty otherwise.
std::string record_text(const Check& check) {
  constexpr double kRadians = 0.01745, kMetres = 5e-3, kManyPoses = 200.0;
  const SmallestChange* worst = nullptr;
  double most = 1.0;
  for (const SmallestChange& change : check.drift.visible) {
    const double times = change.size / (change.unit == "rad" ? kRadians : kMetres);
    if (!is_shown(change) || times <= most) continue;
    most = times;
    worst = &change;
  }
  const std::size_t samples = check.fresh.samples.size();
  if (worst == nullptr) {
    return samples < kEnough ? fmt::format("Next: verify {} or more new poses\n", kEnough) : "";
  }
  const double poses = std::ceil(static_cast<double>(samples) * most * most);
  const std::string what =
      fmt::format("{} of {} '{}'", reading(worst->unit == "rad" ? kRadians : kMetres, worst->unit),
                  worst->is_frame ? "frame" : "joint", worst->owner);
  if (poses > kManyPoses) {
    return fmt::format(
        "Next: measure a point that {} moves farther; poses like these hardly show it\n", what);
  }
  return fmt::format("Next: verify {:.0f} or more new poses; these would not show {}\n", poses,
                     what);
}

/// What has moved, the most likely first.
std::string movers_text(const Check& check) {
  const Drift& drift = check.drift;
  if (drift.movers.empty()) return "";
  const Mover& first = drift.movers.front();
  if (!first.explains) {
    const double rest = std::sqrt(first.statistic / std::max(1.0, first.freedom));
    constexpr double kMostly = 0.05;
    if (first.statistic < kMostly * drift.statistic) {
      return fmt::format(
          "Most of it is {}: {}\n"
          "  but not it alone: residuals stay {:.2f} times too large, so something else has "
          "changed, or "
          "the result is less exact at these poses\n",
          name_of(check, first), change_text(check, first), rest);
    }
    return fmt::format(
        "No single joint, frame or sensor explains it: several have moved, or something that is no "
        "parameter (a bent link, another load, many bad captures)\n"
        "  nearest: {}, {}; residuals stay {:.2f} times too large\n",
        name_of(check, first), change_text(check, first), rest);
  }
  std::string text = "Most likely moved\n";
  constexpr int kListed = 4;
  for (int i = 0; i < std::min(drift.alike, kListed); ++i) {
    const Mover& mover = drift.movers[static_cast<std::size_t>(i)];
    text += fmt::format("  {}{}: {}\n", i == 0 ? "" : "or ", name_of(check, mover),
                        change_text(check, mover));
    for (const std::string& same : mover.same) {
      text += fmt::format("     or '{}', which moves all that these samples show in the same way\n",
                          same);
    }
  }
  if (drift.alike > kListed) text += fmt::format("  or {} others\n", drift.alike - kListed);
  if (drift.alike > 1) {
    text += "  these samples cannot tell them apart; record poses in which they move differently\n";
  }
  return text + missed_text(check, first.missed) + pose_text(check, first);
}

std::string next_text(const Check& check) {
  const Drift& drift = check.drift;
  if (drift.holds) {
    const std::string record = record_text(check);
    return record.empty() ? "Next: nothing to do\n" : record;
  }
  if (drift.movers.empty() || !drift.movers.front().explains) return "Next: calibrate again\n";
  return fmt::format("Next: see whether {} is loose, then calibrate again\n",
                     name_of(check, drift.movers.front()));
}

detail::Json json(const Check& check, const Mover& mover, bool alike) {
  using detail::Json;
  Json parameters = Json::array();
  for (std::size_t i = 0; i < mover.parameters.size(); ++i) {
    parameters.push_back({{"name", check.table()[mover.parameters[i]].name},
                          {"change", mover.change[i]},
                          {"sigma", mover.deviation[i]}});
  }
  const PoseChange pose = change_of_pose(check, mover);
  return {{"owner", mover.owner},
          {"is_frame", mover.is_frame},
          {"same", mover.same},
          {"explains", mover.explains},
          {"alike", alike},
          {"statistic", mover.statistic},
          {"freedom", mover.freedom},
          {"pose_position", pose.poses > 0 ? Json(pose.position) : Json()},
          {"pose_rotation", pose.poses > 0 ? Json(pose.rotation) : Json()},
          {"parameters", parameters}};
}

std::string json(const Check& check) {
  using detail::Json;
  const Drift& drift = check.drift;
  Json movers = Json::array(), missed = Json::array(), visible = Json::array();
  for (const Mover& mover : drift.movers) {
    movers.push_back(json(check, mover, std::ssize(movers) < drift.alike));
  }
  for (const MissedSample& sample : drift.missed) {
    missed.push_back(
        {{"sample", sample.sample + 1},
         {"source", check.fresh.samples[static_cast<std::size_t>(sample.sample)].source},
         {"times", sample.times}});
  }
  for (const SmallestChange& change : drift.visible) {
    visible.push_back({{"owner", change.owner},
                       {"is_frame", change.is_frame},
                       {"unit", change.unit},
                       {"size", std::isfinite(change.size) ? Json(change.size) : Json()}});
  }
  return detail::json_lines({{"result", check.result.folder},
                             {"holds", drift.holds},
                             {"probability", drift.probability},
                             {"level", check.level},
                             {"statistic", drift.statistic},
                             {"freedom", drift.freedom},
                             {"samples", check.fresh.samples.size()},
                             {"assumed", check.fresh.assumed},
                             {"bad_samples", missed},
                             {"moved", movers},
                             {"visible", visible},
                             {"error_blocks", fit_json(check.result, check.fresh)}});
}

// Results of the robot's own surface.  Nearest points are others at other values, so residuals do not say what has moved:
// new samples are calibrated alone, and the two solutions compared.

/// The calibration of the new samples.
struct SecondSolution {
  const StoredResult& result;
  CalibratedRobot calibrated;
  SolutionChange change;
  double level;

  [[nodiscard]] bool holds() const { return change.probability >= level; }
  [[nodiscard]] const AnyProblem& problem() const {
    return *calibrated.setup.calibration.steps.back().problem;
  }
};

/// nullopt: wrong input, which is printed.
std::optional<CalibratedRobot> calibrated_alone(const StoredResult& result,
                                                const RecheckOptions& options) {
  Diagnostics found;
  const NewSampleOptions of_new{options.samples, options.cameras, options.recorded};
  CalibrationSetup setup{.robot = result.robot,
                         .config = result.config,
                         .samples = read_new_recordings(of_new, found),
                         .urdf_text = result.urdf_text,
                         .urdf = urdf_beside_meshes(result)};
  if (found.errors.empty()) {
    const std::string assumed = take_off_if_after(result, of_new, setup.samples);
    if (!assumed.empty()) found.notes.push_back(assumed);
  }
  CalibrationOptions calibrating;
  calibrating.mesh_paths = options.mesh_paths;
  calibrating.search = Search::never;
  PreparedCalibration prepared = prepare(std::move(setup), calibrating, std::move(found));
  print(prepared.diagnostics);
  if (!prepared.diagnostics.errors.empty()) return std::nullopt;
  return calibrate_robot(std::move(prepared), calibrating);
}

/// The change of a joint, frame or sensor, as of a mover.
std::string line_of(const SecondSolution& second, const OwnerChange& owner) {
  const AnyProblem& problem = second.problem();
  const bool is_frame = problem.frames().contains(owner.owner);
  std::string text;
  for (const char* unit : {"m", "rad", ""}) {
    std::vector<std::pair<double, double>> changes;
    for (std::size_t i = 0; i < owner.parameters.size(); ++i) {
      const Parameter& parameter = problem.table()[owner.parameters[i]];
      if (is_frame && parameter.unit == unit) {
        changes.emplace_back(owner.change[i], owner.deviation[i]);
      } else if (!is_frame && *unit == '\0') {
        text += fmt::format("{}{} {} +- {}", text.empty() ? "" : ", ", parameter.name,
                            reading(owner.change[i], parameter.unit),
                            reading(owner.deviation[i], parameter.unit));
      }
    }
    if (!changes.empty()) text += (text.empty() ? "" : ", ") + length_text(changes, unit);
  }
  return fmt::format("  - '{}' by {} (p = {:.2g})\n", owner.owner, text, owner.probability);
}

std::string text_of(const SecondSolution& second) {
  const SolutionChange& change = second.change;
  std::string text = fmt::format(
      "verdict: {}\n  - {} calibrated alone differ from the result by {:.2f} times what "
      "the +- of both make (p = {:.2g})\n",
      second.holds() ? "holds" : "does not hold",
      counted(second.calibrated.samples.size(), "new sample"),
      std::sqrt(change.statistic / change.freedom), change.probability);
  if (second.calibrated.samples.size() < kEnough) {
    text += fmt::format("  - only {}; {} or more in different poses show more\n",
                        counted(second.calibrated.samples.size(), "sample"), kEnough);
  }
  text += "\nChanges of what was calibrated, the least likely first\n";
  for (const OwnerChange& owner : change.owners) text += line_of(second, owner);
  if (second.result.pose) {
    const std::vector<double> then = second.result.values_of(second.problem().table());
    const Eigen::VectorXd now = second.calibrated.result.table.values();
    const PoseChange pose =
        pose_change({second.problem(), then}, {second.problem(), now}, second.calibrated.samples,
                    second.result.pose->frame, second.result.pose->in);
    if (pose.poses > 0) {
      text += fmt::format("\n'{}' in '{}' is {} and {} from the result\n",
                          second.result.pose->frame.name(), second.result.pose->in.name(),
                          reading(pose.position, "m"), reading(pose.rotation, "rad"));
    }
  }
  return text + (second.holds() ? "\nNext: nothing to do\n"
                                : fmt::format("\nNext: see whether '{}' is loose, then calibrate "
                                              "again\n",
                                              change.owners.front().owner));
}

std::string json(const SecondSolution& second) {
  using detail::Json;
  Json moved = Json::array();
  for (const OwnerChange& owner : second.change.owners) {
    Json parameters = Json::array();
    for (std::size_t i = 0; i < owner.parameters.size(); ++i) {
      parameters.push_back({{"name", second.problem().table()[owner.parameters[i]].name},
                            {"change", owner.change[i]},
                            {"sigma", owner.deviation[i]}});
    }
    moved.push_back({{"owner", owner.owner},
                     {"statistic", owner.statistic},
                     {"probability", owner.probability},
                     {"parameters", parameters}});
  }
  return detail::json_lines({{"result", second.result.folder},
                             {"holds", second.holds()},
                             {"probability", second.change.probability},
                             {"level", second.level},
                             {"statistic", second.change.statistic},
                             {"freedom", second.change.freedom},
                             {"samples", second.calibrated.samples.size()},
                             {"moved", moved}});
}

int verify_on_surface(const StoredResult& result, const RecheckOptions& options) {
  std::optional<CalibratedRobot> solved = calibrated_alone(result, options);
  if (!solved) return kBadInput;
  SecondSolution second{result, *std::move(solved), {}, options.level};
  const CalibratedRobot& alone = second.calibrated;
  if (!alone.is_usable() || alone.assessments.empty()) {
    say("verdict: not known\n  - the new samples alone: {}\nNext: verify with other poses, or "
        "more\n",
        alone.judgement.reasons.empty() ? "do not use" : alone.judgement.reasons.front());
    return kNotUsable;
  }
  const ParameterTable& table = second.problem().table();
  const Eigen::VectorXd values = alone.result.table.values();
  second.change = solution_change(
      second.problem(), result.state(table), calibrated_state(alone.assessments.back(), values),
      static_cast<double>(result.pose_samples().size() + alone.samples.size()) - 2.0);
  if (second.change.freedom == 0) {
    throw InputError(result.folder +
                     ": nothing that was calibrated is determined by both the "
                     "result and the new samples");
  }
  show(text_of(second), options.manner);
  if (!options.report.empty()) write_output(options.report, json(second));
  return second.holds() ? kDone : kNotUsable;
}

}  // namespace

int verify(const RecheckOptions& options) {
  const StoredResult result = read_result(options.result);
  if (!options.report.empty()) check_json(options.report, options.samples);
  if (compares_surface(result.config)) return verify_on_surface(result, options);
  const NewSamples fresh =
      read_new_samples(result, {options.samples, options.cameras, options.recorded, options.level});
  print(fresh.diagnostics);
  if (!fresh.diagnostics.errors.empty()) return kBadInput;
  if (!std::isfinite(fresh.misfit)) {
    say("verdict: does not hold\n  - {}\n", kBehindCamera);
    return kNotUsable;
  }
  const Check check{result, fresh, drift_of(result, fresh, {options.level}), options.level};
  std::string text = verdict_text(check);
  if (result.verdict != "good") {
    text += fmt::format("  - the result itself was judged '{}'\n", result.verdict);
  }
  if (!fresh.assumed.empty()) text += "  - " + fresh.assumed + "\n";
  text += "\n";
  if (const std::string moved = movers_text(check); !moved.empty()) text += moved + "\n";
  text += fit_text(result, fresh) + "\n" + worst_text(result, fresh) + "\n" + next_text(check);
  show(text, options.manner);
  if (!options.report.empty()) write_output(options.report, json(check));
  return check.drift.holds ? kDone : kNotUsable;
}

}  // namespace kinecal::cli
