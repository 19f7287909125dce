// What reaches a terminal: no control characters, all letters.
#include "kinecal/text/printable.hpp"

#include <gtest/gtest.h>

namespace kinecal {
namespace {

TEST(Printable, LeavesLettersOfAllAlphabets) {
  for (const char* text :
       {"", "elbow_joint", "gélenk\t1\n", "\xe5\x85\xb3\xe8\x8a\x82", "\xf0\x9f\xa4\x96"}) {
    EXPECT_EQ(printable(text), text);
  }
  EXPECT_FALSE(has_control_characters("a\tb"));
  EXPECT_FALSE(has_control_characters("gélenk \xe5\x85\xb3 1"));
}

TEST(Printable, ShowsControlCharactersAsNumbers) {
  EXPECT_EQ(printable("\x1b[31mred\r"), "\\x1b[31mred\\x0d");
  EXPECT_EQ(printable("a\x7f"), "a\\u007f");
  EXPECT_EQ(printable(std::string("a\0b", 3)), "a\\x00b");
  EXPECT_EQ(printable("\xc2\x9b"
                      "31m"),
            "\\u009b31m")
      << "CSI of eight bits, as UTF-8";
  for (const char* text : {"\x1b", "a\r", "a\n", "\u2028", "\x7f", "\xc2\x9b"}) {
    EXPECT_TRUE(has_control_characters(text));
  }
}

TEST(Printable, ShowsWhatTurnsTheDirectionOfWritingAsNumbers) {
  EXPECT_EQ(printable("gpj.\u202Eexe"), "gpj.\\u202eexe");
  for (const char* turns : {"\u202A", "\u202B", "\u202C", "\u202D", "\u2066", "\u2067", "\u2068",
                            "\u2069", "\u200E", "\u200F", "\u061C"}) {
    EXPECT_EQ(printable(turns).size(), 6u) << printable(turns);
    EXPECT_FALSE(has_control_characters(turns)) << "a robot may have such a name";
  }
  EXPECT_EQ(printable("זרוע"), "זרוע") << "letters are no marks";
}

TEST(Printable, LeavesJsonTheSameJson) {
  EXPECT_EQ(printable("{\"name\": \"a\u202Eb\x7f\"}\n"), "{\"name\": \"a\\u202eb\\u007f\"}\n");
}

TEST(Printable, ShowsWhatIsNotUtf8AsNumbers) {
  EXPECT_EQ(printable("\x9b"
                      "31m"),
            "\\x9b31m");
  EXPECT_EQ(printable("a\xe5\x85"), "a\\xe5\\x85") << "cut off";
  EXPECT_EQ(printable("\xc0\x9b"), "\\xc0\\x9b") << "longer than it needs to be";
  EXPECT_EQ(printable("\xe5g"), "\\xe5g");
  EXPECT_TRUE(has_control_characters("\xff"));
}

}  // namespace
}  // namespace kinecal
