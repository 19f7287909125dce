#include "kinecal/files/xml/xml_text.ipp"

#include <gtest/gtest.h>

#include <string>

#include "support/error_of.hpp"

namespace kinecal {
namespace {

TEST(XmlText, PlacesAreBytesAndLinesOfTheText) {
  const std::string text =
      "\xEF\xBB\xBF<?xml version='1.0' encoding='ISO-8859-1'?>\r\n<!-- \xE9 &amp; \n -->"
      "<robot name='&lt;r'>\r\n <link name='a'/>\r\n <joint name='j'/></robot>";
  const detail::XmlText source(text, "r.urdf", {"a URDF", "robot"});
  const pugi::xml_node joint = source.root().child("joint");
  ASSERT_TRUE(joint);
  EXPECT_EQ(text.substr(source.offset(joint), 6), "<joint");
  EXPECT_EQ(source.place(joint).str(), "r.urdf:5");
  EXPECT_EQ(source.place({}).str(), "r.urdf");
}

std::string nested(int times) {
  std::string text = "<robot name='r'>\n";
  for (int i = 0; i < times; ++i) text += "<a>\n";
  for (int i = 0; i < times; ++i) text += "</a>";
  return text + "</robot>";
}

/// Where others read it by recursion.
TEST(XmlText, NestedTooDeeplyIsAnErrorWithTheLine) {
  EXPECT_NO_THROW(detail::XmlText(nested(150), "r.urdf", {"a URDF", "robot"}));
  EXPECT_EQ(test::error_of([] {
              detail::XmlText(nested(60000), "r.urdf", {"a URDF", "robot"});
            }),
            "r.urdf:201: elements are nested too deeply");
}

}  // namespace
}  // namespace kinecal
