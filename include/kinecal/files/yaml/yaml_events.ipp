// YAML text as events: documents, maps, lists and scalars in text order, each with its line.
// libyaml parses; no tree is built.
//
// Beyond libyaml: a document may follow `...` without `---` (YAML 1.2), an alias must have its
// anchor in the same document, and the depth is limited, so that no text exhausts memory.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>
#include <yaml.h>

#include <algorithm>
#include <concepts>
#include <new>
#include <set>
#include <string>
#include <string_view>

#include "kinecal/files/yaml/yaml_pieces.ipp"

namespace kinecal::detail {

/// Receives the events of documents.  Keys and values of a map alternate; `ends` ends what
/// `map_starts` or `list_starts` began.  Lines count from 1; a text is valid only during the call.
template <class H>
concept YamlHandler = requires(H& handler, int line, std::string_view text) {
  handler.document_starts();
  handler.null(line);  // empty, ~ or null
  handler.scalar(line, text);
  handler.alias(line);
  handler.list_starts(line);
  handler.map_starts(line);
  handler.ends();
};

class YamlEvents {
 public:
  /// Most lists and maps inside one another.
  static constexpr int kDeepest = 500;

  /// @param text        UTF-8, or UTF-16 with a byte order mark; must outlive this
  /// @param first_line  the line of its first character
  explicit YamlEvents(std::string_view text, int first_line = 1)
      : rest_(text), next_line_(first_line) {
    begin_part();
  }
  ~YamlEvents() { yaml_parser_delete(&parser_); }
  YamlEvents(const YamlEvents&) = delete;
  YamlEvents& operator=(const YamlEvents&) = delete;

  /// Passes the next document to the handler.
  /// @return            false at the end of the text
  /// @throws YamlError  if the text is not YAML there; nothing after it can be read
  template <YamlHandler H>
  bool next_document(H& handler) {
    for (;;) {
      Event event;
      if (yaml_parser_parse(&parser_, &event) == 0) fail();
      const int line = line_of(event.start_mark);
      anchor_ = tag_ = {};
      switch (event.type) {
        case YAML_DOCUMENT_START_EVENT:
          anchors_.clear();
          depth_ = 0;
          handler.document_starts();
          break;
        case YAML_SCALAR_EVENT:
          note(event.data.scalar.anchor, event.data.scalar.tag);
          if (is_null(event)) {
            handler.null(line);
          } else {
            handler.scalar(line, text_of(event));
          }
          break;
        case YAML_SEQUENCE_START_EVENT:
          note(event.data.sequence_start.anchor, event.data.sequence_start.tag);
          deeper(line);
          handler.list_starts(line);
          break;
        case YAML_MAPPING_START_EVENT:
          note(event.data.mapping_start.anchor, event.data.mapping_start.tag);
          deeper(line);
          handler.map_starts(line);
          break;
        case YAML_SEQUENCE_END_EVENT:
        case YAML_MAPPING_END_EVENT:
          --depth_;
          handler.ends();
          break;
        case YAML_ALIAS_EVENT:
          anchor_ = text_of(event.data.alias.anchor);
          check_alias(line);
          handler.alias(line);
          break;
        case YAML_DOCUMENT_END_EVENT:
          return true;
        case YAML_STREAM_END_EVENT:
          if (rest_.empty()) return false;
          begin_part();
          break;
        default:
          break;
      }
    }
  }

  /// Anchor (`&name`, or the name after an alias's `*`) and tag (`!name`) of the current event;
  /// empty if absent.  Valid only during the call.
  [[nodiscard]] std::string_view anchor() const { return anchor_; }
  [[nodiscard]] std::string_view tag() const { return tag_; }

 private:
  struct Event : yaml_event_t {
    Event() : yaml_event_t{} {}
    ~Event() { yaml_event_delete(this); }
    Event(const Event&) = delete;
    Event& operator=(const Event&) = delete;
  };

  [[nodiscard]] static std::string_view text_of(const yaml_char_t* text) {
    return reinterpret_cast<const char*>(text);
  }
  [[nodiscard]] static std::string_view text_of(const yaml_event_t& event) {
    return {reinterpret_cast<const char*>(event.data.scalar.value), event.data.scalar.length};
  }
  [[nodiscard]] static bool is_null(const yaml_event_t& event) {
    if (event.data.scalar.style != YAML_PLAIN_SCALAR_STYLE) return false;
    const std::string_view text = text_of(event);
    if (text.empty()) return true;
    const bool word = text == "~" || text == "null" || text == "Null" || text == "NULL";
    return word && event.data.scalar.tag == nullptr;
  }

  /// libyaml requires `---` after `...`, so each part up to a `...` gets a parser.
  void begin_part() {
    const std::string_view before = rest_;
    line_ = next_line_;
    part_ = take_yaml_part(rest_);
    const auto taken = before.substr(0, before.size() - rest_.size());
    next_line_ += static_cast<int>(std::count(taken.begin(), taken.end(), '\n'));
    yaml_parser_delete(&parser_);
    if (yaml_parser_initialize(&parser_) == 0) throw std::bad_alloc();
    if (part_.empty()) part_ = "";  // libyaml requires an address
    yaml_parser_set_input_string(&parser_, reinterpret_cast<const unsigned char*>(part_.data()),
                                 part_.size());
  }

  [[nodiscard]] int line_of(const yaml_mark_t& mark) const {
    return line_ + static_cast<int>(mark.line);
  }

  void note(const yaml_char_t* anchor, const yaml_char_t* tag) {
    if (tag != nullptr) tag_ = text_of(tag);
    if (anchor == nullptr) return;
    anchor_ = text_of(anchor);
    anchors_.emplace(anchor_);
  }
  void check_alias(int line) const {
    if (!anchors_.contains(anchor_)) {
      throw YamlError(line, fmt::format("the alias '*{}' has no anchor", anchor_));
    }
  }
  void deeper(int line) {
    if (++depth_ > kDeepest) throw YamlError(line, "lists and maps are nested too deeply");
  }

  [[noreturn]] void fail() const {
    if (parser_.error == YAML_MEMORY_ERROR) throw std::bad_alloc();
    const std::string problem = parser_.problem != nullptr ? parser_.problem : "it cannot be read";
    if (parser_.error == YAML_READER_ERROR) {  // has no mark, only an offset
      const std::string_view before = part_.substr(0, parser_.problem_offset);
      throw YamlError(line_ + static_cast<int>(std::count(before.begin(), before.end(), '\n')),
                      problem);
    }
    const int line = line_of(parser_.problem_mark);
    if (parser_.context == nullptr) throw YamlError(line, problem);
    const int begin = line_of(parser_.context_mark);
    throw YamlError(line, fmt::format("{} {}{}", problem, parser_.context,
                                      begin < line ? fmt::format(" from line {}", begin) : ""));
  }

  std::string_view part_, rest_;  ///< the part being read, and the rest
  int line_ = 1, next_line_;      ///< of their first characters
  yaml_parser_t parser_{};
  std::set<std::string, std::less<>> anchors_;  ///< of this document
  std::string_view anchor_, tag_;               ///< of this event
  int depth_ = 0;
};

}  // namespace kinecal::detail
