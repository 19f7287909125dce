// kinecal plot: the charts of a report as files.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "kinecal/report/charts/charts.hpp"
#include "support/paths.hpp"
#include "support/report_data.hpp"
#include "support/run_program.hpp"
#include "support/svg_chart.hpp"

namespace kinecal {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class Plot : public test::ProgramTest {
 protected:
  Plot() {
    std::string page =
        "<!doctype html>\n<html><head><meta name=\"generator\" content=\"kinecal 0.2.0\">\n"
        "<script>const any = '<svg data-chart=\"' + name;</script></head><body>\n"
        "<svg class=\"logo\"><path d=\"M0 0\"/></svg>\n"
        "<svg class=\"chart\" data-chart=\"../evil\"><title>no name of ours</title></svg>\n";
    for (const Chart& chart : all_) page += "<figure>" + chart.svg + "</figure>\n";
    write("out.html", page + "</body></html>\n");
  }
  [[nodiscard]] test::Outcome plot(const std::string& arguments) const {
    return run(test::kinecal_program() + " plot " + arguments);
  }
  [[nodiscard]] std::size_t files_in(const std::string& folder) const {
    if (!fs::exists(folder_ / folder)) return 0;
    return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder_ / folder), {}));
  }

  const std::vector<Chart> all_ = charts(test::report_data(6));
};

TEST_F(Plot, WritesEveryChartAsAFileOfItsOwn) {
  const test::Outcome outcome = plot("out.html --output figures");
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_EQ(files_in("figures"), all_.size());
  for (const Chart& chart : all_) {
    EXPECT_THAT(outcome.out, HasSubstr("wrote figures/" + chart.name + ".svg\n"));
    const test::SvgChart svg(read("figures/" + chart.name + ".svg"));
    EXPECT_EQ(svg.text("/svg/title"), chart.title);
    EXPECT_EQ(svg.all("/svg/style").size(), 1u);
    EXPECT_STREQ(svg.root().attribute("xmlns").value(), "http://www.w3.org/2000/svg");
  }
}

TEST_F(Plot, WritesTheChartsThatAreNamed) {
  EXPECT_EQ(plot("out.html correlation samples-ground correlation -o figures").code, 0);
  EXPECT_EQ(files_in("figures"), 2u);
  EXPECT_TRUE(fs::exists(folder_ / "figures/samples-ground.svg"));
}

TEST_F(Plot, ChartsAreAsWideOnPaperAsIsAskedFor) {
  for (const auto& [option, width] : {std::pair{"", "160mm"},
                                      {"--width 85", "85mm"},
                                      {"--width 8.5cm", "85mm"},
                                      {"--width 2in", "50.8mm"}}) {
    ASSERT_EQ(plot(std::string("out.html correlation -o figures --force ") + option).code, 0);
    const test::SvgChart svg(read("figures/correlation.svg"));
    EXPECT_STREQ(svg.root().attribute("width").value(), width) << option;
    EXPECT_TRUE(std::string(svg.root().attribute("height").value()).ends_with("mm"));
  }
  EXPECT_EQ(plot("out.html correlation -o none --width 0").code, 1);
  EXPECT_EQ(plot("out.html correlation -o none --width 85pt").code, 1);
  EXPECT_THAT(run(test::kinecal_program() + " plot --help").out, HasSubstr("rsvg-convert -f pdf"));
}

TEST_F(Plot, ListsNamesAndTitles) {
  const test::Outcome outcome = plot("out.html --list");
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_THAT(outcome.out, testing::ContainsRegex("\ncorrelation +Correlations of parameters\n"));
  EXPECT_EQ(std::count(outcome.out.begin(), outcome.out.end(), '\n'), std::ssize(all_));
}

TEST_F(Plot, ProposesTheNameThatWasMeantAndWritesNothing) {
  const test::Outcome outcome = plot("out.html correlation corelations xyz -o figures");
  EXPECT_EQ(outcome.code, 1);
  EXPECT_THAT(outcome.err,
              HasSubstr("out.html: has no chart 'corelations'; did you mean 'correlation'?"));
  EXPECT_THAT(outcome.err,
              HasSubstr("out.html: has no chart 'xyz'; --list prints the names of its charts"));
  EXPECT_EQ(files_in("figures"), 0u);
}

TEST_F(Plot, ReplacesFilesOnlyIfForcedAndElseWritesNone) {
  fs::create_directory(folder_ / "figures");
  write("figures/correlation.svg", "mine");
  const test::Outcome refused = plot("out.html -o figures");
  EXPECT_EQ(refused.code, 1);
  EXPECT_EQ(refused.err,
            "error: figures/correlation.svg: exists; use --force to replace it, or "
            "choose another name\n");
  EXPECT_EQ(read("figures/correlation.svg"), "mine");
  EXPECT_EQ(files_in("figures"), 1u);
  EXPECT_EQ(plot("out.html -o figures --force").code, 0);
  EXPECT_EQ(files_in("figures"), all_.size());
}

TEST_F(Plot, RefusesWhatIsNotAReport) {
  write("page.html", "<html><svg data-chart=\"errors-mm\"></svg></html>");
  EXPECT_EQ(plot("page.html -o figures").err,
            "error: page.html: is not an HTML report of kinecal; 'kinecal calibrate --report "
            "out.html' writes one\n");
  write("empty.html", "<meta name=\"generator\" content=\"kinecal 0.2.0\">");
  EXPECT_EQ(plot("empty.html -o figures").err, "error: empty.html: holds no charts\n");
  write("cut.html", read("out.html").substr(0, 900));
  EXPECT_EQ(plot("cut.html -o figures").err, "error: cut.html: holds no charts\n");
  EXPECT_EQ(plot("none.html -o figures").code, 1);
  EXPECT_EQ(plot("out.html").err,
            "error: --output is required: the folder for the SVG files; or --list\n");
  EXPECT_FALSE(fs::exists(folder_ / "figures"));
}

}  // namespace
}  // namespace kinecal
