// Characters that people may see: one rule for terminals, pages and charts.
#include "kinecal/text/characters.hpp"

#include <gtest/gtest.h>

#include "kinecal/text/printable.hpp"

namespace kinecal::detail {
namespace {

TEST(Characters, AreReadAndWrittenAlike) {
  const std::string text = "a\u00e9\u05e2\u5173\U0001F916";
  std::string again;
  int count = 0;
  for (std::size_t at = 0; at < text.size(); ++count) {
    append_character(again, next_character(text, at));
  }
  EXPECT_EQ(again, text);
  EXPECT_EQ(count, 5);
}

TEST(Characters, OfALineAreShown) {
  EXPECT_EQ(one_line("a\nb\tc"), "a b c");
  EXPECT_EQ(one_line("a\x1b\u202E\xff"), "a\uFFFD\uFFFD\uFFFD");
  EXPECT_TRUE(is_right_to_left(U'\u05e2'));
  EXPECT_FALSE(is_right_to_left(U'a'));
}

TEST(Characters, OnATerminalAndOnAPageAreTheSame) {
  for (char32_t c = 0x20; c < 0x3000; ++c) {
    std::string text;
    append_character(text, c);
    EXPECT_EQ(printable(text) == text, is_shown(c)) << std::hex << static_cast<unsigned>(c);
    EXPECT_EQ(one_line(text) == text, is_shown(c)) << std::hex << static_cast<unsigned>(c);
  }
}

}  // namespace
}  // namespace kinecal::detail
