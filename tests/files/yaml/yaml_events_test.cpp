#include "kinecal/files/yaml/yaml_events.ipp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <string_view>

namespace kinecal {
namespace {

using namespace detail;

using ::testing::HasSubstr;

/// Writes down the events: "+" for a document, "{", "[" and scalars after their line, "." for ends.
struct Recorder {
  std::string text;
  void document_starts() { text += "+ "; }
  void null(int line) { add(line, "null"); }
  void scalar(int line, std::string_view scalar) { add(line, "'" + std::string(scalar) + "'"); }
  void alias(int line) { add(line, "*"); }
  void list_starts(int line) { add(line, "["); }
  void map_starts(int line) { add(line, "{"); }
  void ends() { text += ". "; }
  void add(int line, const std::string& what) { text += std::to_string(line) + what + " "; }
};
static_assert(YamlHandler<Recorder>);

std::string events_of(const std::string& text, int first_line = 1) {
  YamlEvents events(text, first_line);
  Recorder recorder;
  while (events.next_document(recorder)) {
  }
  return recorder.text;
}

/// The text is refused at this line, with these words.
void expect_error(const std::string& text, int line, const std::string& words) {
  try {
    const std::string events = events_of(text);
    FAIL() << "it was read: " << events;
  } catch (const YamlError& e) {
    EXPECT_EQ(e.line, line) << e.what();
    EXPECT_THAT(e.what(), HasSubstr(words));
  }
}

TEST(YamlEvents, EventsComeInTheOrderOfTheTextWithTheirLines) {
  EXPECT_EQ(events_of("a: [1, 'x y']\nb:\n- c: |\n    two\n    lines\n"),
            "+ 1{ 1'a' 1[ 1'1' 1'x y' . 2'b' 3[ 3{ 3'c' 3'two\nlines\n' . . . ");
  EXPECT_EQ(events_of("a\n---\nb\n", 11), "+ 11'a' + 13'b' ");
}

TEST(YamlEvents, NothingAndItsWordsAreNullUnlessTheyAreQuotedOrTagged) {
  EXPECT_EQ(events_of("[~, null, Null, NULL, nUll, '~', \"\", !!str ~, &a ~, !!str ]"),
            "+ 1[ 1null 1null 1null 1null 1'nUll' 1'~' 1'' 1'~' 1null 1null . ");
  EXPECT_EQ(events_of("a:\nb:\n"), "+ 1{ 1'a' 1null 2'b' 2null . ");
}

TEST(YamlEvents, TextWithoutContentHasNoDocumentAndAMarkerBeginsAnEmptyOne) {
  EXPECT_EQ(events_of(""), "");
  EXPECT_EQ(events_of("# nothing\n\n"), "");
  EXPECT_EQ(events_of("---\n---\n"), "+ 2null + 3null ");
}

TEST(YamlEvents, DocumentsFollowDotsWithAndWithoutMarkers) {
  EXPECT_EQ(events_of("a\n...\nb\n... # c\n\n---\nc\n...\n%YAML 1.2\n---\nd\n...\n"),
            "+ 1'a' + 3'b' + 7'c' + 11'd' ");
  EXPECT_EQ(events_of("...\r\n...\r\na\r\n...\n...\n# c\n...\n--- b\n"), "+ 3'a' + 8'b' ");
  expect_error("a\n... b\n", 2, "did not find expected <document start>");
  expect_error("a: 'b\n...\nc'\n", 2, "while scanning a quoted scalar from line 1");
}

TEST(YamlEvents, MarkersWithinScalarsAreIndentedAndCommentsAreSkipped) {
  EXPECT_EQ(events_of("a: |\n  ---\n  ...\nb: '---\n  ---'\n# ---\nc: ---\n"),
            "+ 1{ 1'a' 1'---\n...\n' 4'b' 4'--- ---' 7'c' 7'---' . ");
  expect_error("a: 'b\n---\nc'\n", 2,
               "document indicator while scanning a quoted scalar from line");
}

TEST(YamlEvents, ErrorsHaveTheirLineAndThatOfWhatIsOpen) {
  expect_error("a: 1\nb: {c: 1\nd: 2\n", 3, "while parsing a flow mapping from line 2");
  expect_error("a: 1\n...\nb: ]\n", 3, "did not find expected node content");
  expect_error("a: 1\nb: \xff\n", 2, "UTF-8");
  expect_error("a: 1\n...\n\nb: \x01\n", 4, "control characters");
}

TEST(YamlEvents, AliasesNeedAnAnchorInTheirDocument) {
  EXPECT_EQ(events_of("[&a 1, *a, &b [*b]]\n"), "+ 1[ 1'1' 1* 1[ 1* . . ");
  expect_error("a: &a 1\nb: *c\n", 2, "the alias '*c' has no anchor");
  expect_error("a: &a 1\n---\nb: *a\n", 3, "the alias '*a' has no anchor");
}

TEST(YamlEvents, DepthIsBounded) {
  const auto nested = [](int depth) {
    return std::string(static_cast<std::size_t>(depth), '[') +
           std::string(static_cast<std::size_t>(depth), ']') + "\n";
  };
  EXPECT_NO_THROW(
      (void)events_of(nested(YamlEvents::kDeepest) + "---\n" + nested(YamlEvents::kDeepest)));
  expect_error("a\n---\n" + nested(YamlEvents::kDeepest + 1), 3, "nested too deeply");
}

}  // namespace
}  // namespace kinecal
