// Which columns of a table are a measured point: for proposed_columns.cpp.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <set>
#include <string>
#include <vector>

#include "kinecal/files/diagnostics.hpp"
#include "kinecal/tools/init/table_columns.ipp"

namespace kinecal::detail {

/// Three columns that are a point: indices of x, y and z.
struct PointColumns {
  std::string rest;  ///< of their names
  std::array<int, 3> xyz = {-1, -1, -1};
  std::array<int, 3> deviation = {-1, -1, -1};  ///< to add
};

[[nodiscard]] inline bool has_word(const TableColumn& column, const std::set<std::string>& words) {
  return std::any_of(column.words.begin(), column.words.end(),
                     [&](const std::string& word) { return words.contains(word); });
}

/// Complete triples of columns x, y, z that are not taken, in their order; not those of rotations.
[[nodiscard]] inline std::vector<PointColumns> triples(const ReadTable& table,
                                                       const std::set<int>& taken) {
  std::vector<PointColumns> all;
  for (int c = 0; c < static_cast<int>(table.columns.size()); ++c) {
    const TableColumn& column = table.columns[static_cast<std::size_t>(c)];
    if (taken.contains(c) || !column.is_number) continue;
    std::vector<std::string> words = column.words;
    const auto axis = std::find_if(words.rbegin(), words.rend(), [](const std::string& word) {
      return !word.empty() && word.find_first_not_of("0123456789") == 0 &&
             std::string_view("xyz").find(word.back()) != std::string_view::npos &&
             (word.size() == 1 || word.size() == 2);
    });
    if (axis == words.rend()) continue;
    const auto which = std::string_view("xyz").find(axis->back());
    axis->pop_back();  // "dx" is the x of d
    const std::string rest = fmt::format("{}", fmt::join(words, " "));
    auto triple = std::find_if(all.begin(), all.end(),
                               [&](const PointColumns& known) { return known.rest == rest; });
    if (triple == all.end()) triple = all.insert(all.end(), {rest});
    triple->xyz[which] = c;
  }
  std::erase_if(all, [&](const PointColumns& triple) {
    const bool whole =
        std::all_of(triple.xyz.begin(), triple.xyz.end(), [](int c) { return c >= 0; });
    const std::vector<std::string> words = words_of(triple.rest);
    return !whole || std::any_of(words.begin(), words.end(), [](const std::string& word) {
      return std::set<std::string>{"r", "rot", "q", "w",        "quat",  "orientation", "n",
                                   "v", "f",   "t", "velocity", "force", "torque",      "accel"}
          .contains(word);
    });
  });
  return all;
}

/// The measured points of a row; deviations are added to them.
/// @throws InputError  if columns do not tell them
[[nodiscard]] inline std::vector<PointColumns> measured_points(const ReadTable& table,
                                                               const std::set<int>& taken,
                                                               const std::string& file) {
  const std::set<std::string> deviations = {"d",   "dif",       "diff", "delta",
                                            "dev", "deviation", "err",  "error"},
                              computed = {"tcp",       "tool",    "flange",  "fk",  "ee",
                                          "base",      "robot",   "nominal", "cmd", "command",
                                          "commanded", "desired", "actual"};
  std::vector<PointColumns> points = triples(table, taken), added;
  const auto is = [&](const PointColumns& point, const std::set<std::string>& words) {
    return has_word({.name = "", .words = words_of(point.rest)}, words);
  };
  for (const PointColumns& point : points) {
    if (is(point, deviations)) added.push_back(point);
  }
  std::erase_if(points, [&](const PointColumns& point) { return is(point, deviations); });
  if (points.size() > 1) {
    std::erase_if(points, [&](const PointColumns& point) { return is(point, computed); });
  }
  if (points.empty()) {
    throw InputError(
        file +
        ": no three columns are called x, y, z (of a tracker's point); say in columns.yaml "
        "what its columns mean: MANUAL, Samples from a table");
  }
  // Several: numbered points of one name.
  const auto name = [](const PointColumns& point) {
    std::vector<std::string> words = words_of(point.rest);
    std::erase_if(words, [](const std::string& word) {
      return word.find_first_not_of("0123456789") == std::string::npos;
    });
    return fmt::format("{}", fmt::join(words, " "));
  };
  for (const PointColumns& point : points) {
    if (name(point) == name(points.front())) continue;
    const auto of = [&](const PointColumns& p) {
      return table.columns[static_cast<std::size_t>(p.xyz[0])].name;
    };
    throw InputError(
        fmt::format("{}: both '{}' and '{}' may begin the point that was measured; say in "
                    "columns.yaml which it "
                    "is: MANUAL, Samples from a table",
                    file, of(points.front()), of(point)));
  }
  if (points.size() == 1 && added.size() == 1) points.front().deviation = added.front().xyz;
  return points;
}

/// The same of a table without a header: the three columns after the joints.
[[nodiscard]] inline PointColumns last_three(const ReadTable& table) {
  const int n = static_cast<int>(table.columns.size());
  return {"", {n - 3, n - 2, n - 1}};
}

}  // namespace kinecal::detail
