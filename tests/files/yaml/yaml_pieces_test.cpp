#include "kinecal/files/yaml/yaml_pieces.ipp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <sstream>
#include <string>
#include <vector>

namespace kinecal {
namespace {

using namespace detail;

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

std::vector<std::string> pieces_of(const std::string& text, std::size_t bytes = 1) {
  std::istringstream in(text);
  YamlPieces pieces(in, bytes);
  std::vector<std::string> texts;
  while (const auto piece = pieces.next()) texts.push_back(piece->text);
  return texts;
}

/// The file again: each piece but the last ends with the line that begins the next one.
std::string put_together(const std::vector<std::string>& pieces) {
  std::string text;
  for (const std::string& piece : pieces) {
    text += &piece == &pieces.back() ? piece : piece.substr(0, piece.size() - 4);
  }
  return text;
}

TEST(YamlPieces, EachDocumentIsAPieceAndEndsWithTheStartOfTheNextOne) {
  EXPECT_THAT(pieces_of("a: 1\n---\nb: 2\n---\n"),
              ElementsAre("a: 1\n---\n", "---\nb: 2\n---\n", "---\n"));
  EXPECT_THAT(pieces_of("---\na: 1\n--- {b: 2}\n--- \nc"),
              ElementsAre("---\na: 1\n---\n", "--- {b: 2}\n---\n", "--- \nc"));
  EXPECT_THAT(pieces_of("a\r\n---\r\nb\r\n"), ElementsAre("a\r\n---\n", "---\r\nb\r\n"));
}

TEST(YamlPieces, FileWithoutContentHasNoPieces) {
  EXPECT_THAT(pieces_of(""), IsEmpty());
}

TEST(YamlPieces, PieceHasAsManyDocumentsAsThereAreBytes) {
  const std::string text = "a: 1\n---\nb: 2\n---\nc: 3\n---\n";
  EXPECT_THAT(pieces_of(text, 20),
              ElementsAre("a: 1\n---\nb: 2\n---\n", "---\nc: 3\n---\n", "---\n"));
  EXPECT_THAT(pieces_of(text, 1000), ElementsAre("a: 1\n---\nb: 2\n---\nc: 3\n---\n", "---\n"));
}

TEST(YamlPieces, NothingIsCutWhereNoDocumentBegins) {
  for (const std::string text : {
           "a: |\n  x\n  ---\n  y\n",        // within a block scalar
           "a: 'x\n  ---\n  y'\n",           // within a quoted scalar
           "a: x\n  ---\n",                  // within a plain scalar
           "a: 1\n----\n---b\n--- ",         // no marker: the start of a word, or not yet complete
           "# ---\n",                        // a comment
           "%YAML 1.2\n---\na: 1\n",         // the document of a directive
           "%YAML 1.2\n\n # c\n#c\n---\na",  // the same, further away
           "---",
       }) {
    const auto expected = text.ends_with("--- ") ? 2u : 1u;
    EXPECT_EQ(pieces_of(text).size(), expected) << text;
  }
}

TEST(YamlPieces, DirectivesStayWithTheirDocument) {
  EXPECT_THAT(pieces_of("---\na: 1\n...\n%YAML 1.2\n---\nb: 2\n---\nc: 3\n"),
              ElementsAre("---\na: 1\n...\n%YAML 1.2\n---\nb: 2\n---\n", "---\nc: 3\n"));
}

TEST(YamlPieces, PiecesKnowTheirLineAndAreTheFileWhateverTheirSize) {
  const std::string text =
      "# c\n---\na: 1\n---\n---\r\nb: |\n ---\n---\n%A\n---\n...\n%YAML 1.2\n---\nc\n--- d\n---\n";
  for (std::size_t bytes = 1; bytes < text.size() + 2; ++bytes) {
    std::istringstream in(text);
    YamlPieces pieces(in, bytes);
    std::vector<std::string> texts;
    while (const auto piece = pieces.next()) {
      const std::string before = put_together([&] {
        auto with_this = texts;
        with_this.push_back("");
        return with_this;
      }());
      EXPECT_EQ(piece->line, 1 + std::count(before.begin(), before.end(), '\n')) << bytes;
      texts.push_back(piece->text);
    }
    EXPECT_EQ(put_together(texts), text) << bytes;
    EXPECT_EQ(pieces.last(), '\n');
  }
}

TEST(YamlPieces, DocumentWithoutEndIsRefused) {
  std::istringstream in("a: 1\n---\nb: " + std::string(1000, 'b') + "\n---\n");
  YamlPieces pieces(in, 9, 100);
  EXPECT_EQ(pieces.next()->text, "a: 1\n---\n");
  try {
    (void)pieces.next();
    FAIL() << "it was read";
  } catch (const YamlError& e) {
    EXPECT_EQ(e.line, 2);
    EXPECT_THAT(e.what(), HasSubstr("no '---' within 1"));
  }
}

/// The parts of a text, each followed by a bar.
std::string parts_of(std::string_view text) {
  std::string parts;
  while (!text.empty()) parts += std::string(take_yaml_part(text)) + "|";
  return parts;
}

TEST(YamlPieces, PartsEndBeforeLinesOfDots) {
  EXPECT_EQ(parts_of("a: 1\n...\nb: 2\n...\n"), "a: 1\n|b: 2\n|");
  EXPECT_EQ(parts_of("... # end\r\n...\r\nb\n... \t\n\n..."), "||b\n|\n|");
  for (const std::string all : {"a: ...\n", "....\n...b\n ...\n...#\n", "... a\n... - b"}) {
    EXPECT_EQ(parts_of(all), all + "|");
  }
}

}  // namespace
}  // namespace kinecal
