// Definitions of fleet.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/tools/watch/fleet.hpp"

#include <sys/stat.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <system_error>

#include "kinecal/files/checksum.hpp"
#include "kinecal/files/diagnostics.hpp"
#include "kinecal/files/natural_order.hpp"

namespace kinecal {

namespace detail {
namespace {

namespace fs = std::filesystem;

/// The entries of a folder that are not hidden, in natural order; empty if it cannot be read.
[[nodiscard]] std::vector<fs::path> entries_of(const fs::path& folder) {
  std::vector<fs::path> all;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end;
       entry.increment(error)) {
    if (!entry->path().filename().string().starts_with('.')) all.push_back(entry->path());
  }
  std::sort(all.begin(), all.end(), [](const fs::path& a, const fs::path& b) {
    return naturally_before(a.filename().string(), b.filename().string());
  });
  return all;
}

void find_robots(const fs::path& folder, const std::string& name, const WatchedFolders& folders,
                 std::vector<WatchedRobot>& robots) {
  const fs::path result = folder / folders.result, recordings = folder / folders.recordings;
  std::error_code
      error;  // what cannot be looked at is no folder: one of another user, a link to itself
  if (fs::is_directory(result, error) ||
      (folders.recordings != "." && fs::is_directory(recordings, error))) {
    robots.push_back({name, result.string(), recordings.string()});
    return;
  }
  for (const fs::path& entry : entries_of(folder)) {
    if (!fs::is_directory(entry, error) || fs::is_symlink(entry, error)) continue;
    find_robots(entry, (name.empty() ? "" : name + "/") + entry.filename().string(), folders,
                robots);
  }
}

/// True for what is beside recordings, or is not finished.
[[nodiscard]] bool is_beside(const std::string& name) {
  if (name == "columns.yaml" || name == "history.sqlite") return true;
  constexpr const char* kEnds[] = {".part", ".tmp", ".active", "~", "-wal", "-shm", "-journal"};
  return std::any_of(std::begin(kEnds), std::end(kEnds),
                     [&](const char* end) { return name.ends_with(end); });
}

[[nodiscard]] std::int64_t nanoseconds(std::chrono::system_clock::time_point time) {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(time.time_since_epoch()).count();
}

void add_file(const fs::path& file, RecordingFiles& to) {
  std::error_code error;
  const auto size = fs::file_size(file, error);
  if (error) return;  // it was removed just now
  to.files.push_back(file.string());
  to.seen.size += static_cast<std::int64_t>(size);
  to.seen.modified = std::max(to.seen.modified, file_time(file.string()));
  struct stat status = {};
  if (stat(file.c_str(), &status) == 0) {
    to.changed =
        std::max(to.changed, nanoseconds(std::chrono::system_clock::from_time_t(status.st_ctime)));
  }
  for (const char* end : {"-wal", "-journal"}) {
    if (fs::exists(file.string() + end, error)) to.is_open = true;
  }
}

void find_recordings(const fs::path& folder, const std::string& prefix,
                     std::vector<RecordingFiles>& recordings) {
  for (const fs::path& entry : entries_of(folder)) {
    const std::string name = entry.filename().string();
    std::error_code error;
    const bool is_folder = fs::is_directory(entry, error);
    if (is_folder && fs::exists(entry / "report.json", error)) continue;  // a result
    if (is_folder && !fs::exists(entry / "metadata.yaml", error)) {
      if (!fs::is_symlink(entry, error)) find_recordings(entry, prefix + name + "/", recordings);
      continue;
    }
    if (is_beside(name) || (!is_folder && !fs::is_regular_file(entry, error))) continue;
    RecordingFiles found{.path = entry.string(), .files = {}, .seen = {}};
    found.seen.name = prefix + name;
    if (is_folder) {
      for (const fs::path& part : entries_of(entry)) {
        if (!is_beside(part.filename().string())) add_file(part, found);
      }
    } else {
      add_file(entry, found);
    }
    if (!found.files.empty()) recordings.push_back(std::move(found));
  }
}

/// The recordings that were verified.
[[nodiscard]] bool is_usable(const WatchedRecording& recording) {
  return recording.state != RecordingState::refused;
}

/// X if nothing has moved, and what samples that do not fit cost every mover; at least.
[[nodiscard]] double score_of_rest(const WatchedRecording& recording) {
  double score = recording.statistic;
  for (const WatchedChange& change : recording.changes) {
    score = std::max(score, change.score - 2.0 * static_cast<double>(change.change.size()));
  }
  return score;
}

/// The movers of a robot, each with its changes by time.
struct MoverOverTime {
  WatchedChange of;
  std::vector<TimedChange> changes;
};

[[nodiscard]] std::vector<MoverOverTime> movers_of(const RobotHistory& robot) {
  std::vector<MoverOverTime> movers;
  for (const WatchedRecording& recording : robot.recordings) {
    if (!is_usable(recording)) continue;
    const double rest = score_of_rest(recording);
    for (const WatchedChange& change : recording.changes) {
      auto known = std::find_if(movers.begin(), movers.end(),
                                [&](const MoverOverTime& mover) { return mover.of.is_of(change); });
      if (known == movers.end()) {
        known = movers.insert(known, {{.owner = change.owner,
                                       .is_frame = change.is_frame,
                                       .parameters = change.parameters,
                                       .units = change.units},
                                      {}});
      }
      known->changes.push_back(
          {recording.time, change.change, change.covariance, change.score - rest});
    }
  }
  return movers;
}

}  // namespace
}  // namespace detail

