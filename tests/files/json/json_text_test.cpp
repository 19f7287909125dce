// SPDX-License-Identifier: Apache-2.0
#include "kinecal/files/json/json_text.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

namespace kinecal::detail {
namespace {

TEST(JsonText, ByLinesHasFieldsAndItemsOnTheirLines) {
  const Json json = {{"verdict", "good"},
                     {"reasons", Json::array({"few samples"})},
                     {"none", Json::array()},
                     {"images", Json::object()},
                     {"steps", Json::array({{{"name", "a"}, {"costs", {1.0, 0.5}}}})},
                     {"parameters", Json::array({{{"name", "elbow"}, {"sigma", nullptr}}})},
                     {"covariance", {{"lower", Json::array({{1.0}, {0.25, 1e-9}})}}}};
  EXPECT_EQ(json_lines(json), R"({
  "verdict": "good",
  "reasons": [
    "few samples"
  ],
  "none": [],
  "images": {},
  "steps": [
    {
      "name": "a",
      "costs": [1, 0.5]
    }
  ],
  "parameters": [
    {"name": "elbow", "sigma": null}
  ],
  "covariance": {
    "lower": [
      [1],
      [0.25, 1e-09]
    ]
  }
}
)");
}

TEST(JsonText, ReadsBackTheSameNumbersAndKeepsTheOrder) {
  const std::vector<double> numbers = {0.1, 1.0 / 3.0, -0.0, 5e-324, 1.7976931348623157e308, 1e22};
  const Json json = {{"z", numbers}, {"a", 1}};
  for (const std::string& text : {json_text(json), json_lines(json)}) {
    const Json read = Json::parse(text);
    EXPECT_EQ(read["z"].get<std::vector<double>>(), numbers);
    EXPECT_EQ(read.begin().key(), "z");
  }
}

TEST(JsonText, IsNullForWhatIsNotFinite) {
  const double infinity = std::numeric_limits<double>::infinity();
  const Json json = Json::array({std::nan(""), infinity, -infinity});
  EXPECT_EQ(json_text(json), "[null,null,null]");
  EXPECT_EQ(json_lines(json), "[\n  null,\n  null,\n  null\n]\n");
}

TEST(JsonText, IsUtf8WhateverTheBytesAre) {
  EXPECT_EQ(json_text("a\xFF\n"), "\"a\xEF\xBF\xBD\\n\"");
  EXPECT_EQ(json_lines({{"\xC3", 1}}), "{\n  \"\xEF\xBF\xBD\": 1\n}\n");
}

TEST(JsonText, InHtmlCannotEndAScript) {
  EXPECT_EQ(json_in_html("</script>&\xE2\x80\xA8"), R"("\u003c/script\u003e\u0026\u2028")");
}

}  // namespace
}  // namespace kinecal::detail
