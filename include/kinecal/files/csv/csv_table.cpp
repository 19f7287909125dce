// Definitions of csv_table.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/files/csv/csv_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include "kinecal/files/csv/csv_columns.hpp"
#include "kinecal/files/csv/csv_units.hpp"
#include "kinecal/text/printable.hpp"

namespace kinecal::detail {

/// Splits a text into rows.
class CsvReader {
 public:
  CsvReader(std::string_view text, char separator, std::string file, Diagnostics& diagnostics)
      : text_(text), separator_(separator), file_(std::move(file)), diagnostics_(diagnostics) {
    if (text_.starts_with("\xef\xbb\xbf")) text_.remove_prefix(3);
  }

  [[nodiscard]] std::vector<CsvRow> rows() {
    std::vector<CsvRow> all;
    while (at_ < text_.size()) {
      CsvRow row = next_row();
      // Spreadsheets append rows of separators.
      const bool is_empty = std::all_of(row.cells.begin(), row.cells.end(),
                                        [](const std::string& cell) { return cell.empty(); });
      if (!is_empty) all.push_back(std::move(row));
    }
    return all;
  }

 private:
  [[nodiscard]] bool at_line_end() const {
    return at_ >= text_.size() || text_[at_] == '\n' || text_[at_] == '\r';
  }
  void pass_line_end() {
    if (at_ >= text_.size()) return;
    at_ += text_.substr(at_).starts_with("\r\n") ? 2 : 1;
    ++line_;
  }
  [[nodiscard]] bool is_blank(char c) const {
    return c == ' ' || (c == '\t' && separator_ != '\t');
  }
  void pass_blanks() {
    while (at_ < text_.size() && is_blank(text_[at_])) ++at_;
  }

  CsvRow next_row() {
    CsvRow row{{}, line_};
    pass_blanks();
    const std::string_view rest = text_.substr(at_);
    row.is_comment = rest.starts_with('#') || rest.starts_with('%') || rest.starts_with("//");
    for (; !(separator_ == ' ' && at_line_end()); pass_blanks()) {
      row.cells.push_back(row.is_comment ? plain_cell() : next_cell());
      pass_blanks();
      if (at_line_end()) break;
      if (separator_ != ' ') ++at_;
    }
    pass_line_end();
    return row;
  }

  std::string next_cell() {
    return at_ < text_.size() && text_[at_] == '"' ? quoted_cell() : plain_cell();
  }

  std::string plain_cell() {
    const std::size_t begin = at_;
    while (!at_line_end() && text_[at_] != separator_ &&
           !(separator_ == ' ' && text_[at_] == '\t')) {
      ++at_;
    }
    std::size_t end = at_;
    while (end > begin && is_blank(text_[end - 1])) --end;
    return std::string(text_.substr(begin, end - begin));
  }

  std::string quoted_cell() {
    const int begin = line_;
    std::string cell;
    for (++at_; at_ < text_.size(); ++at_) {
      if (text_[at_] == '"') {
        if (at_ + 1 >= text_.size() || text_[at_ + 1] != '"') break;
        ++at_;
      }
      const bool is_dos = text_[at_] == '\r' && at_ + 1 < text_.size() && text_[at_ + 1] == '\n';
      if (text_[at_] == '\n' || (text_[at_] == '\r' && !is_dos)) ++line_;
      cell += text_[at_];
    }
    if (at_ >= text_.size()) {
      diagnostics_.error({file_, begin}, "a quoted cell begins here and does not end");
      return cell;
    }
    ++at_;
    pass_blanks();
    if (!at_line_end() && separator_ != ' ' && text_[at_] != separator_) {
      diagnostics_.error({file_, line_}, "text follows a quoted cell; separate the two");
      while (!at_line_end() && text_[at_] != separator_) ++at_;
    }
    return cell;
  }