std::vector<WatchedRobot> robots_in(const std::string& tree, const WatchedFolders& folders) {
  std::error_code error;
  if (!std::filesystem::is_directory(tree, error)) {
    const bool exists = std::filesystem::exists(std::filesystem::symlink_status(tree, error));
    throw InputError(tree + (exists ? ": is not a folder" : ": does not exist"));
  }
  std::vector<WatchedRobot> robots;
  detail::find_robots(tree, "", folders, robots);
  if (robots.empty()) {
    throw InputError(tree + ": no folder in it has a folder '" + folders.result +
                     "', which 'kinecal calibrate --output' writes; give its name with --result");
  }
  for (WatchedRobot& robot : robots) {
    if (!robot.name.empty()) continue;  // the tree itself
    const auto path = std::filesystem::weakly_canonical(tree, error);
    robot.name = (path.has_filename() ? path : path.parent_path()).filename().string();
  }
  return robots;
}

std::vector<RecordingFiles> recordings_in(const std::string& folder) {
  std::vector<RecordingFiles> recordings;
  detail::find_recordings(folder, "", recordings);
  return recordings;
}

bool is_settled(const RecordingFiles& recording, std::int64_t now, double seconds) {
  constexpr double kNano = 1e-9;
  const bool is_ahead = recording.seen.modified > now;  // it has the date of another clock
  const std::int64_t written = is_ahead ? recording.changed : recording.seen.modified;
  return !recording.is_open && kNano * static_cast<double>(now - written) >= seconds;
}

std::int64_t file_time(const std::string& file) {
  std::error_code error;
  const auto written = std::filesystem::last_write_time(file, error);
  if (error) return 0;
  return detail::nanoseconds(std::chrono::time_point_cast<std::chrono::system_clock::duration>(
      std::chrono::file_clock::to_sys(written)));
}

std::int64_t file_time_now() {
  return detail::nanoseconds(std::chrono::system_clock::now());
}

std::string structure_checksum(const Robot& robot) {
  std::vector<std::string> lines;
  for (const Joint& joint : robot.joints()) {
    lines.push_back(joint.name + "\n" + std::string(to_string(joint.type)) + "\n" + joint.parent +
                    "\n" + joint.child + "\n");
  }
  std::sort(lines.begin(), lines.end());
  std::string text;
  for (const std::string& line : lines) text += line;
  return sha256_text(text);
}

