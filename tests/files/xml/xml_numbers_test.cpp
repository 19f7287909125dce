#include "kinecal/files/xml/xml_numbers.ipp"

#include <gtest/gtest.h>

namespace kinecal {
namespace {

TEST(XmlNumbers, NumbersAreFoundWithTheirPlaces) {
  const auto tokens = detail::number_tokens(" 1.5\t+2\r\n-3e-2 ");
  ASSERT_TRUE(tokens);
  ASSERT_EQ(tokens->size(), 3u);
  EXPECT_EQ((*tokens)[0].value, 1.5);
  EXPECT_EQ((*tokens)[1].value, 2.0);
  EXPECT_EQ((*tokens)[2].value, -0.03);
  EXPECT_EQ((*tokens)[1].begin, 5u);
  EXPECT_EQ((*tokens)[1].end, 7u);
}

TEST(XmlNumbers, OnlyFiniteDecimalNumbersAreNumbers) {
  for (const char* text : {"a", "1,5", "nan", "inf", "1e999", "+-1", "++1", "+", "0x1p3", "1 2m"}) {
    EXPECT_FALSE(detail::number_tokens(text)) << text;
  }
  EXPECT_TRUE(detail::number_tokens("  ")->empty());
}

}  // namespace
}  // namespace kinecal
