// The configuration of a base: definitions of initial_base.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/tools/init/initial_base.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <map>
#include <numbers>
#include <optional>

#include "kinecal/files/recordings/base_conditions.hpp"
#include "kinecal/files/urdf/visuals.hpp"
#include "kinecal/files/yaml/yaml_text.hpp"
#include "kinecal/kinematics/chain.hpp"
#include "kinecal/kinematics/forward_kinematics.hpp"
#include "kinecal/tools/init/proposed_columns.hpp"
#include "kinecal/tools/init/table_columns.ipp"

namespace kinecal {

namespace detail {
namespace {

using Names = std::vector<std::string>;

/// Conditions that a drive takes.
[[nodiscard]] Names conditions_of_drive(std::string_view drive) {
  if (drive == "odometry") return {"odom_x", "odom_y", "odom_yaw"};
  if (drive == "differential") return {"left_wheel", "right_wheel"};
  if (drive == "mecanum") {
    return {"front_left_wheel", "front_right_wheel", "rear_left_wheel", "rear_right_wheel"};
  }
  return {"wheel", "steering"};
}
[[nodiscard]] Names conditions_seen(std::string_view seen) {
  if (seen == "wall") return {"wall_angle", "wall_distance"};
  return {"track_x", "track_y", "track_yaw"};
}

/// Drives, what is seen and a gyroscope, of those that have their conditions.
/// @param has  whether there is such a condition
template <class Has>
[[nodiscard]] RecordedBase recorded(const Has& has) {
  const auto all = [&](const Names& names) { return std::all_of(names.begin(), names.end(), has); };
  RecordedBase base;
  for (const std::string_view drive : kBaseDrives) {
    if (all(conditions_of_drive(drive))) base.drives.emplace_back(drive);
  }
  for (const std::string_view seen : kBaseSeen) {
    if (all(conditions_seen(seen))) base.seen.emplace_back(seen);
  }
  base.has_gyro = all({"gyro_yaw", "time"});
  return base;
}

/// The condition of a sample, if it is a number.
[[nodiscard]] std::optional<double> number_in(const Sample& sample, const std::string& name) {
  const auto found = sample.conditions.find(name);
  if (found == sample.conditions.end() || !std::isfinite(found->second)) return std::nullopt;
  return found->second;
}
[[nodiscard]] bool has_some(std::span<const Sample> samples, const std::string& name) {
  return std::any_of(samples.begin(), samples.end(),
                     [&](const Sample& sample) { return number_in(sample, name).has_value(); });
}

/// How far a number goes within runs, in all: in each from its least to its largest, so that noise does not add up.
/// @param value  of a sample; nullopt if it has none
/// @param angle  true if it may jump by full turns
template <class Value>
[[nodiscard]] double way_of(std::span<const Sample> samples, const Value& value, bool angle) {
  double way = 0.0, run = 0.0, last = 0.0, at = 0.0, least = 0.0, most = 0.0;
  bool begins = true;
  for (const Sample& sample : samples) {
    const std::optional<double> now = value(sample);
    if (!now) continue;
    const double of = number_in(sample, std::string(kRun)).value_or(0.0);
    if (begins || of != run) {
      way += most - least;
      at = least = most = 0.0;
    } else {
      at += angle ? std::remainder(*now - last, 2.0 * std::numbers::pi) : *now - last;
      least = std::min(least, at);
      most = std::max(most, at);
    }
    begins = false;
    run = of;
    last = *now;
  }
  return way + most - least;
}

/// How far a base turned by any of these angles; nullopt if the samples have none.
[[nodiscard]] std::optional<double> turned(std::span<const Sample> samples) {
  std::optional<double> most;
  for (const char* name : {"odom_yaw", "track_yaw", "gyro_yaw"}) {
    if (!has_some(samples, name)) continue;
    const double way = way_of(
        samples, [&](const Sample& sample) { return number_in(sample, name); }, true);
    most = std::max(most.value_or(0.0), way);
  }
  return most;
}

/// How far a base went straight, metres: the lengths of stretches within which it hardly turned, less what a sensor beside
/// its axis moves by turning; nullopt if the samples do not have this pose.
/// @param pose  "odom" or "track"
[[nodiscard]] std::optional<double> went(std::span<const Sample> samples, const std::string& pose) {
  constexpr double kStraight = 0.3, kArm = 0.5;  // radians; metres of the sensor beside the axis
  double way = 0.0, longest = 0.0;
  const Sample* first = nullptr;
  for (const Sample& sample : samples) {
    const auto number = [&](const Sample& of, const char* axis) {
      return number_in(of, pose + axis);
    };
    if (!number(sample, "_x") || !number(sample, "_y") || !number(sample, "_yaw")) continue;
    const auto by = [&](const char* axis) { return *number(sample, axis) - *number(*first, axis); };
    const std::string run(kRun);
    const double turn =
        first == nullptr ? HUGE_VAL : std::abs(std::remainder(by("_yaw"), 2.0 * std::numbers::pi));
    if (!(turn < kStraight) || number_in(*first, run) != number_in(sample, run)) {
      way += longest;
      longest = 0.0;
      first = &sample;
    } else {
      longest = std::max(longest, std::hypot(by("_x"), by("_y")) - kArm * turn);
    }
  }
  return first == nullptr ? std::optional<double>() : way + longest;
}

/// How far what mecanum wheels roll takes a base to the side, over how far it goes in all.
[[nodiscard]] double part_to_the_side(std::span<const Sample> samples) {
  const auto rolled = [&](double fl, double fr, double rl, double rr) {
    return way_of(
        samples,
        [=](const Sample& sample) -> std::optional<double> {
          const auto a = number_in(sample, "front_left_wheel"),
                     b = number_in(sample, "front_right_wheel"),
                     c = number_in(sample, "rear_left_wheel"),
                     d = number_in(sample, "rear_right_wheel");
          if (!a || !b || !c || !d) return std::nullopt;
          return fl * *a + fr * *b + rl * *c + rr * *d;
        },
        false);
  };
  const double ahead = rolled(1, 1, 1, 1), left = rolled(-1, 1, 1, -1);
  return left > 0.0 ? left / std::max(left, ahead) : 0.0;
}

/// From the least to the largest of a condition; zero without it.
[[nodiscard]] double range_of(std::span<const Sample> samples, const std::string& name) {
  double least = HUGE_VAL, most = -HUGE_VAL;
  for (const Sample& sample : samples) {
    const std::optional<double> now = number_in(sample, name);
    if (now) least = std::min(least, *now);
    if (now) most = std::max(most, *now);
  }
  return std::max(0.0, most - least);
}

/// The radius of a link's first cylinder or sphere; zero if it has none.
[[nodiscard]] double radius_of(const std::string& link, const std::string& urdf_text) {
  for (const ShapeElement element : {ShapeElement::collision, ShapeElement::visual}) {
    Diagnostics skipped;
    for (const Visual& shape : visuals(urdf_text, "URDF", skipped, element)) {
      if (shape.link == link && shape.radius > 0.0) return shape.radius;
    }
  }
  return 0.0;
}

/// One line of the free parameters.
[[nodiscard]] std::string free_line(const std::string& name, const std::string& comment) {
  if (comment.empty()) return "- " + name + "\n";
  return fmt::format("- {:<28}# {}\n", name, comment);
}
[[nodiscard]] std::string held_line(const std::string& name, const std::string& why) {
  return "# held: " + name + ": " + why + "\n";
}

[[nodiscard]] std::string free_parameters_text(const BaseAnswers& of) {
  std::string text, held;
  const bool is_odometry = of.drive == "odometry";
  const auto add = [&](bool is_free, const char* name, const char* comment, const char* why) {
    if (is_free) text += free_line(name, comment);
    if (!is_free) held += held_line(name, why);
  };
  constexpr const char* kNoTurn = "the drive has no turns";
  constexpr const char* kNoRun = "the drive goes nowhere";
  if (of.drive == "tricycle") {
    add(of.turns, "base_wheelbase_scale", "the true wheelbase over the one below", kNoTurn);
    add(of.runs, "base_rollout_scale", "what a wheel rolls, over the radius below", kNoRun);
    text += free_line("base_steering_offset", "added to the steering angle, rad");
    add(of.steers, "base_steering_scale", "of the steering angle, true over reported",
        "it takes several steering angles");
  } else if (!of.drive.empty()) {
    add(of.turns, "base_track_width_scale",
        is_odometry ? "the true track width over that of the driver"
                    : "the true track width over the one below",
        kNoTurn);
    if (of.drive == "differential") {
      add(of.runs, "base_left_rollout_scale", "what a wheel rolls, over the radius below", kNoRun);
      add(of.runs, "base_right_rollout_scale", "", kNoRun);
    } else {
      add(of.runs, "base_rollout_scale",
          is_odometry ? "what a wheel rolls, true over nominal"
                      : "what a wheel rolls, over the radius below",
          kNoRun);
    }
    if (of.drive == "mecanum") {
      add(of.sideways, "base_lateral_scale",
          "what wheels roll to the side, over what they do ahead", "it takes drives to the side");
    }
  }
  if (of.drive.empty()) {
    // only the gyroscope
  } else if (of.seen == "pose" && of.turns && of.runs) {
    for (const char* axis : {"base_x", "base_y", "base_yaw"}) {
      text +=
          free_line(axis, std::string(axis) == "base_x" ? "where the sensor is on the base" : "");
    }
  } else {
    held += held_line("base_x, base_y, base_yaw",
                      of.seen == "wall" ? "a wall shows little of where the laser is on the base"
                                        : "it takes turns and straight runs");
  }
  if (of.has_gyro) {
    add(of.turns, "imu_scale", "the true rate over that of the gyroscope", kNoTurn);
    text += free_line("imu_bias", "added to its rate, rad/s");
  }
  return "free_params:\n" + text + held;
}

/// "  track_width: 0.375  # comment"; commented out if it is not known.
[[nodiscard]] std::string size_line(const char* key, double value, const char* comment) {
  const std::string after = *comment == 0 ? "" : std::string("   # ") + comment;
  if (value > 0.0) return fmt::format("  {}: {}{}\n", key, number_to_yaml(value), after);
  return fmt::format("  # {}:{}\n", key, after);
}

[[nodiscard]] std::string blocks_text(const BaseAnswers& of) {
  std::string text = "error_blocks:\n";
  if (!of.drive.empty()) {
    text += fmt::format("- name: base\n  type: {}_to_{}\n", of.drive, of.seen);
    if (of.drive == "odometry") {
      text += size_line("track_width", of.sizes.track_width,
                        "metres, of the driver: for odom in base_calibration.yaml");
    } else {
      text += size_line("wheel_radius", of.sizes.wheel_radius, "metres, nominal");
      if (of.drive != "tricycle") text += size_line("track_width", of.sizes.track_width, "");
      if (of.drive != "differential") text += size_line("wheelbase", of.sizes.wheelbase, "");
    }
    const std::array<double, 3> mount = of.mount.value_or(std::array<double, 3>{});
    const char* const sensor = of.seen == "wall" ? "laser" : "tracked sensor";
    const std::string from =
        of.mount ? of.mount_from
                 : fmt::format("not known: measure it{}", of.seen == "wall" ? "" : ", roughly");
    text += fmt::format("  x: {}   # of the {} on {}, metres: {}\n  y: {}\n  yaw: {}   # radians\n",
                        number_to_yaml(mount[0]), sensor, of.base_link, from,
                        number_to_yaml(mount[1]), number_to_yaml(mount[2]));
    text +=
        "  translation_scale: 500.0   # 1 over the standard deviation of what was seen: 2 mm\n"
        "  rotation_scale: 500.0      # 2 mrad\n";
  }
  if (of.has_gyro) {
    text += fmt::format("- name: imu\n  type: gyro_to_{}\n", of.seen);
    text +=
        size_line("gyro_scale", of.gyro_scale, "of the driver: for imu in base_calibration.yaml");
  }
  return text;
}

/// Rejects an angle that does not count turns.
void check_column(const TableColumn& column, const std::string& condition,
                  const std::string& file) {
  if (condition != "odom_yaw" && condition != "gyro_yaw") return;
  const bool is_degrees = column.unit == NamedUnit::degrees;
  const double turn = is_degrees ? 360.0 : 2.0 * std::numbers::pi;
  const auto [least, most] = std::minmax_element(column.values.begin(), column.values.end());
  if (column.values.empty() || *most - *least > 1.1 * turn) return;  // it counts turns, or degrees
  for (std::size_t i = 1; i < column.values.size(); ++i) {
    const double by = column.values[i] - column.values[i - 1];
    if (!(std::abs(std::abs(by) - turn) < 0.1 * turn)) continue;
    throw InputError(
        fmt::format("{}: column '{}' jumps by a full turn in row {}; {} counts turns: "
                    "unwrap it",
                    file, column.name, i + 1, condition));
  }
}

/// The first cell of a column that is not empty.
[[nodiscard]] std::string first_text(const TableColumn& column) {
  const auto found = std::find_if(column.texts.begin(), column.texts.end(),
                                  [](const std::string& text) { return !text.empty(); });
  return found == column.texts.end() ? "" : *found;
}

/// A column, with its unit if it is none of a condition.
[[nodiscard]] std::string column_text(const TableColumn& column) {
  const std::string name = name_to_yaml(column.name);
  if (column.unit == NamedUnit::degrees) return "{column: " + name + ", unit: degrees}";
  if (column.unit == NamedUnit::millimetres) return "{column: " + name + ", unit: millimetres}";
  return name;
}

}  // namespace
}  // namespace detail

RecordedBase recorded_base(std::span<const Sample> samples) {
  const auto has = [&](const std::string& name) {
    return std::any_of(samples.begin(), samples.end(), [&](const Sample& sample) {
      const auto found = sample.conditions.find(name);
      return found != sample.conditions.end() && std::isfinite(found->second);
    });
  };
  RecordedBase base = detail::recorded(has);
  constexpr double kTurn = 1.0, kStraight = 0.3, kSide = 0.1, kSteers = 0.3;  // radians, metres
  base.turns = detail::turned(samples).value_or(HUGE_VAL) > kTurn;
  const auto by_odometry = detail::went(samples, "odom"), by_track = detail::went(samples, "track");
  base.runs = (!by_odometry && !by_track) ||
              std::max(by_odometry.value_or(0.0), by_track.value_or(0.0)) > kStraight;
  base.sideways = detail::part_to_the_side(samples) > kSide;
  base.steers = detail::range_of(samples, "steering") > kSteers;
  return base;
}

std::string base_link_of(const Robot& robot, const std::vector<std::string>& names) {
  for (const std::string& link : names) {
    if (!link.empty() && robot.has_link(link)) return link;
  }
  if (robot.has_link("base_link")) return "base_link";
  for (const std::string& link : robot.link_names()) {
    if (robot.parent_joint(link) == nullptr) return link;
  }
  return "base_link";
}

BaseSizes sizes_of_urdf(const Robot& robot, const std::string& urdf_text,
                        const std::string& base_link, std::string_view drive) {
  std::map<std::string, const Joint*> wheels;  // by condition
  for (const Joint& joint : robot.joints()) {
    const std::string wheel = turns(joint.type) ? wheel_condition(joint.name) : "";
    if (!wheel.empty()) wheels.emplace(wheel, &joint);
  }
  const auto place = [&](const char* wheel) -> std::optional<Vector3<double>> {
    const auto found = wheels.find(wheel);
    if (found == wheels.end()) return std::nullopt;
    try {
      return forward_kinematics(make_chain(robot, base_link, found->second->child),
                                [](const std::string&) { return 0.0; })
          .translation;
    } catch (const RobotError&) {
      return std::nullopt;  // not on this base
    }
  };
  const auto apart = [&](const char* a, const char* b) {
    const auto at = place(a), other = place(b);
    return at && other ? (*at - *other).head<2>().norm() : 0.0;
  };
  BaseSizes sizes;
  const bool is_four = wheels.count("front_left_wheel") > 0;
  const bool is_tricycle = drive == "tricycle";
  sizes.track_width =
      is_four ? apart("front_left_wheel", "front_right_wheel") : apart("left_wheel", "right_wheel");
  if (is_four) sizes.wheelbase = apart("front_left_wheel", "rear_left_wheel");
  if (is_tricycle) {  // the base is the middle of the axle
    const auto steering = place("steering");
    sizes.wheelbase = steering ? std::abs(steering->x()) : 0.0;
  }
  for (const char* wheel : {is_tricycle ? "wheel" : is_four ? "front_left_wheel" : "left_wheel"}) {
    const auto found = wheels.find(wheel);
    if (found != wheels.end())
      sizes.wheel_radius = detail::radius_of(found->second->child, urdf_text);
  }
  const auto rounded = [](double metres) { return std::round(1e6 * metres) / 1e6; };
  return {rounded(sizes.wheel_radius), rounded(sizes.track_width), rounded(sizes.wheelbase)};
}

std::string initial_base(const BaseAnswers& answers) {
  return fmt::format(
      "# A mobile base, calibrated by what is seen from it: MANUAL.md, \"A mobile base\".\n"
      "base_link: {}\nmodels: []\n{}{}",
      detail::name_to_yaml(answers.base_link), detail::free_parameters_text(answers),
      detail::blocks_text(answers));
}

std::string base_columns(std::string_view text, const std::string& file) {
  using namespace detail;
  const ReadTable table = read_table(text, file);
  std::map<std::string, std::string> columns;  // by condition
  std::vector<std::string> unused;
  for (std::size_t c = 0; c < table.columns.size(); ++c) {
    const TableColumn& column = table.columns[c];
    const std::string named = column.per_second ? "" : base_condition(column.name);
    if (named == kRun && !column.is_number) {
      throw InputError(fmt::format("{}: column '{}' has words, such as '{}': number the runs", file,
                                   column.name, first_text(column)));
    }
    const std::string condition = column.is_number ? named : "";
    if (condition.empty() || !columns.emplace(condition, column_text(column)).second) {
      unused.push_back(column.name);
    } else {
      check_column(column, condition, file);
    }
  }
  const RecordedBase has =
      recorded([&](const std::string& name) { return columns.count(name) > 0; });
  if ((has.drives.empty() && !has.has_gyro) || has.seen.empty()) {
    throw InputError(fmt::format(
        "{}: no columns of {}; name them as the conditions of MANUAL.md, \"A mobile "
        "base\", such as "
        "{} (of a table whose rows are intervals, under increments: in a columns.yaml); {}",
        file, has.seen.empty() ? "what shows how the base moved" : "a drive",
        has.seen.empty() ? "track_x, track_y, track_yaw or wall_angle, wall_distance"
                         : "left_wheel, right_wheel or odom_x, odom_y, odom_yaw",
        table.header ? table.header_text : "it has no header"));
  }
  std::string conditions;
  for (const auto& [condition, column] : columns) {
    conditions += fmt::format("  {}: {}\n", condition, column);
  }
  const std::map<char, const char*> separators = {
      {',', "comma"}, {';', "semicolon"}, {'\t', "tab"}, {' ', "space"}};
  return fmt::format(
      "{} by the table's header: check it.\n"
      "# Angles are radians, lengths metres; wheels may also count ticks, with wheel_radius in "
      "metres "
      "a tick.\n"
      "separator: {}\nheader: {}\nconditions:\n{}{}",
      kProposedColumnsMark, separators.at(table.separator), table.header, conditions,
      unused.empty() ? "" : fmt::format("\n# Not used: {}\n", fmt::join(unused, ", ")));
}

}  // namespace kinecal
