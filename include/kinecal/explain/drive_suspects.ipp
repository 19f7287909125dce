// Possible mistakes in the readings of a mobile base: wheels that are counted backwards, exchanged or wrapped, units, a gyroscope
// that is mounted upside down.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <numbers>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "kinecal/config/registry.hpp"
#include "kinecal/errors/base_motion.hpp"
#include "kinecal/explain/suspect.hpp"

namespace kinecal::detail {

/// The readings that error blocks of a base take, but for the time.
[[nodiscard]] inline std::set<std::string> drive_readings(const Config& config) {
  std::set<std::string> names;
  for (const StepConfig& step : config.steps) {
    for (const BlockConfig& block : step.error_blocks) {
      const BlockEntry* entry = is_base_type(block.type) ? entry_of(block) : nullptr;
      if (entry != nullptr) names.insert(entry->looks_before.begin(), entry->looks_before.end());
    }
  }
  names.erase("time");
  return names;
}

/// Multiplies readings of a sample, and of the one before it.
[[nodiscard]] inline std::function<void(Sample&)> multiplied(std::vector<std::string> names,
                                                             double factor) {
  return [names = std::move(names), factor](Sample& s) {
    for (std::map<std::string, double>* of : {&s.conditions, &s.before}) {
      for (const std::string& name : names) {
        if (const auto found = of->find(name); found != of->end()) found->second *= factor;
      }
    }
  };
}

/// Takes the full turns off what readings changed by.
[[nodiscard]] inline std::function<void(Sample&)> unwrapped(std::vector<std::string> names) {
  return [names = std::move(names)](Sample& s) {
    for (const std::string& name : names) {
      const auto now = s.conditions.find(name), before = s.before.find(name);
      if (now == s.conditions.end() || before == s.before.end()) continue;
      before->second =
          now->second - std::remainder(now->second - before->second, 2.0 * std::numbers::pi);
    }
  };
}

inline void add_drive_suspects(const Config& config, std::vector<Suspect>& all) {
  constexpr double kTurn = 2.0 * std::numbers::pi;
  const std::set<std::string> names = drive_readings(config);
  std::vector<std::string> wheels;
  for (const std::string& name : names) {
    if (name.ends_with("wheel")) wheels.push_back(name);
  }
  const auto quoted = [](const std::vector<std::string>& of) {
    return fmt::format("'{}'", fmt::join(of, "' and '"));
  };
  for (std::size_t a = 0; a < wheels.size(); ++a) {
    all.push_back({.undone = fmt::format("with '{}' negated: it is counted backwards", wheels[a]),
                   .correct = multiplied({wheels[a]}, -1.0),
                   .sign_of = wheels[a]});
    for (std::size_t b = a + 1; b < wheels.size(); ++b) {
      const std::string first = wheels[a], second = wheels[b];
      all.push_back({.undone = fmt::format("with '{}' and '{}' exchanged", first, second),
                     .correct = [first, second](Sample& s) {
                       for (std::map<std::string, double>* of : {&s.conditions, &s.before}) {
                         const auto one = of->find(first), other = of->find(second);
                         if (one != of->end() && other != of->end())
                           std::swap(one->second, other->second);
                       }
                     }});
    }
  }
  for (const char* name : {"gyro_yaw", "steering"}) {
    if (!names.contains(name)) continue;
    all.push_back({.undone = fmt::format("with '{}' negated: left is positive", name),
                   .correct = multiplied({name}, -1.0)});
  }
  std::vector<std::vector<std::string>> angles, lengths;
  if (!wheels.empty()) angles.push_back(wheels);
  for (const char* name : {"steering", "track_yaw", "odom_yaw", "gyro_yaw", "wall_angle"}) {
    if (names.contains(name)) angles.push_back({name});
  }
  for (const auto& of : angles) {
    all.push_back({.undone = fmt::format("with {} taken as degrees", quoted(of)),
                   .correct = multiplied(of, kTurn / 360.0)});
    if (of != wheels && of.front() != "odom_yaw" && of.front() != "gyro_yaw") continue;
    all.push_back({.undone = fmt::format("with {} unwrapped: they jump at full turns", quoted(of)),
                   .correct = unwrapped(of)});
  }
  if (!wheels.empty()) {
    all.push_back({.undone = fmt::format("with {} taken as turns", quoted(wheels)),
                   .correct = multiplied(wheels, kTurn)});
  }
  for (const auto& of :
       {std::vector<std::string>{"track_x", "track_y"}, {"odom_x", "odom_y"}, {"wall_distance"}}) {
    if (!names.contains(of.front())) continue;
    all.push_back({.undone = fmt::format("with {} taken as millimetres", quoted(of)),
                   .correct = multiplied(of, 1e-3)});
  }
}

}  // namespace kinecal::detail
