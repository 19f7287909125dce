// The text of an XML file beside its tree: errors name the line, and each element of the tree has a
// position in the text.
//
// The tree is parsed as UTF-8, byte for byte, so the offset of an element in the tree is its offset
// in the text.  White space in attributes is normalized as in the XML specification: a tab or a
// line break is a space, several are one.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <pugixml.hpp>
#include <string>
#include <string_view>
#include <utility>

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
  /// @throws InputError  if the text is empty, not XML, not UTF-8, nested too deeply or has another root
  XmlText(std::string text, std::string file, const XmlKind& kind)
      : text_(std::move(text)), file_(std::move(file)) {
    if (text_.starts_with("\xFF\xFE") || text_.starts_with("\xFE\xFF")) {
      throw InputError(file_ + ": the text is UTF-16; save it as UTF-8");
    }
    if (text_.find_first_not_of(kXmlSpace) == std::string::npos) {
      throw InputError(file_ + ": the file is empty; " + kind.what + " has a <" + kind.root +
                       "> element");
    }
    const pugi::xml_parse_result result = document_.load_buffer(
        text_.data(), text_.size(), pugi::parse_default | pugi::parse_wnorm_attribute,
        pugi::encoding_utf8);
    if (!result) {
      const SourceLocation place{file_, line(static_cast<std::size_t>(result.offset))};
      throw InputError(place.str() + ": malformed XML: " + result.description());
    }
    check_depth();
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
  /// Readers of the same text, such as urdfdom, take an element inside another by recursion.
  void check_depth() {
    struct Walker : pugi::xml_tree_walker {
      bool for_each(pugi::xml_node& node) override {
        constexpr int kDeepest = 200;
        if (depth() < kDeepest) return true;
        too_deep = node;
        return false;
      }
      pugi::xml_node too_deep;
    } walker;
    if (!document_.traverse(walker)) {
      throw InputError(place(walker.too_deep).str() + ": elements are nested too deeply");
    }
  }

  [[nodiscard]] int line(std::size_t offset) const {
    const auto end = text_.begin() + static_cast<std::ptrdiff_t>(std::min(offset, text_.size()));
    return 1 + static_cast<int>(std::count(text_.begin(), end, '\n'));
  }

  std::string text_, file_;
  pugi::xml_document document_;
};

}  // namespace kinecal::detail
