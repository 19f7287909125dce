// SPDX-License-Identifier: Apache-2.0
#include "kinecal/report/svg.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "kinecal/report/chart_style.hpp"
#include "kinecal/report/svg_text.hpp"
#include "support/svg_chart.hpp"

namespace kinecal::detail {
namespace {

using testing::HasSubstr;
using testing::Not;

TEST(SvgText, EscapesMarkupAndKeepsEmoji) {
  EXPECT_EQ(svg_escaped("<b a=\"1\" c='2'>&🤖"),
            "&lt;b a=&quot;1&quot; c=&#39;2&#39;&gt;&amp;🤖");
}

TEST(SvgText, ReplacesWhatXmlOrAReaderCannotTake) {
  const std::string none = "\uFFFD";
  EXPECT_EQ(svg_escaped("a\x1b[0m"), "a" + none + "[0m");
  EXPECT_EQ(svg_escaped(std::string("a\0b", 3)), "a" + none + "b");
  EXPECT_EQ(svg_escaped("\xff"), none);
  EXPECT_EQ(svg_escaped("\xc3"), none) << "half a character";
  EXPECT_EQ(svg_escaped("\xc0\xaf"), none + none) << "written too long";
  EXPECT_EQ(svg_escaped("\xed\xa0\x80"), none + none + none) << "a surrogate";
  EXPECT_EQ(svg_escaped("\uFFFE"), none);
  EXPECT_EQ(svg_escaped("gpj.\u202Eexe"), "gpj." + none + "exe") << "turns the direction";
  EXPECT_EQ(svg_escaped("a\nb"), "a b");
}

TEST(SvgText, ShortensNamesInTheMiddleByCharacters) {
  EXPECT_EQ(shortened("wrist_roll_joint", 20), "wrist_roll_joint");
  EXPECT_EQ(shortened("wrist_roll_joint", 9), "wris…oint");
  EXPECT_EQ(shortened("🤖🤖🤖🤖🤖🤖", 5), "🤖🤖…🤖🤖");
  EXPECT_EQ(shortened(std::string(5000, 'a'), 9), "aaaa…aaaa");
  std::string robots;
  for (int i = 0; i < 1000; ++i) robots += "🤖";
  EXPECT_EQ(shortened("a" + robots + "b", 5), "a🤖…🤖b") << "never cut within a character";
}

TEST(SvgText, IsolatesWhatIsWrittenFromRightToLeft) {
  EXPECT_EQ(shortened("זרוע", 20), "\u2068זרוע\u2069");
  EXPECT_EQ(svg_escaped(shortened("ذراع", 20)), "\u2068ذراع\u2069");
}

TEST(SvgText, FiguresHaveThreeDigits) {
  EXPECT_EQ(figure(0.0), "0");
  EXPECT_EQ(figure(0.012345), "0.0123");
  EXPECT_EQ(figure(1.5), "1.5");
  EXPECT_EQ(figure(-12.345), "\u221212.3");
  EXPECT_EQ(figure(999.6), "1000");
  EXPECT_EQ(figure(123456.7), "123\u2009457");
  EXPECT_EQ(figure(1.2e-7), "1.2e-7");
  EXPECT_EQ(figure(3e20), "3e20");
  EXPECT_EQ(figure(test::kNan), "–");
  EXPECT_EQ(figure(-test::kInfinity), "–");
  EXPECT_EQ(count_text(200000), "200\u2009000");
  EXPECT_EQ(count_text(9999), "9999");
}

TEST(SvgText, CoordinatesHaveOneDigitAndAreFinite) {
  EXPECT_EQ(coordinate(12.34), "12.3");
  EXPECT_EQ(coordinate(-0.06), "-0.1");
  EXPECT_EQ(coordinate(-0.01), "0");
  EXPECT_EQ(coordinate(7.0), "7");
  EXPECT_EQ(coordinate(test::kNan), "0");
  EXPECT_EQ(coordinate(test::kInfinity), "0");
  EXPECT_EQ(coordinate(1e300), "1000000");
}

TEST(SvgText, SlugsAreNamesOfFiles) {
  EXPECT_EQ(slug_of("Hand Eye/../x"), "hand-eye-x");
  EXPECT_EQ(slug_of("<>"), "");
  EXPECT_EQ(slug_of(std::string(5000, 'a')).size(), 40u);
}

TEST(SvgAxis, MapsThereAndBack) {
  for (const Axis& axis :
       {Axis::linear(-3.0, 17.0, 40.0, 460.0), Axis::exact(0.2, 0.9, 200.0, 20.0),
        Axis::logarithmic(0.02, 50.0, 40.0, 460.0)}) {
    for (const double value : {axis.low(), 0.5 * (axis.low() + axis.high()), axis.high()}) {
      EXPECT_NEAR(axis.value(axis.at(value)), value, 1e-9 * std::abs(value) + 1e-9);
    }
  }
}

TEST(SvgAxis, EndsAndTicksAreRound) {
  const Axis axis = Axis::linear(0.3, 9.7, 0.0, 100.0);
  EXPECT_EQ(axis.low(), 0.0);
  EXPECT_EQ(axis.high(), 10.0);
  std::vector<std::string> labels;
  for (const Tick& tick : axis.ticks()) labels.push_back(tick.label);
  EXPECT_THAT(labels, testing::ElementsAre("0", "2", "4", "6", "8", "10"));
  labels.clear();
  for (const Tick& tick : Axis::logarithmic(0.5, 2e5, 0.0, 100.0).ticks()) {
    if (!tick.label.empty()) labels.push_back(tick.label);
  }
  EXPECT_THAT(labels, testing::ElementsAre("1", "10", "100", "1000", "10⁴", "10⁵"));
}

TEST(SvgAxis, AnyTwoNumbersGiveAnAxis) {
  const double values[] = {
      0.0, -1.0, 5.0, 1e-300, 1e300, test::kNan, test::kInfinity, -test::kInfinity};
  for (const double low : values) {
    for (const double high : values) {
      for (const Axis& axis :
           {Axis::linear(low, high, 0.0, 100.0), Axis::exact(low, high, 0.0, 100.0),
            Axis::logarithmic(low, high, 0.0, 100.0)}) {
        EXPECT_LT(axis.low(), axis.high()) << low << " " << high;
        EXPECT_TRUE(std::isfinite(axis.at(low)) && std::isfinite(axis.at(0.0)));
        EXPECT_LE(axis.ticks().size(), 120u);
      }
    }
  }
  EXPECT_EQ(Axis::logarithmic(1.0, 10.0, 40.0, 100.0).at(0.0), 40.0) << "zero is at the end";
}

TEST(Svg, IsWellFormedAndDescribed) {
  Drawing drawing("chart", "A <title>", 100.0);
  drawing.name({1.0, 1.0}, "a <\"name\"> of " + std::string(5000, 'x'), 80.0);
  drawing.circle({test::kNan, test::kInfinity}, 2.0, "after", 7, "a & b");
  drawing.hatching({1.0, 1.0}, 2.0, 2.0, "hatched");
  const std::string svg = drawing.str("A & B");
  const test::SvgChart chart(svg);
  EXPECT_STREQ(chart.root().attribute("role").value(), "img");
  EXPECT_STREQ(chart.root().attribute("aria-labelledby").value(), "chart-title chart-desc");
  EXPECT_STREQ(chart.root().attribute("viewBox").value(), "0 0 420 100");
  EXPECT_EQ(chart.text("//title[@id='chart-title']"), "A <title>");
  EXPECT_EQ(chart.text("//desc[@id='chart-desc']"), "A & B");
  EXPECT_EQ(chart.text("//text/title").size(), 5014u) << "the whole name";
  EXPECT_EQ(chart.all("//circle[@data-sample='7' and @cx='0' and @cy='0']").size(), 1u);
  EXPECT_EQ(chart.all("//*[@fill='url(#chart-hatch)']").size(), 1u);
  EXPECT_EQ(chart.all("//pattern[@id='chart-hatch']").size(), 1u);
}

TEST(Svg, AFileOfItsOwnHasItsStyleAndNoVariables) {
  const std::string text = stand_alone(Drawing("chart", "title", 100.0).str("words"));
  EXPECT_THAT(text, testing::StartsWith("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<svg "));
  EXPECT_THAT(text, HasSubstr(".chart text { fill: #1f2328; }"));
  EXPECT_THAT(text, Not(HasSubstr("var(")));
  EXPECT_THAT(chart_style(), HasSubstr("fill: var(--ink, #1f2328);"));
  const test::SvgChart chart(text);
  EXPECT_EQ(chart.all("/svg/style").size(), 1u);
  EXPECT_STREQ(chart.all("/svg/rect")[0].attribute("fill").value(), "white");
}

TEST(Svg, AFileOfItsOwnHasASizeOnPaper) {
  const std::string svg = Drawing("chart", "title", 210.0).str("words");  // 420 x 210
  const test::SvgChart usual(stand_alone(svg)), narrow(stand_alone(svg, 85.0));
  EXPECT_STREQ(usual.root().attribute("width").value(), "160mm");
  EXPECT_STREQ(usual.root().attribute("height").value(), "80mm");
  EXPECT_STREQ(narrow.root().attribute("width").value(), "85mm");
  EXPECT_STREQ(narrow.root().attribute("height").value(), "42.5mm");
  EXPECT_THAT(usual.text("/svg/style"), Not(HasSubstr("width: 100%"))) << "it would win";
  EXPECT_THAT(stand_alone("<svg class=\"chart\"></svg>"), Not(HasSubstr("mm")));
}

}  // namespace
}  // namespace kinecal::detail
