#include "kinecal/text/frame_name.hpp"

#include <gtest/gtest.h>

#include <set>

namespace kinecal {
namespace {

TEST(FrameName, LosesOneLeadingSlashButForASlashAlone) {
  EXPECT_EQ(plain_frame("/px/base"), "px/base");
  EXPECT_EQ(plain_frame("px/base"), "px/base");
  EXPECT_EQ(plain_frame("/"), "/");
  EXPECT_EQ(plain_frame(""), "");
  EXPECT_EQ(plain_frame("//a"), "/a");
}

TEST(FrameName, IsTheSameWithAndWithoutTheSlash) {
  EXPECT_TRUE(same_frame("/tool", "tool"));
  EXPECT_FALSE(same_frame("/tool", "tools"));
  EXPECT_FALSE(same_frame("/", ""));
}

TEST(FrameName, IsFoundAmongOthersAsTheyAreSpelt) {
  const std::set<std::string> names = {"/board", "lamp"};
  EXPECT_EQ(*frame_among(names, "board"), "/board");
  EXPECT_EQ(*frame_among(names, "/lamp"), "lamp");
  EXPECT_EQ(frame_among(names, "tool"), nullptr);
}

}  // namespace
}  // namespace kinecal
