// Lists of numbers in XML attributes, such as xyz="0 0.1 0": reads them with their positions, and
// rewrites those that differ.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include "kinecal/files/xml/xml_edit.ipp"

namespace kinecal::detail {

/// A number and its position in a text.
struct NumberToken {
  std::size_t begin, end;
  double value;
};

/// The numbers of a text, separated by white space; nullopt unless all are finite numbers.
/// Independent of the locale.
[[nodiscard]] inline std::optional<std::vector<NumberToken>> number_tokens(std::string_view text) {
  std::vector<NumberToken> tokens;
  std::size_t begin = text.find_first_not_of(kXmlSpace);
  while (begin != std::string_view::npos) {
    const std::size_t end = std::min(text.find_first_of(kXmlSpace, begin), text.size());
    const bool plus = text[begin] == '+' && end > begin + 1 && text[begin + 1] != '-';
    NumberToken token{begin, end, 0.0};
    const auto [stop, error] =
        std::from_chars(text.data() + begin + (plus ? 1 : 0), text.data() + end, token.value);
    if (error != std::errc() || stop != text.data() + end || !std::isfinite(token.value)) return {};
    tokens.push_back(token);
    begin = text.find_first_not_of(kXmlSpace, end);
  }
  return tokens;
}

/// Shortest text that reads back as the same number; zero has no sign.
[[nodiscard]] inline std::string xml_number(double value) {
  return fmt::format("{}", value + 0.0);
}

/// Edits of the numbers in one start tag.
struct XmlTagEditor {
  const std::string& text;
  StartTag tag;
  std::vector<TextEdit>& edits;
  std::string added = {};  ///< attributes to be created

  /// Rewrites those numbers of an attribute that differ; creates the attribute if it is missing.
  void set(std::string_view name, std::span<const double> values) {
    std::string all;
    for (double value : values) all += (all.empty() ? "" : " ") + xml_number(value);
    const AttributeText* attribute = tag.find(name);
    if (attribute == nullptr) {
      added += fmt::format(" {}={}{}{}", name, tag.quote, all, tag.quote);
      return;
    }
    const std::size_t length = attribute->end - attribute->begin;
    const auto tokens = number_tokens(std::string_view(text).substr(attribute->begin, length));
    if (!tokens || tokens->size() != values.size()) {  // written with character references
      edits.push_back({attribute->begin, length, all});
      return;
    }
    for (std::size_t i = 0; i < values.size(); ++i) {
      const auto& [begin, end, value] = (*tokens)[i];
      if (value == values[i]) continue;
      edits.push_back({attribute->begin + begin, end - begin, xml_number(values[i])});
    }
  }

  /// A new, empty element with the attributes created.
  [[nodiscard]] std::string element(const std::string& name) const {
    return "<" + name + added + std::string(tag.closing());
  }

  /// Adds the attributes created to the tag.
  void finish() {
    if (!added.empty()) edits.push_back({tag.attributes_end, 0, added});
  }
};

}  // namespace kinecal::detail
