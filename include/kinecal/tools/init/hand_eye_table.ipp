// A table of poses, corners or points of a hand-eye calibration: for hand_eye_columns.ipp.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <string>
#include <vector>

#include "kinecal/files/poses/pose_table.hpp"
#include "kinecal/files/yaml/yaml_text.hpp"
#include "kinecal/tools/init/table_columns.ipp"

namespace kinecal::detail {

/// A table whose columns are found by some of the names that programs give them.
class HandEyeTable {
 public:
  using Names = std::vector<std::string>;

  explicit HandEyeTable(const std::string& file)
      : file_(file), table_(read_table(read_pose_table(file), file)) {}

  [[nodiscard]] const std::string& file() const { return file_; }
  [[nodiscard]] bool has_header() const { return table_.header; }
  [[nodiscard]] const char* separator() const {
    static const std::map<char, const char*> names = {
        {',', "comma"}, {';', "semicolon"}, {'\t', "tab"}, {' ', "space"}};
    return names.at(table_.separator);
  }
  [[nodiscard]] const std::vector<TableColumn>& columns() const { return table_.columns; }

  /// The columns of one of several lists of names, small letters and digits only; empty if there are
  /// none.
  [[nodiscard]] std::vector<int> find_any(const std::vector<Names>& lists) const {
    for (const Names& names : lists) {
      std::vector<int> found;
      for (const std::string& name : names) {
        const auto is_it = [&](const TableColumn& column) {
          return fmt::format("{}", fmt::join(column.words, "")) == name;
        };
        const auto at = std::find_if(columns().begin(), columns().end(), is_it);
        if (at != columns().end()) found.push_back(static_cast<int>(at - columns().begin()));
      }
      if (found.size() == names.size()) return found;
    }
    return {};
  }
  /// The same.
  /// @throws InputError  if they are missing
  [[nodiscard]] std::vector<int> find(const std::vector<Names>& lists,
                                      const std::string& what) const {
    std::vector<int> found = find_any(lists);
    if (!found.empty()) return found;
    throw InputError(fmt::format("{}: has no columns {}; the table has {}", file_, what,
                                 fmt::join(all_names(), ", ")));
  }

  /// Columns as columns.yaml names them.
  [[nodiscard]] Names names(const std::vector<int>& indices) const {
    Names names;
    for (const int i : indices) {
      names.push_back(name_to_yaml(columns()[static_cast<std::size_t>(i)].name));
    }
    return names;
  }
  [[nodiscard]] Names all_names() const {
    Names names;
    for (const TableColumn& column : columns()) names.push_back(column.name);
    return names;
  }

  [[nodiscard]] double largest(const std::vector<int>& indices) const {
    double largest = 0.0;
    for (const int i : indices) {
      largest = std::max(largest, columns()[static_cast<std::size_t>(i)].largest);
    }
    return largest;
  }
  [[nodiscard]] NamedUnit unit(const std::vector<int>& indices) const {
    return columns()[static_cast<std::size_t>(indices.front())].unit;
  }
  /// True for lengths in millimetres, by the names or the values.
  [[nodiscard]] bool is_millimetres(const std::vector<int>& indices) const {
    constexpr double kMostMetres = 20.0;
    const NamedUnit named = unit(indices);
    return named == NamedUnit::millimetres ||
           (named != NamedUnit::metres && largest(indices) > kMostMetres);
  }

 private:
  std::string file_;
  ReadTable table_;
};

}  // namespace kinecal::detail
