// YAML documents as trees of values, each with its line.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace kinecal::detail {

/// A value of a YAML document; owns all values below it.  An alias is a copy.
struct YamlNode {
  /// Kinds of nodes.
  enum class Kind : std::uint8_t { null, scalar, list, map };

  Kind kind = Kind::null;       ///< of this node
  int line = 0;                 ///< from 1; that of the anchor for an alias; 0 without a document
  std::string text;             ///< of a scalar, without quotes
  std::string tag;              ///< "!degrees" of `!degrees 90`; empty without a tag
  std::vector<YamlNode> keys;   ///< of a map, in the order of the file; a key may occur twice
  std::vector<YamlNode> items;  ///< of a list; of a map the values, in the order of the keys

  [[nodiscard]] bool is_null() const { return kind == Kind::null; }      ///< no value
  [[nodiscard]] bool is_scalar() const { return kind == Kind::scalar; }  ///< one text
  [[nodiscard]] bool is_list() const { return kind == Kind::list; }      ///< has items
  [[nodiscard]] bool is_map() const { return kind == Kind::map; }        ///< has keys and items

  /// The value of a map's first key of this name; nullptr without one, and if this is not a map.
  [[nodiscard]] const YamlNode* find(std::string_view key) const;
};

/// Largest size of a file that becomes a tree, and of the tree, bytes.
inline constexpr std::size_t kMostYamlBytes = std::size_t{1} << 27;

/// The text of a YAML file.
/// @throws InputError  if it cannot be read or is larger than kMostYamlBytes
[[nodiscard]] std::string read_yaml_text(const std::string& path);

/// All documents of a text.
/// @param path         of the file, for messages
/// @throws InputError  "path:line: ..." if the text is not YAML, lists and maps are nested more
///                     than 500 deep, or the tree is larger than kMostYamlBytes
[[nodiscard]] std::vector<YamlNode> parse_yaml(std::string_view text, const std::string& path);

}  // namespace kinecal::detail
