#include "kinecal/io/urdf/urdf_text.hpp"

#include <gtest/gtest.h>

#include <string>

namespace kinecal {
namespace {

TEST(UrdfText, NumbersAreFoundWithTheirPlaces) {
  const auto tokens = number_tokens(" 1.5\t+2\r\n-3e-2 ");
  ASSERT_TRUE(tokens);
  ASSERT_EQ(tokens->size(), 3u);
  EXPECT_EQ((*tokens)[0].value, 1.5);
  EXPECT_EQ((*tokens)[1].value, 2.0);
  EXPECT_EQ((*tokens)[2].value, -0.03);
  EXPECT_EQ((*tokens)[1].begin, 5u);
  EXPECT_EQ((*tokens)[1].end, 7u);
}

TEST(UrdfText, OnlyFiniteDecimalNumbersAreNumbers) {
  for (const char* text : {"a", "1,5", "nan", "inf", "1e999", "+-1", "++1", "+", "0x1p3", "1 2m"}) {
    EXPECT_FALSE(number_tokens(text)) << text;
  }
  EXPECT_TRUE(number_tokens("  ")->empty());
}

TEST(UrdfText, PlacesAreBytesAndLinesOfTheText) {
  const std::string text =
      "\xEF\xBB\xBF<?xml version='1.0' encoding='ISO-8859-1'?>\r\n<!-- \xE9 &amp; \n -->"
      "<robot name='&lt;r'>\r\n <link name='a'/>\r\n <joint name='j'/></robot>";
  const UrdfText source(text, "r.urdf");
  const pugi::xml_node joint = source.joint("j");
  ASSERT_TRUE(joint);
  EXPECT_EQ(text.substr(source.offset(joint), 6), "<joint");
  EXPECT_EQ(source.place(joint).str(), "r.urdf:5");
  EXPECT_EQ(source.place({}).str(), "r.urdf");
  EXPECT_FALSE(source.joint("k"));
}

TEST(UrdfText, AMessageIsPlacedByTheFirstJointItNamesOrElseTheFirstLink) {
  const UrdfText source("<robot name='r'>\n<link name='a'/>\n<joint name='j'/>\n</robot>",
                        "r.urdf");
  EXPECT_EQ(source.place_of_name_in("link 'a' of joint 'j'").line, 3);
  EXPECT_EQ(source.place_of_name_in("two roots [a] and [b]").line, 2);
  EXPECT_EQ(source.place_of_name_in("1' of joint [j]").line, 3);
  EXPECT_EQ(source.place_of_name_in("no name at all").line, 0);
}

}  // namespace
}  // namespace kinecal