  std::string_view text_;
  char separator_;
  std::string file_;
  Diagnostics& diagnostics_;
  std::size_t at_ = 0;
  int line_ = 1;
};

std::vector<CsvRow> csv_rows(std::string_view text, char separator, const std::string& file,
                             Diagnostics& diagnostics) {
  return CsvReader(text, separator, file, diagnostics).rows();
}

namespace {

/// The number in a cell, if it is one and not missing.
/// @param comma  as a decimal point
[[nodiscard]] bool is_number(std::string cell, bool comma) {
  const std::size_t at = cell.find(',');
  if (comma && at != std::string::npos) cell[at] = '.';
  const std::optional<double> number = csv_number(cell);
  return number && !std::isnan(*number);
}

/// The cells of a comment that may name `width` columns: without its mark and quotes.
[[nodiscard]] CsvRow without_mark(CsvRow row, std::size_t width) {
  std::string& first = row.cells.front();
  const std::string name = first.substr(std::min(first.size(), first.find_first_not_of("#%/ \t")));
  if (!name.empty()) first = name;
  if (name.empty() && row.cells.size() == width + 1) row.cells.erase(row.cells.begin());
  for (std::string& cell : row.cells) {
    if (cell.size() > 1 && cell.front() == '"' && cell.back() == '"')
      cell = cell.substr(1, cell.size() - 2);
  }
  return row;
}

/// What is above the numbers of a table, and the numbers.
class CsvLayout {
 public:
  CsvLayout(std::vector<CsvRow> rows, char separator)
      : rows_(std::move(rows)), separator_(separator) {
    const auto marked = [](const CsvRow& row) { return row.is_comment; };
    if (std::all_of(rows_.begin(), rows_.end(), marked)) {  // what all rows have is no comment
      for (CsvRow& row : rows_) row.is_comment = false;
    }
    std::map<std::size_t, std::size_t> counts;
    std::size_t most = 0;
    for (const CsvRow& row : rows_) {
      if (row.is_comment || ++counts[row.cells.size()] < most) continue;
      most = counts[row.cells.size()];
      width_ = row.cells.size();
    }
    const auto first = [&](std::size_t per_number) {
      std::size_t i = 0;
      while (i < rows_.size() &&
             (rows_[i].is_comment || !is_data(rows_[i], per_number) || are_names_below(i)))
        ++i;
      return i;
    };
    begin_ = first(2);
    if (begin_ == rows_.size()) begin_ = first(width_);
    // Without any numbers, the first row is the header: each cell below it is an error.
    if (begin_ == rows_.size()) begin_ = rows_.empty() ? 0 : 1;
  }

  /// Numbers in rows that have as many cells as most.
  [[nodiscard]] std::size_t numbers() const {
    std::size_t all = 0;
    for (std::size_t i = begin_; i < rows_.size(); ++i) {
      if (!rows_[i].is_comment && rows_[i].cells.size() == width_) all += numbers(rows_[i]);
    }
    return all;
  }

  [[nodiscard]] std::size_t width() const { return width_; }

  [[nodiscard]] CsvTable table(CsvHeader header, const std::string& file,
                               Diagnostics& diagnostics) {
    CsvTable table;
    std::size_t below = 0;  // the first row below the header
    if (header != CsvHeader::absent) below = take_header(table);
    if (header == CsvHeader::present && table.header.cells.empty()) {
      const auto plain = std::find_if(rows_.begin(), rows_.end(),
                                      [](const CsvRow& row) { return !row.is_comment; });
      if (plain != rows_.end())
        table.header = *plain, below = static_cast<std::size_t>(plain - rows_.begin()) + 1;
    }
    for (std::size_t i = below; i < rows_.size(); ++i) {
      CsvRow& row = rows_[i];
      if (row.is_comment) {
        if (!is_data(without_mark(row, width_), 2) || i < begin_) continue;
        diagnostics.warning({file, row.line}, "the row is commented out and left out");
      } else if (i >= begin_ ||
                 (row.line != table.units.line && (!table.header.cells.empty() || is_row(row)))) {
        table.rows.push_back(std::move(row));
      }
    }
    table.columns = table.header.cells.size();
    for (const CsvRow& row : table.rows) {
      if (table.header.cells.empty()) table.columns = std::max(table.columns, row.cells.size());
    }
    if (separator_ != ',') read_decimal_commas(table.rows);
    return table;
  }

