// Keys whose names say that they decide the result: a distortion, a size, a spacing, a unit.
//
// If a reader does not know such a key, what it says would be lost, and the result would be wrong by
// all of it.  So it is an error in every file, where another unknown key is a warning.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <initializer_list>
#include <string>
#include <string_view>
#include <vector>

#include "kinecal/text/nearest_name.hpp"

namespace kinecal::detail {

/// What a key's name is about.
enum class KeyMeaning { other, distortion, size, spacing, unit };

/// The words of a key in small letters: "squareLength" and "square_length" are "square", "length".
[[nodiscard]] std::vector<std::string> key_words(std::string_view key);

/// True if one of the words is in a list.
[[nodiscard]] bool has_word(const std::vector<std::string>& words,
                            std::initializer_list<std::string_view> list);

[[nodiscard]] KeyMeaning meaning_of_key(std::string_view key);

/// "a size", for messages.
[[nodiscard]] std::string text_of(KeyMeaning meaning);

/// "; did you mean 'size'?": the nearest known key, or else the nearest one of the same meaning;
/// empty if absent.  A key of another meaning is not proposed for a limit or the name of a model.
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
