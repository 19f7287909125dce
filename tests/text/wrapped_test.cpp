#include "kinecal/text/wrapped.hpp"

#include <gtest/gtest.h>

namespace kinecal {
namespace {

TEST(Wrapped, BreaksLinesAtSpacesAndIndentsWhatFollows) {
  EXPECT_EQ(wrapped("  - one two three\nfour\n", 11), "  - one two\n    three\nfour\n");
}

TEST(Wrapped, BreaksNeitherWordsNorTables) {
  EXPECT_EQ(wrapped("aaaaaaaaaaaa bb", 5), "aaaaaaaaaaaa\n  bb\n");
  EXPECT_EQ(wrapped("name   unit   value\n\n", 5), "name   unit   value\n\n");
}

TEST(Wrapped, KeepsACommandInOneLineToBePasted) {
  EXPECT_EQ(wrapped("hold it:\n  kinecal calibrate --hold 'a b'\n", 9),
            "hold it:\n  kinecal calibrate --hold 'a b'\n");
}

TEST(Wrapped, CountsCharactersAndNotBytes) {
  EXPECT_EQ(wrapped("\xC3\xA4\xC3\xB6\xC3\xBC abc", 7), "\xC3\xA4\xC3\xB6\xC3\xBC abc\n");
}

}  // namespace
}  // namespace kinecal
