// Keys whose names say that they decide the result: a distortion, a size, a spacing, a unit.
//
// If a reader does not know such a key, what it says would be lost, and the result would be wrong by
// all of it.  So it is an error in every file, where another unknown key is a warning.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <initializer_list>
#include <string>
#include <string_view>
#include <vector>

#include "kinecal/text/nearest_name.hpp"

namespace kinecal::detail {

/// What a key's name is about.
enum class KeyMeaning { other, distortion, size, spacing, unit };

/// The words of a key in small letters: "squareLength" and "square_length" are "square", "length".
[[nodiscard]] inline std::vector<std::string> key_words(std::string_view key) {
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

/// True if one of the words is in a list.
[[nodiscard]] inline bool has_word(const std::vector<std::string>& words,
                                   std::initializer_list<std::string_view> list) {
  return std::any_of(words.begin(), words.end(), [&](const std::string& word) {
    return std::find(list.begin(), list.end(), word) != list.end();
  });
}

[[nodiscard]] inline KeyMeaning meaning_of_key(std::string_view key) {
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

/// "a size", for messages.
[[nodiscard]] inline std::string text_of(KeyMeaning meaning) {
  constexpr std::array<const char*, 5> kTexts = {"", "a distortion", "a size", "a spacing",
                                                 "a unit or scale"};
  return kTexts[static_cast<std::size_t>(meaning)];
}

/// "; did you mean 'size'?": the nearest known key, or else the nearest one of the same meaning;
/// empty if absent.  A limit or the name of a model is not meant by
/// what is none.
template <class Names>
[[nodiscard]] std::string meant_by_key(std::string_view key, const Names& known) {
  const std::string near = did_you_mean(key, known);
  const KeyMeaning meaning = meaning_of_key(key);
  if (!near.empty() || meaning == KeyMeaning::other) return near;
  const auto is_limit = [](std::string_view name) {
    return has_word(key_words(name), {"min", "max", "model"});
  };
  const std::string* best = nullptr;
  for (const std::string& name : known) {
    if (meaning_of_key(name) != meaning || is_limit(name) != is_limit(key)) continue;
    if (best == nullptr || edit_distance(key, name) < edit_distance(key, *best)) best = &name;
  }
  return best == nullptr ? "" : "; did you mean '" + *best + "'?";
}

}  // namespace kinecal::detail
