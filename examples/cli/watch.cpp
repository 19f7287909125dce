// kinecal watch: many robots over months; which of them drift, and when they have to be calibrated again.
// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <map>
#include <new>
#include <nlohmann/json.hpp>
#include <system_error>
#include <thread>

#include "commands.hpp"
#include "interruption.hpp"
#include "kinecal/files/checksum.hpp"
#include "kinecal/files/json/json_text.hpp"
#include "kinecal/files/results/file_set.hpp"
#include "kinecal/procedure/surface_rounds.hpp"
#include "kinecal/text/characters.hpp"
#include "kinecal/tools/watch/fleet.hpp"
#include "kinecal/trust/verify/pose_change.hpp"
#include "moved_text.hpp"
#include "new_samples.hpp"
#include "output_file.hpp"
#include "report.hpp"
#include "terminal.hpp"
#include "watch_page.hpp"

namespace kinecal::cli {
namespace {

constexpr double kNano = 1e-9;

/// When the samples were recorded, seconds since 1970: by their first stamp, if it is a date; else when the file was
/// written.
double time_of(const std::vector<Sample>& samples, const WatchedRecording& file) {
  constexpr double kYear2000 = 946'684'800.0;
  const double written = kNano * static_cast<double>(file.modified);
  for (const Sample& sample : samples) {
    if (!sample.stamp) continue;
    const double stamp = kNano * static_cast<double>(sample.stamp->count());
    return stamp > kYear2000 && stamp < written + kDay ? stamp : written;
  }
  return written;
}

WatchedChange watched(const Mover& mover, const ParameterTable& table) {
  const NamedChange named = named_change(mover, table);
  return {named.owner,  named.is_frame,   named.parameters, named.units,
          named.change, mover.covariance, mover.score,      mover.explains};
}

/// Refuses a recording.
void refuse(WatchedRecording& recording, const std::string& reason) {
  recording.state = RecordingState::refused;
  recording.reason = detail::one_line(reason);
}

/// What verify says of a recording.
void verify(const StoredResult& result, const RecordingFiles& files, const WatchOptions& options,
            double not_before, WatchedRecording& recording) {
  recording.time = kNano * static_cast<double>(recording.modified);
  try {
    const NewSampleOptions of_new{
        {files.path}, {}, options.recorded, options.level, options.mesh_paths};
    Diagnostics diagnostics;
    std::vector<Sample> samples = read_new_recordings(of_new, diagnostics);
    recording.time = time_of(samples, recording);
    if (diagnostics.errors.empty() && recording.time < not_before) {
      return refuse(recording, "was recorded before the result in force");
    }
    const NewSamples fresh =
        hold_against(result, std::move(samples), of_new, std::move(diagnostics));
    const std::vector<std::string>& errors = fresh.diagnostics.errors;
    if (!errors.empty()) {
      return refuse(recording, errors.front() + (errors.size() > 1 ? fmt::format(" (and {} more)",
                                                                                 errors.size() - 1)
                                                                   : ""));
    }
    recording.samples = static_cast<int>(fresh.samples.size());
    if (!std::isfinite(fresh.misfit)) {
      recording.state = RecordingState::does_not_hold;
      recording.probability = 0.0;
      recording.reason = kBehindCamera;
      return;
    }
    const Drift drift = drift_of(result, fresh, {options.level, true});
    recording.state = drift.holds ? RecordingState::holds : RecordingState::does_not_hold;
    recording.statistic = drift.statistic;
    recording.freedom = drift.freedom;
    recording.probability = drift.probability;
    for (const Mover& mover : drift.movers) {
      recording.changes.push_back(watched(mover, fresh.problem().table()));
    }
  } catch (const std::exception& error) {
    recording.may_pass = dynamic_cast<const std::bad_alloc*>(&error) != nullptr ||
                         dynamic_cast<const std::system_error*>(&error) != nullptr;
    refuse(recording, error.what());
  }
}

/// G of the pose that matters: see ChangeSize.
std::optional<ChangeSize> size_of(const StoredResult& result, const WatchedChange& mover) {
  if (!result.pose) return std::nullopt;
  const Calibration calibration = with_movers(result);
  if (calibration.steps.empty()) return std::nullopt;
  const AnyProblem& problem = *calibration.steps.back().problem;
  const std::vector<double> values = result.values_of(problem.table());
  const std::vector<Sample> poses = result.pose_samples();
  std::vector<std::size_t> columns;
  for (const std::string& name : mover.parameters) {
    const int index = problem.table().find(name);
    if (index < 0) return std::nullopt;
    columns.push_back(static_cast<std::size_t>(index));
  }
  bool is_known = true;
  constexpr double kStep = 1e-3;  // radians or metres
  const auto squared = [&](std::size_t i, std::size_t j) {
    std::vector<double> moved = values;
    moved[columns[i]] += kStep;
    if (j != i) moved[columns[j]] += kStep;
    const PoseChange change = pose_change({problem, values}, {problem, moved}, poses,
                                          result.pose->frame, result.pose->in);
    is_known = is_known && change.poses > 0;
    return change.position * change.position / (kStep * kStep);
  };
  const std::size_t k = columns.size();
  ChangeSize size{std::vector<double>(k * k)};
  for (std::size_t i = 0; i < k; ++i) size.effect[i * k + i] = squared(i, i);
  for (std::size_t i = 0; i < k; ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const double both = 0.5 * (squared(i, j) - size.effect[i * k + i] - size.effect[j * k + j]);
      size.effect[i * k + j] = size.effect[j * k + i] = both;
    }
  }
  return is_known ? std::optional(size) : std::nullopt;
}

/// A robot's result in force, read once.
struct ResultInForce {
  std::string checksum;
  StoredResult result;
  std::int64_t epoch = 0;
  double written = 0.0;  ///< seconds since 1970
};

/// The robots of a tree and their history.
class Watch {
 public:
  explicit Watch(const WatchOptions& options)
      : options_(options),
        history_(options.history.empty()
                     ? (std::filesystem::path(options.tree) / "history.sqlite").string()
                     : options.history) {}

