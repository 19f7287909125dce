// The text of an XML file beside its tree: errors name the line, and each element of the tree has a
// position in the text.
//
// The tree is parsed as UTF-8, byte for byte, so the offset of an element in the tree is its offset
// in the text.  White space in attributes is normalized as in the XML specification: a tab or a
// line break is a space, several are one.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <iterator>
#include <pugixml.hpp>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "kinecal/files/diagnostics.hpp"
#include "kinecal/files/xml/xml_edit.ipp"

namespace kinecal::detail {

/// The expected kind of an XML file, such as "a URDF", and the name of its root, such as "robot".
struct XmlKind {
  std::string what, root;
};

class XmlText {
 public:
  /// @param file  name of the file for messages
  /// @throws InputError  if the text is empty, not XML, not UTF-8, nested too deeply, has too many attributes or another root
  XmlText(std::string text, std::string file, const XmlKind& kind)
      : text_(std::move(text)), file_(std::move(file)) {
    if (text_.starts_with("\xFF\xFE") || text_.starts_with("\xFE\xFF")) {
      throw InputError(file_ + ": the text is UTF-16; save it as UTF-8");
    }
    if (text_.find_first_not_of(kXmlSpace) == std::string::npos) {
      throw InputError(file_ + ": the file is empty; " + kind.what + " has a <" + kind.root +
                       "> element");
    }
    for (std::size_t at = text_.find('\n'); at != std::string::npos;
         at = text_.find('\n', at + 1)) {
      line_ends_.push_back(at);
    }
    const pugi::xml_parse_result result = document_.load_buffer(
        text_.data(), text_.size(), pugi::parse_default | pugi::parse_wnorm_attribute,
        pugi::encoding_utf8);
    if (!result) {
      const SourceLocation place{file_, line(static_cast<std::size_t>(result.offset))};
      throw InputError(place.str() + ": malformed XML: " + result.description());
    }
    check_size();
    if (root().name() != kind.root) {
      throw InputError(place(root()).str() + ": the root element is <" + root().name() + ">; " +
                       kind.what + " begins with <" + kind.root + ">");
    }
  }

  [[nodiscard]] const std::string& text() const { return text_; }
  [[nodiscard]] const std::string& file() const { return file_; }
  [[nodiscard]] pugi::xml_node root() const { return document_.document_element(); }

  /// Position of an element's '<' in the text.
  [[nodiscard]] std::size_t offset(pugi::xml_node element) const {
    return static_cast<std::size_t>(element.offset_debug()) - 1;
  }

  /// File and line of an element; the file as a whole for a null node.
  [[nodiscard]] SourceLocation place(pugi::xml_node element) const {
    return {file_, element ? line(offset(element)) : 0};
  }

 private:
  /// Readers of the same text, such as urdfdom, take an element inside another by recursion, and compare
  /// each attribute of an element with all others.
  void check_size() {
    struct Walker : pugi::xml_tree_walker {
      bool for_each(pugi::xml_node& node) override {
        constexpr int kDeepest = 200;
        constexpr std::ptrdiff_t kMostAttributes = 1000;
        const auto attributes = node.attributes();
        if (depth() >= kDeepest) wrong = "elements are nested too deeply";
        if (std::distance(attributes.begin(), attributes.end()) > kMostAttributes) {
          wrong = std::string("<") + node.name() + "> has more than 1000 attributes";
        }
        element = node;
        return wrong.empty();
      }
      pugi::xml_node element;
      std::string wrong;
    } walker;
    if (!document_.traverse(walker)) {
      throw InputError(place(walker.element).str() + ": " + walker.wrong);
    }
  }

  [[nodiscard]] int line(std::size_t offset) const {
    const auto end = std::lower_bound(line_ends_.begin(), line_ends_.end(), offset);
    return 1 + static_cast<int>(end - line_ends_.begin());
  }

  std::string text_, file_;
  std::vector<std::size_t> line_ends_;  ///< positions of '\n'
  pugi::xml_document document_;
};

}  // namespace kinecal::detail
