#include "kinecal/files/yaml/yaml_text.hpp"

#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <random>
#include <string>
#include <vector>

namespace kinecal {
namespace {

using namespace detail;

/// Numbers of every size and both signs, subnormal ones included, from random bits.
std::vector<double> difficult_numbers() {
  using Limits = std::numeric_limits<double>;
  std::vector<double> numbers = {
      0.0,         -0.0,   1.0,     -1.0,   0.1,  1e-5,          1e16,
      123456789.0, 0.0015, 1.1e-03, 1.0247, 1e22, Limits::max(), Limits::denorm_min()};
  std::mt19937_64 random(1);
  while (numbers.size() < 20000) {
    const std::uint64_t bits = random();
    double number = 0.0;
    std::memcpy(&number, &bits, sizeof number);
    if (std::isfinite(number)) numbers.push_back(number);
  }
  std::uniform_real_distribution<double> metres(-2.0, 2.0);
  for (int i = 0; i < 20000; ++i) numbers.push_back(metres(random));
  return numbers;
}

TEST(YamlText, NumbersReadBackAsTheSameDouble) {
  for (const double number : difficult_numbers()) {
    const std::string text = number_to_yaml(number);
    ASSERT_EQ(number_from_yaml(text), number) << text;
    ASSERT_NE(text.find('.'), std::string::npos) << text;
  }
  EXPECT_TRUE(std::signbit(*number_from_yaml(number_to_yaml(-0.0))));
}

TEST(YamlText, NumbersAreWrittenAsPeopleWriteThem) {
  EXPECT_EQ(number_to_yaml(0.0), "0.0");
  EXPECT_EQ(number_to_yaml(-320.5), "-320.5");
  EXPECT_EQ(number_to_yaml(0.0001), "0.0001");
  EXPECT_EQ(number_to_yaml(1e-5), "1.0e-05");
  EXPECT_EQ(number_to_yaml(std::nan("")), ".nan");
  EXPECT_EQ(number_to_yaml(-std::numeric_limits<double>::infinity()), "-.inf");
}

TEST(YamlText, NumbersAreReadInEveryUsualForm) {
  EXPECT_EQ(number_from_yaml("+1.5"), 1.5);
  EXPECT_EQ(number_from_yaml("-1"), -1.0);
  EXPECT_EQ(number_from_yaml("1."), 1.0);
  EXPECT_EQ(number_from_yaml("-.5E+1"), -5.0);
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  for (const char* text : {"inf", ".inf", "+.inf", ".Inf", ".INF", "+inf"}) {
    EXPECT_EQ(number_from_yaml(text), kInfinity) << text;
  }
  EXPECT_EQ(number_from_yaml("-.inf"), -kInfinity);
  for (const char* text : {"nan", ".nan", ".NaN", ".NAN", "-nan"}) {
    ASSERT_TRUE(number_from_yaml(text)) << text;
    EXPECT_TRUE(std::isnan(*number_from_yaml(text))) << text;
  }
}

TEST(YamlText, WhatIsNotANumberAsAWholeIsRefused) {
  for (const char* text : {"", " ", "a", "1a", "1 2", "+-1", "--1", "0x10", "1_000", "1,5", "1e400",
                           "...", "-", ".", "+", "1e", "..5"}) {
    EXPECT_EQ(number_from_yaml(text), std::nullopt) << text;
  }
}

TEST(YamlText, MillimetresReadBackAsTheSameMetres) {
  for (const double metres : difficult_numbers()) {
    if (std::abs(metres) > 1e305) continue;  // in millimetres it does not fit into a double
    const std::string text = millimetres_from_metres(metres);
    ASSERT_EQ(metres_from_millimetres(text), metres) << text;
  }
}

TEST(YamlText, MillimetresAreMetresWithTheDecimalPointMoved) {
  EXPECT_EQ(metres_from_millimetres("1.5"), 0.0015);
  EXPECT_EQ(metres_from_millimetres("-12.3e+0"), -0.0123);
  EXPECT_EQ(metres_from_millimetres("1E3"), 1.0);
  EXPECT_EQ(metres_from_millimetres("x"), std::nullopt);
  EXPECT_TRUE(std::isnan(*metres_from_millimetres(".nan")));
  EXPECT_EQ(millimetres_from_metres(-0.0123), "-12.3");
  EXPECT_EQ(millimetres_from_metres(0.0), "0.0");
}

TEST(YamlText, NamesReadBackAsTheSameString) {
  for (const std::string name : {"camera",
                                 "/base/link_1.x-2",
                                 "",
                                 "null",
                                 "True",
                                 "no",
                                 "y",
                                 "~",
                                 "12",
                                 "-a",
                                 "a b",
                                 "a: b",
                                 "a#b",
                                 "[a]",
                                 "{a",
                                 "*a",
                                 "&a",
                                 "\"quoted\"",
                                 "it's",
                                 "back\\slash",
                                 "line\nbreak\ttab",
                                 "\xc3\xa9t\xc3\xa9",
                                 "trailing ",
                                 "1.0",
                                 ".nan",
                                 "---"}) {
    const YAML::Node node = YAML::Load("[" + name_to_yaml(name) + "]");
    ASSERT_TRUE(node[0].IsScalar()) << name;
    EXPECT_EQ(node[0].as<std::string>(), name);
  }
}

TEST(YamlText, LineBreaksAndControlsOfUnicodeAreEscaped) {
  const std::string name = "a\xc2\x85\xe2\x80\xa8\xe2\x80\xa9\xef\xbb\xbf\xc3\x85\xc2\xa0";
  EXPECT_EQ(name_to_yaml(name), "\"a\\x85\\u2028\\u2029\\ufeff\xc3\x85\xc2\xa0\"");
  EXPECT_EQ(YAML::Load(name_to_yaml(name)).as<std::string>(), name);
}

TEST(YamlText, NamesAreQuotedOnlyWhereAnotherReaderCouldMistakeThem) {
  EXPECT_EQ(name_to_yaml("shoulder_pan_joint"), "shoulder_pan_joint");
  EXPECT_EQ(name_to_yaml("off"), "\"off\"");
  EXPECT_EQ(name_to_yaml("7"), "\"7\"");
  EXPECT_EQ(name_to_yaml(""), "''");
}

}  // namespace
}  // namespace kinecal
