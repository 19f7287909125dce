// Definitions of csv_table.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/files/csv/csv_table.hpp"

#include <algorithm>
#include <utility>

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
    for (pass_blanks(); !(separator_ == ' ' && at_line_end()); pass_blanks()) {
      row.cells.push_back(next_cell());
      pass_blanks();
      if (at_line_end()) break;
      if (separator_ != ' ') ++at_;
    }
    pass_line_end();
    return row;
  }

  std::string next_cell() {
    if (at_ < text_.size() && text_[at_] == '"') return quoted_cell();
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

}  // namespace kinecal::detail
