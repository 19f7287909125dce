// Definitions of drive_readings.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/config/doubts/drive_readings.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "kinecal/config/registry.hpp"
#include "kinecal/errors/base_motion.hpp"

namespace kinecal::detail {

namespace {

/// A change since the sample before; nullopt where one of both is missing.
[[nodiscard]] std::optional<double> step_of(const Sample& sample, const std::string& name) {
  const auto now = sample.conditions.find(name), before = sample.before.find(name);
  if (now == sample.conditions.end() || before == sample.before.end()) return std::nullopt;
  const double by = now->second - before->second;
  return std::isfinite(by) ? std::optional(by) : std::nullopt;
}

/// All changes of a reading; those of angles within half a turn.
[[nodiscard]] std::vector<double> steps_of(std::span<const Sample> samples,
                                           const std::string& name) {
  const bool is_angle = name.ends_with("yaw") || name == "wall_angle";
  std::vector<double> steps;
  for (const Sample& sample : samples) {
    if (const auto by = step_of(sample, name)) {
      steps.push_back(is_angle ? std::remainder(*by, 2.0 * std::numbers::pi) : *by);
    }
  }
  return steps;
}

/// From the least to the largest of the sums of changes.
[[nodiscard]] double range_of_steps(std::span<const Sample> samples, const std::string& name) {
  double at = 0.0, least = 0.0, most = 0.0;
  for (const double by : steps_of(samples, name)) {
    at += by;
    least = std::min(least, at);
    most = std::max(most, at);
  }
  return most - least;
}

[[nodiscard]] bool never_changes(std::span<const Sample> samples, const std::string& name) {
  const std::vector<double> steps = steps_of(samples, name);
  return !steps.empty() &&
         std::all_of(steps.begin(), steps.end(), [](double by) { return by == 0.0; });
}

/// Readings of a block that never change while what is seen does.
void check_stuck(const BlockConfig& block, const std::vector<std::string>& names,
                 std::span<const Sample> samples, Diagnostics& diagnostics) {
  constexpr double kMoved = 0.3;  // radians or metres
  const auto moved = [&](const char* name) {
    return std::find(names.begin(), names.end(), name) != names.end() &&
           range_of_steps(samples, name) > kMoved;
  };
  const bool has_turned = moved("track_yaw") || moved("wall_angle");
  if (!has_turned && !moved("track_x") && !moved("track_y") && !moved("wall_distance")) return;
  std::vector<std::string> stuck;
  int odometry = 0;
  for (const std::string& name : names) {
    const bool is_wheel = name.ends_with("wheel"), is_gyro = name == "gyro_yaw";
    const bool is_odometry = name.starts_with("odom_");
    if (!(is_wheel || (is_gyro && has_turned) || is_odometry)) continue;
    if (!never_changes(samples, name)) continue;
    odometry += is_odometry ? 1 : 0;
    stuck.push_back(name);
  }
  constexpr int kPose = 3;  // x, y, yaw: a base that goes ahead may change only one of them
  if (stuck.empty() || (odometry > 0 && odometry < kPose)) return;
  diagnostics.error(block.place,
                    fmt::format("'{}' {} the same in all samples, while what is seen "
                                "moves: is it read, is its column the right one?",
                                fmt::join(stuck, "', '"), stuck.size() == 1 ? "is" : "are"));
}

/// The largest of rates, but for a fiftieth, which may have jumped; zero if there are none.
[[nodiscard]] double largest_rate(std::span<const Sample> samples, const std::string& name) {
  const bool is_angle = name.ends_with("yaw") || name == "wall_angle";
  std::vector<double> rates;
  for (const Sample& sample : samples) {
    const auto by = step_of(sample, name), time = step_of(sample, "time");
    if (!by || !time || !(*time > 0.0)) continue;
    const double way = is_angle ? std::remainder(*by, 2.0 * std::numbers::pi) : *by;
    rates.push_back(std::abs(way) / *time);
  }
  if (rates.empty()) return 0.0;
  const auto at = rates.begin() + static_cast<std::ptrdiff_t>(rates.size() / 50);
  std::nth_element(rates.begin(), at, rates.end(), std::greater<>());
  return *at;
}

/// Times by which the base would crawl.
/// @param names  of readings; wheels, whose unit may be ticks, do not count
void check_unit_of_time(const BlockConfig& block, const std::set<std::string>& names,
                        std::span<const Sample> samples, Diagnostics& diagnostics) {
  constexpr double kMoved = 0.3, kSlow = 0.02;  // radians or metres; a second
  double fastest = 0.0;
  std::string of;
  for (const std::string& name : names) {
    if (name == "time" || name.ends_with("wheel") || name == "steering") continue;
    if (!(range_of_steps(samples, name) > kMoved)) continue;
    const double rate = largest_rate(samples, name);
    if (rate > fastest) of = name;
    fastest = std::max(fastest, rate);
  }
  if (of.empty() || fastest > kSlow) return;
  constexpr std::array<std::pair<double, const char*>, 3> kUnits = {
      {{1e3, "milliseconds"}, {1e6, "microseconds"}, {1e9, "nanoseconds"}}};
  constexpr double kLeast = 0.05, kMost = 20.0;  // of a base that drives
  std::string unit = "is it in seconds?";
  for (const auto& [factor, name] : kUnits) {
    if (factor * fastest < kLeast || factor * fastest > kMost) continue;
    unit = fmt::format("is it in {}?  It is to be in seconds", name);
    break;
  }
  const bool is_angle = of.ends_with("yaw") || of.ends_with("angle");
  diagnostics.error(block.place,
                    fmt::format("by 'time', '{}' changes by {:.2g} {} a second at most: {}", of,
                                fastest, is_angle ? "rad" : "m", unit));
}

/// Times that do not grow within a run, and their unit.
void check_times(const BlockConfig& block, const std::set<std::string>& names,
                 std::span<const Sample> samples, Diagnostics& diagnostics) {
  constexpr double kMost = 0.1;  // of the times, which a recording may repeat
  std::size_t all = 0, same = 0;
  for (const Sample& sample : samples) {
    const auto by = step_of(sample, "time");
    if (!by) continue;
    ++all;
    same += *by == 0.0 ? 1 : 0;
    if (*by < 0.0) {
      diagnostics.errors.push_back(fmt::format(
          "{}: 'time' goes back, from {:.10g} to {:.10g}, in the same run: are the rows "
          "in their order?  Number runs in a column 'run'",
          sample.source, sample.before.at("time"), sample.conditions.at("time")));
      return;
    }
  }
  if (all == 0) return;
  if (static_cast<double>(same) > kMost * static_cast<double>(all)) {
    diagnostics.error(block.place,
                      fmt::format("'time' does not change in {} of {} intervals: it is to be the "
                                  "time of each sample, seconds",
                                  same, all));
    return;
  }
  check_unit_of_time(block, names, samples, diagnostics);
}

}  // namespace

void check_drive_readings(const Config& config, std::span<const Sample> samples,
                          Diagnostics& diagnostics) {
  const BlockConfig* timed = nullptr;  // the first block that takes the time
  std::set<std::string> all;
  for (const StepConfig& step : config.steps) {
    for (const BlockConfig& block : step.error_blocks) {
      const BlockEntry* entry = is_base_type(block.type) ? entry_of(block) : nullptr;
      if (entry == nullptr) continue;
      const std::vector<std::string>& names = entry->looks_before;
      check_stuck(block, names, samples, diagnostics);
      const bool takes_time = std::find(names.begin(), names.end(), "time") != names.end();
      if (takes_time && timed == nullptr) timed = &block;
      all.insert(names.begin(), names.end());
    }
  }
  if (timed != nullptr) check_times(*timed, all, samples, diagnostics);
}

}  // namespace kinecal::detail
