// Definitions of deciding_keys.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/files/yaml/deciding_keys.hpp"

#include <algorithm>
#include <array>

namespace kinecal::detail {

std::vector<std::string> key_words(std::string_view key) {
  std::vector<std::string> words;
  char before = '_';
  for (const char c : key) {
    const bool is_capital = c >= 'A' && c <= 'Z', is_small = c >= 'a' && c <= 'z';
    const bool was_small = before >= 'a' && before <= 'z';
    const bool was_letter = was_small || (before >= 'A' && before <= 'Z');
    if (is_small || is_capital) {
      if (!was_letter || (is_capital && was_small)) words.emplace_back();
      words.back() += is_capital ? static_cast<char>(c + 32) : c;
    }
    before = c;
  }
  return words;
}

bool has_word(const std::vector<std::string>& words, std::initializer_list<std::string_view> list) {
  return std::any_of(words.begin(), words.end(), [&](const std::string& word) {
    return std::find(list.begin(), list.end(), word) != list.end();
  });
}

KeyMeaning meaning_of_key(std::string_view key) {
  const std::vector<std::string> words = key_words(key);
  if (has_word(words, {"queue", "buffer", "window", "font", "cache", "history", "line", "debug"})) {
    return KeyMeaning::other;  // of a program, not of a thing
  }
  const auto distorts = [](const std::string& word) {
    return word.starts_with("distor") || word.starts_with("coef") || word == "radial" ||
           word == "tangential" || word == "kc" || word == "distcoeffs" || word == "distcoeff";
  };
  if (std::any_of(words.begin(), words.end(), distorts)) return KeyMeaning::distortion;
  if (has_word(words, {"spacing", "spacings", "gap", "gaps", "separation"})) {
    return KeyMeaning::spacing;
  }
  if (has_word(words, {"size", "sizes", "length", "lengths", "width", "height", "side", "square",
                       "squares", "diameter", "radius", "dimension", "dimensions", "dims",
                       "resolution", "squaresize", "tagsize", "markersize", "imagesize"})) {
    return KeyMeaning::size;
  }
  if (has_word(words, {"unit", "units", "scale", "scaling", "mm", "cm", "inch", "inches", "degrees",
                       "degree", "radians", "metres", "meters", "metre", "millimetres",
                       "millimeters", "millimetre", "millimeter"})) {
    return KeyMeaning::unit;
  }
  return KeyMeaning::other;
}

std::string text_of(KeyMeaning meaning) {
  constexpr std::array<const char*, 5> kTexts = {"", "a distortion", "a size", "a spacing",
                                                 "a unit or scale"};
  return kTexts[static_cast<std::size_t>(meaning)];
}

}  // namespace kinecal::detail