 private:
  [[nodiscard]] std::size_t numbers(const CsvRow& row) const {
    return static_cast<std::size_t>(
        std::count_if(row.cells.begin(), row.cells.end(),
                      [&](const std::string& cell) { return is_number(cell, separator_ != ','); }));
  }
  /// True for what above the numbers is a row of a table without names rather than a title.
  [[nodiscard]] bool is_row(const CsvRow& row) const {
    return row.cells.size() == width_ || (row.cells.size() > 1 && numbers(row) == row.cells.size());
  }
  /// True if names follow shortly, so that numbers are above the header: of bodies or markers.
  [[nodiscard]] bool are_names_below(std::size_t i) const {
    constexpr std::size_t kRows = 3;
    const auto is_name = [](const std::string& cell) { return !csv_number(cell); };
    for (std::size_t below = i + 1; below < rows_.size() && below <= i + kRows; ++below) {
      const CsvRow& row = rows_[below];
      const auto names =
          static_cast<std::size_t>(std::count_if(row.cells.begin(), row.cells.end(), is_name));
      if (!row.is_comment && row.cells.size() == width_ && names == width_ && numbers(row) == 0)
        return true;
    }
    return false;
  }
  /// True for a row of the usual number of cells, of which one in `per_number` is a number.
  [[nodiscard]] bool is_data(const CsvRow& row, std::size_t per_number) const {
    const auto filled = static_cast<std::size_t>(std::count_if(
        row.cells.begin(), row.cells.end(), [](const std::string& cell) { return !cell.empty(); }));
    const std::size_t found = numbers(row);
    return row.cells.size() == width_ && found > 0 && per_number * found >= filled &&
           !(&row == rows_.data() && counts_columns(row));
  }

  /// True for a header such as image, 1, 2, 3.
  [[nodiscard]] static bool counts_columns(const CsvRow& row) {
    double next = -1.0;
    bool has_name = false;
    std::size_t count = 0;
    for (const std::string& cell : row.cells) {
      const std::optional<double> number = csv_number(cell);
      has_name = has_name || !number;
      if (!number) continue;
      if (next < 0.0 ? *number != 0.0 && *number != 1.0 : *number != next) return false;
      next = *number + 1.0;
      ++count;
    }
    constexpr std::size_t kLeast = 3;
    return has_name && count >= kLeast;
  }

  /// Names in each cell, each once.
  [[nodiscard]] static bool names_all(const CsvRow& row) {
    const std::set<std::string> names(row.cells.begin(), row.cells.end());
    return names.size() == row.cells.size() && !names.contains("");
  }

  /// Takes the names above the numbers: the first row that names every column; else the last one of names; else, of
  /// comments, the last with as many names as there are columns.
  /// @return  the first row below it; 0 without one
  std::size_t take_header(CsvTable& table) {
    std::vector<std::size_t> plain, comments;
    for (std::size_t i = 0; i < begin_; ++i) {
      const CsvRow row = rows_[i].is_comment ? without_mark(rows_[i], width_) : rows_[i];
      if (row.cells.size() == width_ && are_units(row.cells) &&
          !(plain.empty() && comments.empty())) {
        table.units = row;
      } else if (!row.is_comment) {
        plain.push_back(i);
      } else if (row.cells.size() == width_) {
        comments.push_back(i);
      }
    }
    if (plain.empty()) {
      if (comments.empty()) return 0;
      table.header = without_mark(rows_[comments.back()], width_);
      return begin_;
    }
    const auto names = [&](std::size_t i) {
      return rows_[i].cells.size() == width_ && numbers(rows_[i]) == 0;
    };
    const auto whole = std::find_if(plain.begin(), plain.end(),
                                    [&](std::size_t i) { return names(i) && names_all(rows_[i]); });
    const auto last = std::find_if(plain.rbegin(), plain.rend(), names);
    const std::size_t at = whole != plain.end()   ? *whole
                           : last != plain.rend() ? *last
                                                  : plain.back();
    table.header = rows_[at];
    for (std::size_t above = at; above-- > 0 && !names_all(table.header);)
      add_groups(rows_[above], table.header);
    return at + 1;
  }