  /// Looks at all recordings that are new, and judges all robots.
  [[nodiscard]] const std::vector<SeenRobot>& look() {
    seen_.clear();
    for (const WatchedRobot& robot :
         robots_in(options_.tree, {options_.result, options_.recordings})) {
      SeenRobot& of = seen_.emplace_back();
      of.name = robot.name;
      try {
        look_at(robot, result_of(robot), of);
      } catch (const IsAsked&) {
        throw;
      } catch (const HistoryFault&) {
        throw;
      } catch (const std::exception& error) {
        of.fault = detail::one_line(error.what());
      }
    }
    judge();
    return seen_;
  }

  /// The command was asked to end.
  struct IsAsked {};

 private:
  /// The history cannot be written: not the fault of a robot.
  struct HistoryFault : InputError {
    using InputError::InputError;
  };

  ResultInForce& result_of(const WatchedRobot& robot) {
    const std::filesystem::path report = std::filesystem::path(robot.result) / "report.json";
    const std::string file = report.string();
    std::error_code error;
    const std::string checksum =
        std::filesystem::exists(report, error) ? sha256_of_files({&file, 1}) : std::string();
    ResultInForce& known = results_[robot.name];
    if (!checksum.empty() && known.checksum == checksum) return known;
    known = {};
    known.result = read_result(robot.result);
    if (compares_surface(known.result.config)) {
      throw InputError(
          robot.result +
          ": is a result of the robot's own surface: verify its recordings with 'kinecal verify'");
    }
    known.epoch = history_.epoch(robot.name, structure_checksum(known.result.robot), checksum);
    known.written = kNano * static_cast<double>(file_time(file));
    known.checksum = checksum;
    return known;
  }

  void look_at(const WatchedRobot& robot, const ResultInForce& in_force, SeenRobot& of) {
    constexpr std::size_t kTogether = 20;  // recordings of a transaction
    const double not_before = history_.follows_another(in_force.epoch) ? in_force.written : 0.0;
    std::vector<WatchedRecording> found;
    const auto add = [&] {
      try {
        history_.add(in_force.epoch, found);
      } catch (const InputError& error) {
        throw HistoryFault(error.what());
      }
      found.clear();
    };
    for (RecordingFiles& files : recordings_in(robot.recordings)) {
      if (Interruption::is_asked()) {
        add();
        throw IsAsked();
      }
      if (history_.knows(in_force.epoch, files.seen)) continue;
      if (!is_settled(files, file_time_now(), options_.settle)) {
        ++of.written;
        continue;
      }
      WatchedRecording& recording = found.emplace_back(files.seen);
      check(robot, in_force, not_before, files, recording);
      if (found.size() >= kTogether) add();
    }
    add();
    of.history = {robot.name, history_.recordings(in_force.epoch)};
  }

