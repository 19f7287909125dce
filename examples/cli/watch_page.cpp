// SPDX-License-Identifier: Apache-2.0
#include "watch_page.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <nlohmann/json.hpp>

#include "commands.hpp"
#include "kinecal/report/charts/drift_over_time.hpp"
#include "kinecal/report/html.hpp"
#include "kinecal/report/svg_text.hpp"
#include "kinecal/text/characters.hpp"
#include "kinecal/text/counted.hpp"
#include "kinecal/text/reading.hpp"
#include "moved_text.hpp"

namespace kinecal::cli {
namespace {

using detail::Json;

constexpr double kWeek = 7.0 * kDay;

const char* state_text(const SeenRobot& robot) {
  if (!robot.fault.empty()) return "cannot be checked";
  switch (robot.decision.state) {
    case FleetState::not_known:
      return "not known";
    case FleetState::holds:
      return "holds";
    case FleetState::drifts:
      return "drifts";
    case FleetState::recalibrate:
      return "recalibrate";
  }
  return "";
}

/// The drift in a week.
NamedChange weekly(const FoundDrift& drift) {
  NamedChange change{
      drift.of.owner, drift.of.is_frame, drift.of.parameters, drift.of.units, {}, {}};
  for (std::size_t i = 0; i < drift.line.slope.size(); ++i) {
    change.change.push_back(kWeek * drift.line.slope[i]);
    change.deviation.push_back(kWeek * drift.line.slope_deviation(i));
  }
  return change;
}

/// What has moved in the last recording.
NamedChange moved_by(const WatchedChange& moved) {
  NamedChange change{moved.owner, moved.is_frame, moved.parameters, moved.units, moved.change, {}};
  const std::size_t k = moved.change.size();
  for (std::size_t i = 0; i < k; ++i) {
    change.deviation.push_back(std::sqrt(std::max(0.0, moved.covariance[i * k + i])));
  }
  return change;
}

/// "'tool' in 'tracker_frame' is off by 1.2 mm, limit 0.36 mm"
std::string size_text(const SeenRobot& robot) {
  const RobotDecision& decision = robot.decision;
  if (!decision.change) return "";
  std::string text = fmt::format("; {} is off by {}, limit {}", robot.what,
                                 reading(*decision.change, "m"), reading(robot.limit, "m"));
  if (decision.passes && *decision.change <= robot.limit) {
    text += fmt::format(", reached {} +- {:.0f} days", day_text(decision.passes->time),
                        std::ceil(decision.passes->deviation / kDay));
  }
  return text;
}

/// True if what explains the last recording is what drifts, or cannot be told from it.
bool is_of_drift(const RobotFinding& of) {
  if (!of.drift || of.moved == nullptr) return false;
  const std::vector<std::string>& alike = of.drift->alike;
  return of.moved->is_of(of.drift->of) ||
         std::find(alike.begin(), alike.end(), of.moved->owner) != alike.end();
}

/// What has moved in the last recording.
/// @param on  its day
std::string moved_text(const SeenRobot& robot, const std::string& on) {
  const RobotFinding& of = robot.finding;
  if (of.moved != nullptr) {
    return fmt::format("{} has moved by {} ({} among all robots, {})", robot.moved,
                       change_text(moved_by(*of.moved)), chance_text(of.probability), on);
  }
  return fmt::format(
      "'{}'{} does not fit, and nothing that moved alone explains it ({} among all robots, {})",
      of.last->name, of.last->reason.empty() ? "" : ": " + of.last->reason,
      chance_text(of.probability), on);
}

/// Why the robot is in its state.
std::string why(const SeenRobot& robot) {
  if (!robot.fault.empty()) return robot.fault;
  const RobotFinding& of = robot.finding;
  if (of.usable == 0) {
    return of.refused == 0 ? "no recording yet"
                           : counted(static_cast<std::size_t>(of.refused), "recording") +
                                 " refused, the last: " + robot.history.recordings.back().reason;
  }
  const std::string on = day_text(of.last->time);
  std::string text;
  if (of.drift) {
    std::string alike;
    for (const std::string& other : of.drift->alike) alike += " or '" + other + "'";
    text =
        fmt::format("{}{} drifts by {} ({} among all robots, {})", robot.mover, alike,
                    change_text(weekly(*of.drift), " a week"), chance_text(of.drift->probability),
                    counted(static_cast<std::size_t>(of.drift->line.recordings), "recording"));
  }
  if (of.has_moved && !is_of_drift(of)) {
    text += (text.empty() ? "" : "; ") + moved_text(robot, on);
  }
  if (!of.drift && !of.has_moved) {
    text = fmt::format("{}, the last on {} ({})",
                       counted(static_cast<std::size_t>(of.usable), "recording"), on,
                       chance_text(of.last->probability));
    if (of.last->state != RecordingState::holds) {
      text += ", which is chance among so many: record another";
    }
  }
  return text + size_text(robot);
}

/// Each recording that was refused, and why.
std::vector<std::pair<std::string, std::string>> refusals(const SeenRobot& robot) {
  std::vector<std::pair<std::string, std::string>> all;
  for (const WatchedRecording& recording : robot.history.recordings) {
    if (recording.state == RecordingState::refused) {
      all.emplace_back(recording.name, recording.reason);
    }
  }
  return all;
}

/// Why the recordings that were refused were.
std::string refused_text(const SeenRobot& robot) {
  if (!robot.fault.empty() || robot.finding.usable == 0 || robot.finding.refused == 0) return "";
  const auto last =
      std::find_if(robot.history.recordings.rbegin(), robot.history.recordings.rend(),
                   [](const WatchedRecording& of) { return of.state == RecordingState::refused; });
  return fmt::format("; {} refused, the last '{}': {}",
                     counted(static_cast<std::size_t>(robot.finding.refused), "recording"),
                     last->name, last->reason);
}

Json json_of(const SeenRobot& robot) {
  const RobotFinding& of = robot.finding;
  Json drift, last;
  const auto parameters = [](const NamedChange& change, const char* name) {
    Json all = Json::array();
    for (std::size_t i = 0; i < change.parameters.size(); ++i) {
      all.push_back({{"name", change.parameters[i]},
                     {"unit", change.units[i]},
                     {name, change.change[i]},
                     {"sigma", change.deviation[i]}});
    }
    return all;
  };
  if (of.drift) {
    drift = {{"owner", of.drift->of.owner},
             {"is_frame", of.drift->of.is_frame},
             {"alike", of.drift->alike},
             {"probability", of.drift->probability},
             {"recordings", of.drift->line.recordings},
             {"scatter", of.drift->line.scatter},
             {"memory", of.drift->line.memory},
             {"parameters", parameters(weekly(*of.drift), "per_week")}};
  }
  if (of.last != nullptr) {
    last = {{"name", of.last->name},
            {"time", of.last->time},
            {"holds", of.last->state == RecordingState::holds},
            {"probability", of.last->probability},
            {"statistic", of.last->statistic},
            {"freedom", of.last->freedom},
            {"samples", of.last->samples}};
  }
  Json moved;
  if (of.moved != nullptr) {
    moved = {{"owner", of.moved->owner},
             {"is_frame", of.moved->is_frame},
             {"parameters", parameters(moved_by(*of.moved), "change")}};
  }
  Json refused = Json::array();
  for (const auto& [name, reason] : refusals(robot)) {
    refused.push_back({{"name", name}, {"reason", reason}});
  }
  const auto or_null = [](const auto& value) { return value ? Json(*value) : Json(); };
  const std::optional<When>& passes = robot.decision.passes;
  return {{"name", robot.name},
          {"state", state_text(robot)},
          {"why", why(robot)},
          {"recordings", of.usable},
          {"refused", of.refused},
          {"refusals", refused},
          {"being_written", robot.written},
          {"last", last},
          {"has_moved", of.has_moved},
          {"moved", moved},
          {"drift", drift},
          {"change", or_null(robot.decision.change)},
          {"limit", robot.limit > 0.0 ? Json(robot.limit) : Json()},
          {"passes", passes ? Json(passes->time) : Json()},
          {"passes_sigma", passes ? Json(passes->deviation) : Json()}};
}

/// The change of the same parameters in a recording; nullptr if it has none.
const WatchedChange* change_in(const WatchedRecording& recording, const WatchedChange& of) {
  const auto found = std::find_if(recording.changes.begin(), recording.changes.end(),
                                  [&](const WatchedChange& other) { return other.is_of(of); });
  return found == recording.changes.end() ? nullptr : &*found;
}

/// The parameter that drifts or has moved, over time; of other robots, how well the result fits.
Chart chart_of(const SeenRobot& robot, std::size_t number) {
  DriftSeries series{.name = fmt::format("watch-{}", number),
                     .title = robot.name,
                     .caption = {},
                     .what = {},
                     .unit = {},
                     .points = {}};
  const RobotFinding& of = robot.finding;
  const WatchedChange* mover = of.drift ? &of.drift->of : of.moved;
  if (mover == nullptr) {
    series.what = "residuals by what is expected";
    series.expected = 1.0;
    for (const WatchedRecording& recording : robot.history.recordings) {
      if (recording.state == RecordingState::refused || !(recording.freedom > 0.0)) continue;
      series.points.push_back({recording.time, std::sqrt(recording.statistic / recording.freedom),
                               0.0, recording.state == RecordingState::holds});
    }
    return drift_chart(series);
  }
  std::size_t shown = 0;
  const auto times = [&](std::size_t i) {
    return of.drift ? std::abs(of.drift->line.slope[i]) / of.drift->line.slope_deviation(i)
                    : std::abs(of.moved->change[i]) / moved_by(*of.moved).deviation[i];
  };
  for (std::size_t i = 1; i < mover->parameters.size(); ++i) {
    if (times(i) > times(shown)) shown = i;
  }
  series.title += ": " + mover->parameters[shown];
  series.what = "change since the calibration";
  series.unit = mover->units[shown];
  for (const WatchedRecording& recording : robot.history.recordings) {
    const WatchedChange* change =
        recording.state == RecordingState::refused ? nullptr : change_in(recording, *mover);
    if (change == nullptr) continue;
    const std::size_t k = change->change.size();
    series.points.push_back({recording.time, change->change[shown],
                             std::sqrt(std::max(0.0, change->covariance[shown * k + shown])),
                             recording.state == RecordingState::holds});
  }
  if (of.drift) {
    const DriftLine& line = of.drift->line;
    series.line = {line.origin, line.level[shown], line.slope[shown]};
  }
  return drift_chart(series);
}

}  // namespace

std::string day_text(double time) {
  const std::chrono::sys_days day{
      std::chrono::days(static_cast<std::int64_t>(std::floor(time / kDay)))};
  const std::chrono::year_month_day date{day};
  return fmt::format("{:04}-{:02}-{:02}", static_cast<int>(date.year()),
                     static_cast<unsigned>(date.month()), static_cast<unsigned>(date.day()));
}

std::string line_of(const SeenRobot& robot) {
  return fmt::format(
      "{}: {}: {}{}{}\n", detail::one_line(robot.name), state_text(robot),
      detail::one_line(why(robot)), detail::one_line(refused_text(robot)),
      robot.written > 0 ? fmt::format("; {} still being written", robot.written) : "");
}

std::string summary_of(const std::vector<SeenRobot>& robots) {
  std::size_t hold = 0;
  std::string recalibrate, not_known, faulty;
  const auto add = [](std::string& names, const char* title, const SeenRobot& robot) {
    names += (names.empty() ? title : ", ") + detail::one_line(robot.name);
  };
  for (const SeenRobot& robot : robots) {
    if (!robot.fault.empty()) {
      add(faulty, "; cannot be checked: ", robot);
    } else if (robot.decision.state == FleetState::not_known) {
      add(not_known, "; not known: ", robot);
    } else if (robot.decision.state == FleetState::recalibrate) {
      add(recalibrate, "; recalibrate ", robot);
    } else {
      ++hold;
    }
  }
  const bool is_singular = hold == 1 || robots.size() == 1;
  return fmt::format("{} of {} {}{}{}{}", hold, counted(robots.size(), "robot"),
                     is_singular ? "holds" : "hold", recalibrate, not_known, faulty);
}

Json watch_json(const std::vector<SeenRobot>& robots) {
  Json all = Json::array();
  for (const SeenRobot& robot : robots) all.push_back(json_of(robot));
  return {{"summary", summary_of(robots)}, {"robots", all}};
}

std::string watch_page(const std::string& tree, const std::vector<SeenRobot>& robots) {
  std::vector<std::vector<std::string>> rows = {{"robot", "state", "recordings", "refused", "why"}};
  std::vector<Chart> charts;
  std::vector<const SeenRobot*> sorted;  // those that need somebody first
  for (const SeenRobot& robot : robots) sorted.push_back(&robot);
  const auto rank = [](const SeenRobot* of) {
    return of->fault.empty() ? -static_cast<int>(of->decision.state) : -4;
  };
  std::stable_sort(sorted.begin(), sorted.end(),
                   [&](const SeenRobot* a, const SeenRobot* b) { return rank(a) < rank(b); });
  const bool is_good =
      rank(sorted.front()) > -static_cast<int>(FleetState::recalibrate);  // there is a robot
  for (const SeenRobot* seen : sorted) {
    const SeenRobot& robot = *seen;
    rows.push_back({robot.name, state_text(robot), std::to_string(robot.finding.usable),
                    std::to_string(robot.finding.refused), why(robot)});
    Chart chart = chart_of(robot, charts.size() + 1);
    if (!chart.svg.empty()) charts.push_back(std::move(chart));
  }
  std::string figures;
  for (const Chart& chart : charts) figures += detail::html_figure(chart);
  std::vector<std::vector<std::string>> refused = {{"robot", "recording", "why it is refused"}};
  for (const SeenRobot* robot : sorted) {
    for (const auto& [name, reason] : refusals(*robot)) {
      refused.push_back({robot->name, name, reason});
    }
  }
  const std::string not_used = refused.size() == 1
                                   ? ""
                                   : "<section id=\"refused\"><h2>Refused</h2>\n" +
                                         detail::html_table(refused, "ttl") + "</section>\n";
  const std::string title = summary_of(robots);
  const std::string body = fmt::format(
      "<header class=\"verdict {}\">\n<h1>{}: <strong>{}</strong></h1>\n</header>\n<main>\n"
      "<section id=\"robots\"><h2>Robots</h2>\n{}</section>\n"
      "<section id=\"drift\"><h2>Over time</h2>\n<p>A change is that of the joint, frame or sensor "
      "that drifts or has "
      "moved, with one standard deviation. Of the other robots, residuals by what noise and the "
      "uncertainty of the result "
      "make.</p>\n<div class=\"pair\">{}</div>\n</section>\n{}</main>\n",
      is_good ? "good" : "care", detail::html_name(tree), detail::html_text(title),
      detail::html_table(rows, "ttnnl"), figures, not_used);
  return html_file({tree + ": " + title, version(), body, ""});
}

}  // namespace kinecal::cli
