// Definitions of led_commands.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/tools/detect/led_commands.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <limits>

#include "kinecal/files/csv/csv_columns.hpp"
#include "kinecal/files/csv/csv_table.hpp"
#include "kinecal/files/messages/message_fields.hpp"
#include "kinecal/files/text_file.hpp"

namespace kinecal {

namespace {

[[nodiscard]] bool is_code(double number) {
  constexpr double kMost = 65535.0;
  return number >= 0.0 && number <= kMost && number == std::floor(number);
}

}  // namespace

bool is_led_table(const std::string& given) {
  const std::string ending = std::filesystem::path(given).extension().string();
  return ending == ".csv" || ending == ".tsv" || ending == ".txt";
}

bool switches_leds(const BagTopic& topic, const std::string& given) {
  if (is_led_table(given)) return false;
  if (!given.empty()) return topic.name == given;
  return topic.type == "robot_calibration_msgs/GripperLedCommandActionGoal";
}

std::optional<int> led_code(const MessageFields& message) {
  for (const char* path : {"goal.led_code", "led_code", "data"}) {
    const MessageValue* found = detail::field_at(message, path);
    double code = std::numeric_limits<double>::quiet_NaN();
    if (found != nullptr) found->visit_number([&](auto x) { code = static_cast<double>(x); });
    if (is_code(code)) return static_cast<int>(code);
  }
  return std::nullopt;
}

std::vector<LedCommand> read_led_table(const std::string& path, Diagnostics& diagnostics) {
  const std::string text = detail::read_text_file(path);
  const detail::CsvTable table = detail::csv_table(text, detail::csv_separator(text),
                                                   detail::CsvHeader::present, path, diagnostics);
  const auto column = [&](const char* name) {
    const auto& names = table.header.cells;
    const auto at = std::find(names.begin(), names.end(), name);
    if (at == names.end()) {
      throw InputError(fmt::format("{}: has no column '{}'; LEDs take columns time, code; {}", path,
                                   name, table.header_text()));
    }
    return static_cast<std::size_t>(at - names.begin());
  };
  const std::size_t time = column("time"), code = column("code");
  std::vector<LedCommand> commands;
  for (const detail::CsvRow& row : table.rows) {
    const auto number = [&](std::size_t c) {
      return c < row.cells.size() ? detail::csv_number(row.cells[c]) : std::nullopt;
    };
    const auto at = number(time), lit = number(code);
    if (!at || !lit || !(std::abs(*at) < 9e9) || !is_code(*lit)) {
      diagnostics.error({path, row.line},
                        "time and code of LEDs are a number of seconds and 0, 1, 2 ... 65535");
      continue;
    }
    commands.push_back({Stamp(std::llround(1e9 * *at)), static_cast<int>(*lit)});
  }
  std::stable_sort(commands.begin(), commands.end(),
                   [](const LedCommand& a, const LedCommand& b) { return a.time < b.time; });
  return commands;
}

std::vector<LedSpan> led_spans(const std::vector<LedCommand>& commands, const Standstill& time,
                               Stamp settle) {
  std::vector<LedSpan> spans;
  const auto add = [&](int code, Stamp begin, Stamp end) {
    const LedSpan span{code, {std::max(begin, time.begin), std::min(end, time.end)}};
    if (span.time.begin >= span.time.end) return;
    if (!spans.empty() && spans.back().code == code &&
        spans.back().time.end >= span.time.begin - settle) {
      spans.back().time.end = span.time.end;  // switched to what it was
    } else {
      spans.push_back(span);
    }
  };
  if (commands.empty()) return spans;
  const bool is_dark_later = std::any_of(commands.begin(), commands.end(),
                                         [](const LedCommand& of) { return of.code == 0; });
  if (!is_dark_later) add(0, time.begin, commands.front().time);
  for (std::size_t i = 0; i < commands.size(); ++i) {
    add(commands[i].code, commands[i].time + settle,
        i + 1 < commands.size() ? commands[i + 1].time : time.end);
  }
  return spans;
}

}  // namespace kinecal
