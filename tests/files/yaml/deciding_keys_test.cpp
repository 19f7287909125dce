#include "kinecal/files/yaml/deciding_keys.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace kinecal::detail {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

TEST(DecidingKeys, ConsistOfWords) {
  EXPECT_THAT(key_words("squareLength"), ElementsAre("square", "length"));
  EXPECT_THAT(key_words("SQUARE_LENGTH_2"), ElementsAre("square", "length"));
  EXPECT_THAT(key_words("tag.size-x"), ElementsAre("tag", "size", "x"));
  EXPECT_THAT(key_words("12"), IsEmpty());
}

TEST(DecidingKeys, AreAboutALensASizeASpacingOrAUnit) {
  for (const char* key : {"distortion", "distorsion", "dist_coeffs", "distCoeff", "radial", "kc",
                          "distortion_coefs", "lens_distortion_parameters"}) {
    EXPECT_EQ(meaning_of_key(key), KeyMeaning::distortion) << key;
  }
  for (const char* key : {"size", "squareSize", "tag_size", "width", "marker_length", "diameter"}) {
    EXPECT_EQ(meaning_of_key(key), KeyMeaning::size) << key;
  }
  for (const char* key : {"spacing", "tagSpacing", "gap"}) {
    EXPECT_EQ(meaning_of_key(key), KeyMeaning::spacing) << key;
  }
  for (const char* key : {"unit", "units", "scale", "in_mm", "degrees"}) {
    EXPECT_EQ(meaning_of_key(key), KeyMeaning::unit) << key;
  }
  for (const char* key : {"queue_size", "window_length", "topic", "max_distance", "undisturbed",
                          "colour", "mode", "", "pitch"}) {
    EXPECT_EQ(meaning_of_key(key), KeyMeaning::other) << key;
  }
}

TEST(DecidingKeys, SuggestAKeyOfTheSameMeaning) {
  const std::vector<std::string> known = {"columns", "size", "spacing"};
  EXPECT_EQ(meant_by_key("tag_side", known), "; did you mean 'size'?");
  EXPECT_EQ(meant_by_key("gap", known), "; did you mean 'spacing'?");
  EXPECT_EQ(meant_by_key("colums", known), "; did you mean 'columns'?");
  EXPECT_EQ(meant_by_key("unit", known), "");
  EXPECT_EQ(meant_by_key("colour", known), "");
}

}  // namespace
}  // namespace kinecal::detail
