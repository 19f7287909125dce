// Tables as programs write them.
#include "kinecal/files/csv/csv_table.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace kinecal {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using Cells = std::vector<std::string>;

std::vector<Cells> cells(std::string_view text, char separator = ',') {
  Diagnostics diagnostics;
  std::vector<Cells> all;
  for (detail::CsvRow& row : detail::csv_rows(text, separator, "t.csv", diagnostics))
    all.push_back(row.cells);
  EXPECT_THAT(diagnostics.errors, IsEmpty());
  return all;
}

TEST(CsvTable, HasTheSeparatorsOfPrograms) {
  const auto both = ElementsAre(Cells{"a", "b c", "d"}, Cells{"1", "2", "3"});
  EXPECT_THAT(cells("a,b c,d\n1,2,3\n"), both);
  EXPECT_THAT(cells("a; b c ;d\n1;2;3", ';'), both);
  EXPECT_THAT(cells("a\tb c\td\n1\t 2\t3\n", '\t'), both);
  EXPECT_THAT(cells("  1   2\t3  \n 4 5\n", ' '),
              ElementsAre(Cells{"1", "2", "3"}, Cells{"4", "5"}));
}

TEST(CsvTable, EndsLinesAsUnixDosAndOldMacsDo) {
  for (const char* text : {"a,b\n1,2\n", "a,b\r\n1,2\r\n", "a,b\r1,2\r",
                           "\xef\xbb\xbf"
                           "a,b\n1,2"}) {
    EXPECT_THAT(cells(text), ElementsAre(Cells{"a", "b"}, Cells{"1", "2"})) << text;
  }
}

TEST(CsvTable, KeepsEmptyCellsAndLeavesOutEmptyRows) {
  EXPECT_THAT(cells("a,,\n\n,,,\n  \n,b\n"), ElementsAre(Cells{"a", "", ""}, Cells{"", "b"}));
  EXPECT_THAT(cells(""), IsEmpty());
  EXPECT_THAT(cells("\n\n", ' '), IsEmpty());
}

TEST(CsvTable, UnderstandsQuotedCells) {
  EXPECT_THAT(cells("\"a, b\" ,\"say \"\"hi\"\"\",\"two\nlines\"\n\"\",x\n"),
              ElementsAre(Cells{"a, b", "say \"hi\"", "two\nlines"}, Cells{"", "x"}));
  EXPECT_THAT(cells("\"a b\" c\n", ' '), ElementsAre(Cells{"a b", "c"}));
}

TEST(CsvTable, CountsLinesAlsoWithinCells) {
  Diagnostics diagnostics;
  const auto rows = detail::csv_rows("a\n\n\"b\r\nc\"\r\nd\n", ',', "t.csv", diagnostics);
  ASSERT_EQ(rows.size(), 3u);
  EXPECT_EQ(rows[1].line, 3);
  EXPECT_EQ(rows[2].line, 5);
}

TEST(CsvTable, ReportsWhereAQuotedCellGoesWrong) {
  Diagnostics diagnostics;
  (void)detail::csv_rows("a\n\"b\nc", ',', "t.csv", diagnostics);
  (void)detail::csv_rows("a\n\"b\"c,d\n", ',', "u.csv", diagnostics);
  EXPECT_THAT(diagnostics.errors, ElementsAre(HasSubstr("t.csv:2: a quoted cell begins here"),
                                              HasSubstr("u.csv:2: text follows a quoted cell")));
}

}  // namespace
}  // namespace kinecal
