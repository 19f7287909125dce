// Words of the page are legible in both themes: contrast of 4.5 by the formula of WCAG 2.1.
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <string>

#include "kinecal/report/html.hpp"

namespace kinecal {
namespace {

/// The colours that a rule of a style sheet sets as variables.
std::map<std::string, unsigned> colors_of(const std::string& style, const std::string& selector) {
  std::map<std::string, unsigned> colors;
  const std::size_t begin = style.find(selector + " {"), end = style.find('}', begin);
  EXPECT_NE(begin, std::string::npos) << selector;
  for (std::size_t at = begin; (at = style.find("--", at)) < end; ++at) {
    const std::size_t colon = style.find(':', at), value = style.find_first_not_of(' ', colon + 1);
    if (style[value] != '#') continue;
    colors[style.substr(at + 2, colon - at - 2)] =
        static_cast<unsigned>(std::stoul(style.substr(value + 1, 6), nullptr, 16));
  }
  return colors;
}

double luminance(unsigned color) {
  const auto channel = [&](int shift) {
    const double v = ((color >> shift) & 255U) / 255.0;
    return v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4);
  };
  return 0.2126 * channel(16) + 0.7152 * channel(8) + 0.0722 * channel(0);
}

double contrast(unsigned a, unsigned b) {
  const double x = luminance(a) + 0.05, y = luminance(b) + 0.05;
  return std::max(x, y) / std::min(x, y);
}

TEST(PageContrast, FollowsTheFormula) {
  EXPECT_NEAR(contrast(0x000000, 0xffffff), 21.0, 1e-9);
  EXPECT_NEAR(contrast(0x767676, 0xffffff), 4.54, 0.01);
}

TEST(PageContrast, OfWordsIsEnoughInLightAndDark) {
  const std::string style = html_file({"title", "kinecal", "", ""});
  for (const char* theme :
       {":root", ":root[data-theme=\"dark\"]", "  :root:not([data-theme=\"light\"])"}) {
    std::map<std::string, unsigned> colors = colors_of(style, theme);
    const auto expect = [&](const std::string& text, const std::string& ground, double least) {
      ASSERT_TRUE(colors.contains(text) && colors.contains(ground)) << text << " on " << ground;
      EXPECT_GE(contrast(colors[text], colors[ground]), least)
          << theme << ": --" << text << " on --" << ground;
    };
    for (const char* text : {"ink", "muted", "before", "after", "good", "care", "bad", "sigma"}) {
      expect(text, "card", 4.5);
      expect(text, "page", 4.5);
    }
    for (const char* grade : {"good", "care", "bad"}) {
      for (const char* text : {grade, "ink", "muted"}) {
        expect(text, std::string(grade) + "-wash", 4.5);
      }
    }
    for (const char* text : {"ink", "muted", "after", "bad"}) expect(text, "chosen", 4.5);
  }
}

}  // namespace
}  // namespace kinecal