  /// Puts the name of its group before each name that several columns have: "Position", "X" -> "Position X".
  static void add_groups(const CsvRow& groups, CsvRow& header) {
    const bool has_ids =
        std::find(groups.cells.begin(), groups.cells.end(), "ID") != groups.cells.end();
    if (groups.is_comment || has_ids) return;  // of Motive: names are above them
    const std::vector<std::string> names = header.cells;
    std::map<std::string_view, int> columns;  // that have a name
    for (const std::string& name : names) ++columns[name];
    std::string group;
    for (std::size_t c = 0; c < names.size() && c < groups.cells.size(); ++c) {
      if (!groups.cells[c].empty()) group = groups.cells[c];
      if (columns[names[c]] > 1 && !group.empty())
        header.cells[c] = group + (names[c].empty() ? "" : " ") + names[c];
    }
  }

  /// A number such as 1,234: of a thousand, or with a decimal comma.
  [[nodiscard]] static bool may_be_thousands(std::string_view cell) {
    if (cell.starts_with('-') || cell.starts_with('+')) cell.remove_prefix(1);
    const std::size_t at = cell.find(',');
    return at <= 3 && at > 0 && cell.size() == at + 4 && cell.front() != '0';
  }

  /// Replaces decimal commas by points, except in columns that have both; without semicolons, also except where
  /// all may separate thousands.
  void read_decimal_commas(std::vector<CsvRow>& rows) const {
    std::map<std::size_t, std::vector<std::string*>> with_comma;  // by column
    std::set<std::size_t> with_point;
    bool is_clear = separator_ == ';';
    for (CsvRow& row : rows) {
      for (std::size_t c = 0; c < row.cells.size(); ++c) {
        std::string& cell = row.cells[c];
        if (cell.find(',') == std::string::npos) {
          if (cell.find('.') != std::string::npos && is_number(cell, false)) with_point.insert(c);
        } else if (is_number(cell, true)) {
          with_comma[c].push_back(&cell);
          is_clear = is_clear || !may_be_thousands(cell);
        }
      }
    }
    for (const auto& [column, cells] : with_comma) {
      if (!is_clear || with_point.contains(column)) continue;
      for (std::string* cell : cells) (*cell)[cell->find(',')] = '.';
    }
  }

  std::vector<CsvRow> rows_;
  char separator_;
  std::size_t width_ = 0;  ///< cells of most rows
  std::size_t begin_ = 0;  ///< the first row of numbers
};

}  // namespace

std::string CsvTable::header_text() const {
  constexpr std::size_t kMost = 200;
  std::string names = fmt::format("{}", fmt::join(header.cells, ", "));
  if (names.size() > kMost) names = names.substr(0, kMost) + " ...";
  return header.cells.empty()
             ? "no header was found"
             : fmt::format("line {} was read as the header: '{}'", header.line, printable(names));
}

CsvTable csv_table(std::string_view text, char separator, CsvHeader header, const std::string& file,
                   Diagnostics& diagnostics) {
  return CsvLayout(csv_rows(text, separator, file, diagnostics), separator)
      .table(header, file, diagnostics);
}

char csv_separator(std::string_view text) {
  char best = ',';
  std::size_t most = 0, width = 0;  // of those that are alike, the one without other cells: 0,5;0,7
  for (const char separator : {',', ';', '\t', ' '}) {
    Diagnostics ignored;
    std::vector<CsvRow> rows = csv_rows(text, separator, "", ignored);
    if (!ignored.errors.empty()) continue;
    const CsvLayout layout(std::move(rows), separator);
    const std::size_t numbers = layout.numbers();
    if (numbers < most || numbers == 0 || (numbers == most && layout.width() >= width)) continue;
    most = numbers;
    width = layout.width();
    best = separator;
  }
  return best;
}

}  // namespace kinecal::detail