std::vector<RobotFinding> judge_fleet(std::span<const RobotHistory> robots, double level) {
  std::vector<std::vector<detail::MoverOverTime>> movers;
  std::vector<MoverLine> lines;
  double recordings = 0.0;
  for (const RobotHistory& robot : robots) {
    const auto number = static_cast<int>(movers.size());
    movers.push_back(detail::movers_of(robot));
    recordings += static_cast<double>(
        std::count_if(robot.recordings.begin(), robot.recordings.end(), detail::is_usable));
    for (std::size_t m = 0; m < movers.back().size(); ++m) {
      std::optional<DriftLine> line = drift_line(movers.back()[m].changes);
      if (line) lines.push_back({number, static_cast<int>(m), *std::move(line)});
    }
  }
  std::vector<RobotFinding> findings;
  for (const RobotHistory& robot : robots) {
    RobotFinding& of = findings.emplace_back();
    for (const WatchedRecording& recording : robot.recordings) {
      of.is_last_refused = !detail::is_usable(recording);
      ++(of.is_last_refused ? of.refused : of.usable);
      if (!of.is_last_refused) of.last = &recording;
    }
    if (of.last == nullptr || of.last->state == RecordingState::holds) continue;
    of.probability = std::min(1.0, recordings * of.last->probability);
    of.has_moved = of.probability < 0.5 * level;
    if (!of.has_moved) continue;
    for (const WatchedChange& change : of.last->changes) {
      if (change.explains && (of.moved == nullptr || change.score < of.moved->score)) {
        of.moved = &change;
      }
    }
  }
  for (const DriftingRobot& drifting : drifting_robots(lines, 0.5 * level)) {
    const auto& own = movers[static_cast<std::size_t>(drifting.robot)];
    const auto line = std::find_if(lines.begin(), lines.end(), [&](const MoverLine& of) {
      return of.robot == drifting.robot && of.mover == drifting.mover;
    });
    FoundDrift found{
        own[static_cast<std::size_t>(drifting.mover)].of, {}, line->line, drifting.probability};
    for (const int other : drifting.alike) {
      found.alike.push_back(own[static_cast<std::size_t>(other)].of.owner);
    }
    findings[static_cast<std::size_t>(drifting.robot)].drift = std::move(found);
  }
  return findings;
}

RobotDecision decide(const RobotFinding& finding, const WatchLimits& limits) {
  RobotDecision decision;
  if (finding.usable == 0) return decision;
  decision.state = FleetState::holds;
  const auto size_of = [&](const WatchedChange& mover) {
    return limits.size ? limits.size(mover) : std::nullopt;
  };
  if (finding.drift) {
    decision.state = FleetState::drifts;
    const DriftLine& line = finding.drift->line;
    if (const std::optional<ChangeSize> size = size_of(finding.drift->of)) {
      std::vector<double> now;
      for (std::size_t i = 0; i < line.slope.size(); ++i) {
        now.push_back(line.change_at(i, line.last));
      }
      decision.change = size->of(now);
      decision.passes = passes(line, *size, limits.limit);
    }
    if (decision.passes && decision.passes->time <= limits.now + limits.ahead) {
      decision.state = FleetState::recalibrate;
    }
  }
  if (!finding.has_moved) return decision;
  std::optional<double> moved;  // in the last recording, maybe something else than what drifts
  if (finding.moved != nullptr) {
    if (const std::optional<ChangeSize> size = size_of(*finding.moved)) {
      moved = size->of(finding.moved->change);
      decision.change = std::max(decision.change.value_or(0.0), *moved);
    }
  }
  if (!moved || *moved > limits.limit) decision.state = FleetState::recalibrate;
  return decision;
}

}  // namespace kinecal
