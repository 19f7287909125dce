// Tables as programs write them.
#include "kinecal/files/csv/csv_table.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "kinecal/files/csv/csv_units.hpp"

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

detail::CsvTable table(std::string_view text, detail::CsvHeader header = detail::CsvHeader::found) {
  Diagnostics diagnostics;
  detail::CsvTable read =
      detail::csv_table(text, detail::csv_separator(text), header, "t.csv", diagnostics);
  EXPECT_THAT(diagnostics.errors, IsEmpty());
  return read;
}

TEST(CsvTable, TheLastCommentNamesTheColumnsIfNoRowDoes) {
  const auto tum = table("# ground truth\n# timestamp tx ty\n1.5 2 3\n1.6 4 5\n");
  EXPECT_THAT(tum.header.cells, ElementsAre("timestamp", "tx", "ty"));
  EXPECT_THAT(tum.rows, testing::SizeIs(2));
  EXPECT_EQ(tum.rows[0].line, 3);
  const auto savetxt = table("#q1,q2,x\n0.1,0.2,0.3\n");
  EXPECT_THAT(savetxt.header.cells, ElementsAre("q1", "q2", "x"));
  const auto matlab = table("% \"q1\";\"q2\"\n0.1;0.2\n0.3;0.4\n");
  EXPECT_THAT(matlab.header.cells, ElementsAre("q1", "q2"));
  const auto notes = table("# a, b, c and it's \"d\nq1,q2,x\n1,2,3\n# end\n");
  EXPECT_THAT(notes.header.cells, ElementsAre("q1", "q2", "x")) << "a row wins over a comment";
  EXPECT_THAT(notes.rows, testing::SizeIs(1));
  EXPECT_THAT(table("# measured on Monday\n1,2,3\n4,5,6\n").header.cells, IsEmpty());
  EXPECT_THAT(table("#,q1,q2\n1,0.5,0.6\n2,0.7,0.8\n").header.cells, ElementsAre("#", "q1", "q2"))
      << "a column with the number of the row";
}

TEST(CsvTable, ARowThatIsCommentedOutIsAWarning) {
  Diagnostics diagnostics;
  const auto read = detail::csv_table("q1,q2\n0.1,0.2\n#0.3,0.4\n0.5,0.6\n", ',',
                                      detail::CsvHeader::present, "t.csv", diagnostics);
  EXPECT_THAT(read.rows, testing::SizeIs(2));
  EXPECT_THAT(diagnostics.warnings, ElementsAre(HasSubstr("t.csv:3: the row is commented out")));
}

TEST(CsvTable, ARowOfUnitsIsBelowTheHeader) {
  for (const char* units : {"rad,deg,[mm]", "(rad),\u00b0,mm", "# rad,deg,mm"}) {
    const auto read = table(fmt::format("q1,q2,x\n{}\n0.1,0.2,3\n", units));
    EXPECT_THAT(read.header.cells, ElementsAre("q1", "q2", "x"));
    EXPECT_THAT(read.units.cells, testing::SizeIs(3)) << units;
    EXPECT_EQ(detail::unit_of_cell(read.units.cells[1]), detail::NamedUnit::degrees);
    EXPECT_THAT(read.rows, testing::SizeIs(1));
  }
  EXPECT_THAT(table("q1,q2,x\n0.1,0.2,3\n").units.cells, IsEmpty());
}

TEST(CsvTable, PreamblesOfMotionCaptureArePassed) {
  const auto motive = table(
      "Format Version,1.23,Take Name,Take 1,Length Units,Meters\n\n"
      ",Type,Rigid Body,Rigid Body,Rigid Body,Rigid Body\n,Name,RB,RB,RB,RB\n,ID,1,1,1,1\n"
      ",,Rotation,Rotation,Position,Position\nFrame,Time (Seconds),X,Y,X,Y\n"
      "0,0.00,0.1,0.2,0.3,0.4\n1,0.01,0.1,0.2,0.3,0.4\n");
  EXPECT_THAT(motive.header.cells, ElementsAre("Frame", "Time (Seconds)", "Rotation X",
                                               "Rotation Y", "Position X", "Position Y"));
  EXPECT_THAT(motive.rows, testing::SizeIs(2));
  const auto vicon = table(
      "Trajectories\n100\n,,Arm:A,,Arm:B,\nFrame,Sub "
      "Frame,X,Y,X,Y\n,,mm,mm,mm,mm\n1,0,1,2,3,4\n2,0,1,"
      "2,3,4\n");
  EXPECT_THAT(vicon.header.cells,
              ElementsAre("Frame", "Sub Frame", "Arm:A X", "Arm:A Y", "Arm:B X", "Arm:B Y"));
  EXPECT_EQ(vicon.units.line, 5);
  const auto qualisys = table(
      "NO_OF_FRAMES\t2\nFREQUENCY\t100\nMARKER_NAMES\tA\nFrame\tTime\tA X\tA "
      "Y\n1\t0\t5\t6\n2\t0.01\t5\t"
      "6\n");
  EXPECT_THAT(qualisys.header.cells, ElementsAre("Frame", "Time", "A X", "A Y"));
  EXPECT_THAT(qualisys.header_text(),
              testing::StartsWith("line 4 was read as the header: 'Frame, "));
}

TEST(CsvTable, AHeaderMayCountTheColumns) {
  const auto read = table("image,1,2,3\n\"a\",0.1,0.2,0.3\n\"b\",0.1,0.2,0.3\n");
  EXPECT_THAT(read.header.cells, ElementsAre("image", "1", "2", "3"));
  EXPECT_THAT(read.rows, testing::SizeIs(2));
  EXPECT_THAT(table("a.png,0.1,0.2,0.3\nb.png,0.1,0.2,0.3\n").header.cells, IsEmpty());
}

TEST(CsvTable, ABadRowBelowTheHeaderStaysARow) {
  const auto read = table("q1,q2,x\na,b,c\n0.1,0.2\n0.1,0.2,0.3\n0.1,0.2,0.3\n");
  EXPECT_THAT(read.header.cells, ElementsAre("q1", "q2", "x"));
  EXPECT_THAT(read.rows, testing::SizeIs(4));
}

TEST(CsvTable, ReadsADecimalCommaWhereItIsOne) {
  const auto row = [](std::string_view text) { return table(text).rows.front().cells; };
  EXPECT_THAT(row("q1;x\n0,5;-1,25\n"), ElementsAre("0.5", "-1.25"));
  EXPECT_THAT(row("q1\tx\n0,5\t812,345\n"), ElementsAre("0.5", "812.345"));
  EXPECT_THAT(row("q1;x\n1,234;812,345\n"), ElementsAre("1.234", "812.345"));
  EXPECT_THAT(row("q1\tx\n1,234\t812,345\n"), ElementsAre("1,234", "812,345"))
      << "may be thousands";
  EXPECT_THAT(row("q1;x\n1,234;0.5\n999.5;0.6\n"), ElementsAre("1,234", "0.5"))
      << "thousands: the column has points";
}

}  // namespace
}  // namespace kinecal