  void check(const WatchedRobot& robot, const ResultInForce& in_force, double not_before,
             const RecordingFiles& files, WatchedRecording& recording) {
    recording.time = kNano * static_cast<double>(recording.modified);
    try {
      recording.checksum = sha256_of_files(files.files);
    } catch (const InputError& error) {
      recording.checksum = sha256_text(error.what());
      recording.may_pass = true;  // it cannot be read
      return refuse(recording, error.what());
    }
    const auto same = history_.with_content(recording.checksum);
    if (same && same->robot != robot.name) {
      return refuse(recording,
                    fmt::format("is the same file as '{}' of robot '{}'", same->name, same->robot));
    }
    if (same) return;  // a copy, or touched
    verify(in_force.result, files, options_, not_before, recording);
  }

  void judge() {
    std::vector<RobotHistory> histories;
    for (const SeenRobot& robot : seen_) histories.push_back(robot.history);
    std::vector<RobotFinding> findings = judge_fleet(histories, options_.level);
    for (std::size_t i = 0; i < seen_.size(); ++i) {
      SeenRobot& of = seen_[i];
      of.history = std::move(histories[i]);  // to whose recordings the finding points
      of.finding = std::move(findings[i]);
      if (!of.fault.empty()) continue;
      const StoredResult& result = results_.at(of.name).result;
      WatchLimits limits{.now = kNano * static_cast<double>(file_time_now()),
                         .ahead = kDay * options_.ahead};
      const WatchedChange* mover = of.finding.drift ? &of.finding.drift->of : of.finding.moved;
      if (result.pose) {
        of.what = fmt::format("'{}' in '{}'", result.pose->frame.name(), result.pose->in.name());
        of.limit = options_.limit > 0.0 ? 1e-3 * options_.limit : 3.0 * result.pose->position;
      }
      if (mover != nullptr) {
        of.mover = mover_name(result, mover->owner, mover->is_frame);
      }
      if (const WatchedChange* moved = of.finding.moved) {
        of.moved = mover_name(result, moved->owner, moved->is_frame);
      }
      if (std::isfinite(of.limit) && of.limit > 0.0) {
        limits.size = [&](const WatchedChange& changed) { return size_of(result, changed); };
      }
      limits.limit = of.limit;
      of.decision = decide(of.finding, limits);
    }
  }

  const WatchOptions& options_;
  History history_;
  std::map<std::string, ResultInForce> results_;  ///< by robot
  std::vector<SeenRobot> seen_;
};

int exit_code(const std::vector<SeenRobot>& robots) {
  int code = kDone;
  for (const SeenRobot& robot : robots) {
    if (robot.fault.empty() && robot.decision.state == FleetState::recalibrate) return kNotUsable;
    if (!robot.fault.empty() || robot.finding.is_last_refused) code = kBadInput;
  }
  return code;
}

std::string text_of(const std::vector<SeenRobot>& robots) {
  std::string text;
  for (const SeenRobot& robot : robots) text += line_of(robot);
  return text;
}

/// Prints and writes what was found.
void write(const WatchOptions& options, const std::vector<SeenRobot>& robots,
           const std::string& text) {
  if (options.manner.json) {
    const detail::Json json = watch_json(robots);
    say("{}", options.once ? detail::json_lines(json) : detail::json_text(json) + "\n");
  } else {
    show(text + summary_of(robots) + "\n", options.manner);
  }
  std::fflush(stdout);
  if (options.report.empty()) return;
  write_output(options.report, is_page(options.report) ? watch_page(options.tree, robots)
                                                       : detail::json_lines(watch_json(robots)));
}

}  // namespace

int watch(const WatchOptions& options) {
  if (!options.report.empty()) check_report(options.report, {options.history}, true);
  const Interruption interruption;
  (void)robots_in(options.tree, {options.result, options.recordings});  // before there is a history
  Watch robots(options);
  std::string before;
  try {
    while (true) {
      const std::vector<SeenRobot>& seen = robots.look();
      const std::string text = text_of(seen);
      if (text != before) write(options, seen, text);
      before = text;
      if (options.once) return exit_code(seen);
      const auto until =
          std::chrono::steady_clock::now() + std::chrono::duration<double>(options.interval);
      while (std::chrono::steady_clock::now() < until) {
        if (Interruption::is_asked()) return kInterrupted;
        std::this_thread::sleep_for(std::chrono::milliseconds(50));
      }
    }
  } catch (const Watch::IsAsked&) {
    return kInterrupted;
  }
}

}  // namespace kinecal::cli
