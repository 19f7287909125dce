// Changes to the text of an XML file that leave every other byte as it is.
//
// An XML library that writes a tree back loses what the tree does not hold: the order and quotes of
// attributes, line ends, indentation.  Here the tree says only where an element begins; its start
// tag is scanned in the text, and the edits are made there.  The text is well-formed: the library
// has read it.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "kinecal/io/diagnostics.hpp"

namespace kinecal {

inline constexpr std::string_view kXmlSpace = " \t\r\n";

/// Replaces `length` bytes at `at`; a length of zero inserts.
struct TextEdit {
  std::size_t at, length;
  std::string text;
};

/// The text with all edits made; they must not overlap.  What is inserted at the same place comes
/// in the order given.
[[nodiscard]] inline std::string apply_edits(std::string text, std::vector<TextEdit> edits) {
  std::stable_sort(edits.begin(), edits.end(),
                   [](const TextEdit& a, const TextEdit& b) { return a.at < b.at; });
  for (auto edit = edits.rbegin(); edit != edits.rend(); ++edit) {
    text.replace(edit->at, edit->length, edit->text);
  }
  return text;
}

/// An attribute in the text; begin and end: of its value, without the quotes.
struct AttributeText {
  std::string_view name;
  std::size_t begin, end;
};

/// <name attribute="value" ... >  or  <name ... />
struct StartTag {
  std::size_t begin = 0;           ///< of '<'
  std::size_t end = 0;             ///< behind '>'
  std::size_t attributes_end = 0;  ///< behind the last attribute, or the name
  bool empty = false;              ///< ends in "/>"
  char quote = '"';                ///< of the last attribute
  std::vector<AttributeText> attributes = {};

  [[nodiscard]] const AttributeText* find(std::string_view name) const {
    for (const AttributeText& attribute : attributes) {
      if (attribute.name == name) return &attribute;
    }
    return nullptr;
  }

  /// How this tag ends, for others to be written alike: "/>" or " />".
  [[nodiscard]] std::string_view closing() const {
    return empty && end - attributes_end > 2 ? " />" : "/>";
  }
};

namespace detail {

/// @throws InputError  if something was not found: the text is not what was parsed
[[nodiscard]] inline std::size_t found_in_tag(std::size_t position) {
  if (position == std::string_view::npos) throw InputError("an XML tag ends in its middle");
  return position;
}

}  // namespace detail

/// The start tag at `begin`, where its '<' stands.
[[nodiscard]] inline StartTag scan_start_tag(std::string_view text, std::size_t begin) {
  using detail::found_in_tag;
  StartTag tag;
  tag.begin = begin;
  std::size_t at = tag.attributes_end = found_in_tag(text.find_first_of(" \t\r\n/>", begin));
  while (true) {
    at = found_in_tag(text.find_first_not_of(kXmlSpace, at));
    tag.empty = text[at] == '/';
    if (tag.empty || text[at] == '>') break;
    const std::size_t name_end = found_in_tag(text.find_first_of(" \t\r\n=", at));
    const std::size_t open = found_in_tag(text.find_first_of("\"'", name_end));
    const std::size_t close = found_in_tag(text.find(text[open], open + 1));
    tag.attributes.push_back({text.substr(at, name_end - at), open + 1, close});
    tag.quote = text[open];
    at = tag.attributes_end = close + 1;
  }
  tag.end = at + (tag.empty ? 2 : 1);
  return tag;
}

/// Where the element that begins at `begin` ends: behind its end tag.
[[nodiscard]] inline std::size_t element_end(std::string_view text, std::size_t begin) {
  using detail::found_in_tag;
  const auto behind = [&](std::string_view mark, std::size_t from) {
    return found_in_tag(text.find(mark, from)) + mark.size();
  };
  std::size_t at = begin;
  int depth = 0;
  do {
    at = found_in_tag(text.find('<', at));
    const std::string_view rest = text.substr(at);
    if (rest.starts_with("<!--")) {
      at = behind("-->", at + 4);
    } else if (rest.starts_with("<![CDATA[")) {
      at = behind("]]>", at);
    } else if (rest.starts_with("<?")) {
      at = behind("?>", at);
    } else if (rest.starts_with("</")) {
      at = behind(">", at);
      --depth;
    } else {
      const StartTag tag = scan_start_tag(text, at);
      at = tag.end;
      if (!tag.empty) ++depth;
    }
  } while (depth > 0);
  return at;
}

/// The white space in front of `at`, from the last line break on: what a further element on a line
/// of its own begins with.
[[nodiscard]] inline std::string line_start_before(std::string_view text, std::size_t at) {
  const std::string_view before = text.substr(0, at);
  const std::size_t last = before.find_last_not_of(kXmlSpace);
  std::string_view space = last == std::string_view::npos ? before : before.substr(last + 1);
  if (std::size_t line = space.rfind('\n'); line != std::string_view::npos) {
    if (line > 0 && space[line - 1] == '\r') --line;
    space = space.substr(line);
  }
  return std::string(space);
}

}  // namespace kinecal
