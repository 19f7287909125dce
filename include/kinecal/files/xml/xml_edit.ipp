// Edits the text of an XML file and leaves every other byte unchanged.
//
// An XML library that writes its tree loses line ends, indentation, and the order and quotes of
// attributes.  Here the tree only gives the position of an element.  Its start tag is scanned in
// the text, and the edits are made there.  The text is well-formed, because the library has already
// parsed it.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "kinecal/files/diagnostics.hpp"

namespace kinecal::detail {

inline constexpr std::string_view kXmlSpace = " \t\r\n";

/// Replaces `length` bytes at `at`; a length of zero inserts.
struct TextEdit {
  std::size_t at, length;
  std::string text;
};

/// The text with all edits made.  Edits must not overlap; insertions at one place keep their order.
[[nodiscard]] inline std::string apply_edits(std::string text, std::vector<TextEdit> edits) {
  std::stable_sort(edits.begin(), edits.end(),
                   [](const TextEdit& a, const TextEdit& b) { return a.at < b.at; });
  for (auto edit = edits.rbegin(); edit != edits.rend(); ++edit) {
    text.replace(edit->at, edit->length, edit->text);
  }
  return text;
}

/// A text (UTF-8) with the escapes that it needs inside an attribute.
[[nodiscard]] inline std::string xml_attribute_text(std::string_view text, char quote) {
  std::string escaped;
  for (const char c : text) {
    if (c == '&') {
      escaped += "&amp;";
    } else if (c == '<') {
      escaped += "&lt;";
    } else if (c == quote) {
      escaped += c == '"' ? "&quot;" : "&apos;";
    } else if (c == '\t' || c == '\n' || c == '\r') {  // as they are, they would be read as blanks
      escaped += "&#" + std::to_string(static_cast<int>(c)) + ";";
    } else {
      escaped += c;
    }
  }
  return escaped;
}

/// An attribute in the text.
struct AttributeText {
  std::string_view name;
  std::size_t begin, end;  ///< of its value, without the quotes
};

/// <name attribute="value" ... >  or  <name ... />
struct StartTag {
  std::size_t begin = 0;           ///< of '<'
  std::size_t end = 0;             ///< after '>'
  std::size_t attributes_end = 0;  ///< after the last attribute, or else the name
  bool empty = false;              ///< ends in "/>"
  char quote = '"';                ///< of the last attribute
  std::vector<AttributeText> attributes = {};

  [[nodiscard]] const AttributeText* find(std::string_view name) const {
    for (const AttributeText& attribute : attributes) {
      if (attribute.name == name) return &attribute;
    }
    return nullptr;
  }

  /// The end of an empty tag in this style: "/>" or " />".
  [[nodiscard]] std::string_view closing() const {
    return empty && end - attributes_end > 2 ? " />" : "/>";
  }
};

/// @throws InputError  if a search fails: the text is not the one that was parsed
[[nodiscard]] inline std::size_t found_in_tag(std::size_t position) {
  if (position == std::string_view::npos) throw InputError("the text ends inside an XML tag");
  return position;
}

/// The start tag at `begin`, the position of its '<'.
[[nodiscard]] inline StartTag scan_start_tag(std::string_view text, std::size_t begin) {
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

/// The end of the element that begins at `begin`: after its end tag.
[[nodiscard]] inline std::size_t element_end(std::string_view text, std::size_t begin) {
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

/// The white space before `at`, from the last line break on, for inserting a new element on its own
/// line.
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

}  // namespace kinecal::detail
