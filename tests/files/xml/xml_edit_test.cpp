#include "kinecal/files/xml/xml_edit.ipp"

#include <gtest/gtest.h>

#include <string>

namespace kinecal {
namespace {

using namespace detail;

std::string value(const std::string& text, const StartTag& tag, const std::string& name) {
  const AttributeText* attribute = tag.find(name);
  return attribute == nullptr ? "(none)"
                              : text.substr(attribute->begin, attribute->end - attribute->begin);
}

TEST(XmlEdit, EditsAreMadeAtTheirPlacesInTheOldText) {
  EXPECT_EQ(apply_edits("abcdef", {{4, 1, "EEE"}, {0, 2, ""}, {6, 0, "!"}}), "cdEEEf!");
}

TEST(XmlEdit, InsertionsAtOnePlaceKeepTheirOrder) {
  EXPECT_EQ(apply_edits("ab", {{1, 0, "1"}, {1, 0, "2"}}), "a12b");
}

TEST(XmlEdit, TextInAnAttributeIsEscapedForItsQuotes) {
  EXPECT_EQ(xml_attribute_text("a & b < 'c' \"d\"", '"'), "a &amp; b &lt; 'c' &quot;d&quot;");
  EXPECT_EQ(xml_attribute_text("'c' \"d\"", '\''), "&apos;c&apos; \"d\"");
  EXPECT_EQ(xml_attribute_text("a\tb\n", '"'), "a&#9;b&#10;") << "no blanks";
}

TEST(XmlEdit, AStartTagEndsAtItsOwnBracket) {
  const std::string text = "<a x = 'b > \"c\"'\n\ty=\"/>\">text</a>";
  const StartTag tag = scan_start_tag(text, 0);
  EXPECT_EQ(text.substr(tag.end), "text</a>");
  EXPECT_EQ(text.substr(tag.attributes_end), ">text</a>");
  EXPECT_FALSE(tag.empty);
  EXPECT_EQ(value(text, tag, "x"), "b > \"c\"");
  EXPECT_EQ(value(text, tag, "y"), "/>");
  EXPECT_EQ(value(text, tag, "z"), "(none)");
}

TEST(XmlEdit, AnEmptyElementKnowsHowItIsClosed) {
  EXPECT_EQ(scan_start_tag("<a/>", 0).closing(), "/>");
  EXPECT_EQ(scan_start_tag("<a x='1' />", 0).closing(), " />");
  EXPECT_EQ(scan_start_tag("<a x='1' />", 0).quote, '\'');
  EXPECT_EQ(scan_start_tag("<a x='1'></a>", 0).closing(), "/>");
}

TEST(XmlEdit, AnElementEndsBehindItsOwnEndTag) {
  for (const std::string element :
       {"<a/>", "<a></a>", "<a><a x='</a>'/></a >", "<a><!-- </a> --><a><b/></a></a>",
        "<a><![CDATA[</a>]]><?p </a>?>&lt;/a></a>"}) {
    const std::string text = "<a/>" + element + "<a></a>";
    EXPECT_EQ(text.substr(element_end(text, 4)), "<a></a>") << element;
  }
}

TEST(XmlEdit, TextThatEndsInsideATagIsRefused) {
  for (const std::string text : {"<a", "<a x", "<a x=", "<a x='1", "<a x='1' ", "<a></a", "<a>"}) {
    EXPECT_THROW((void)element_end(text, 0), InputError) << text;
  }
}

TEST(XmlEdit, ALineStartsWithItsLineBreakAndIndentation) {
  EXPECT_EQ(line_start_before("<a>\n\n  <b/>", 7), "\n  ");
  EXPECT_EQ(line_start_before("<a>\r\n\t<b/>", 6), "\r\n\t");
  EXPECT_EQ(line_start_before("<a> <b/>", 4), " ");
  EXPECT_EQ(line_start_before("<a><b/>", 3), "");
}

}  // namespace
}  // namespace kinecal
