// Follows the events of a YAML document or a message through a sample, without building a tree.
//
// The handler knows its place in the tree of sample_schema.ipp and skips unknown keys with
// everything below them.  Values go to the SampleBuilder.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "kinecal/files/samples/misspelt_keys.ipp"
#include "kinecal/files/samples/sample_builder.ipp"
#include "kinecal/files/samples/sample_schema.ipp"
#include "kinecal/files/yaml/yaml_events.ipp"

namespace kinecal::detail {

class SampleHandler {
 public:
  /// @param file  name of the file in Sample::source
  explicit SampleHandler(std::string file) : builder_(std::move(file)) {}

  [[nodiscard]] std::vector<Sample> take() { return std::move(samples_); }
  [[nodiscard]] SampleBuilder& builder() { return builder_; }
  /// True inside something unknown: its content may be omitted.
  [[nodiscard]] bool skips() const { return skipped_ > 0; }
  [[nodiscard]] bool last_document_is_empty() const { return last_document_is_empty_; }

  void document_starts() {
    levels_.clear();
    skipped_ = 0;
    last_document_is_empty_ = false;
    errors_before_ = builder_.errors().errors.size();
  }

  void null(int line) {
    if (levels_.empty() && skipped_ == 0) {
      last_document_is_empty_ = true;
      return;
    }
    // The parser may already be on a later line; users look for the line of the key.
    const bool is_value = !levels_.empty() && levels_.back().is_map && !at_key();
    const SampleNode node = next_node();
    if (node != SampleNode::unknown) null(node, is_value ? key_line_ : line);
  }

  void alias(int line) {
    const SampleNode node = next_node();
    if (node == SampleNode::unknown) return;
    error(node, line, "an alias (*) is not supported here; write the value in its place");
  }

  void scalar(int line, std::string_view text) {
    if (skipped_ > 0) return;
    if (at_key()) return key(line, text);
    const SampleNode node = next_node();
    if (node != SampleNode::unknown) scalar(node, line, text);
  }

  /// A number of a message.  It reaches the sample unchanged; if something else is expected, its
  /// text is used.
  template <class X>
  void number(int line, X x) {
    const SampleNode node = next_node();
    if (node == SampleNode::unknown) return;
    if (sample_rule(node).kind == SampleNodeKind::number) {
      builder_.number(node, line, static_cast<double>(x));
    } else {
      scalar(node, line, fmt::format("{}", x));
    }
  }

  void list_starts(int line) { start(line, SampleNodeKind::list); }
  void map_starts(int line) { start(line, SampleNodeKind::map); }

  void ends() {
    if (skipped_ == 0) return finish();
    --skipped_;
  }

 private:
  struct Level {
    SampleNode node;
    bool is_map, at_key;
    int line;  ///< where it began, from 1
  };

  [[nodiscard]] bool at_key() const { return !levels_.empty() && levels_.back().at_key; }

  /// The node of the current value; advances to the next one.
  [[nodiscard]] SampleNode next_node() {
    if (skipped_ > 0) return SampleNode::unknown;
    if (levels_.empty()) return SampleNode::sample;
    Level& level = levels_.back();
    if (!level.is_map) return sample_child(level.node, "");
    if (level.at_key) {  // a key that is not a word: skipped with its value
      level.at_key = false;
      value_node_ = SampleNode::unknown;
      return SampleNode::unknown;
    }
    level.at_key = true;
    return std::exchange(value_node_, SampleNode::unknown);
  }

  void scalar(SampleNode node, int line, std::string_view text) {
    if (sample_is_scalar(node)) return builder_.scalar(node, line, text);
    error(node, line, fmt::format("{} is not a {}", shown(text), kind_name(node)));
  }

  void key(int line, std::string_view text) {
    Level& level = levels_.back();
    level.at_key = false;
    key_line_ = line;
    value_node_ = text.empty() ? SampleNode::unknown : sample_child(level.node, text);
    if (value_node_ == SampleNode::unknown)
      return doubt_sample_key(builder_.errors(), level.node, line, text);
    if (sample_has_free_keys(level.node)) return builder_.key(value_node_, line, text);
    if ((seen_ & sample_bit(value_node_)) != 0) {
      error(level.node, line,
            fmt::format("key '{}' occurs twice; is a '---' missing between samples?", text));
    }
    seen_ |= sample_bit(value_node_);
  }

  void start(int line, SampleNodeKind kind) {
    const SampleNode node = next_node();
    if (node == SampleNode::unknown || sample_rule(node).kind != kind) {
      ++skipped_;
      if (node != SampleNode::unknown) {
        error(node, line,
              fmt::format("expected a {}, found a {}", kind_name(node),
                          kind == SampleNodeKind::map ? "map" : "list"));
      }
      return;
    }
    begin(node, line);
  }

  void begin(SampleNode node, int line) {
    seen_ &= ~sample_children(node).bits;
    const bool is_map = sample_rule(node).kind == SampleNodeKind::map;
    levels_.push_back({node, is_map, is_map, line});
    builder_.begin(node, line);
  }

  void finish() {
    const Level level = levels_.back();
    levels_.pop_back();
    if ((sample_children(level.node).required & ~seen_) != 0) report_missing(level);
    builder_.end(level.node, level.line);
    if (level.node == SampleNode::sample && builder_.errors().errors.size() == errors_before_) {
      samples_.push_back(builder_.take());
    }
  }

  void report_missing(const Level& level) {
    for (const SampleNodeRule& r : kSampleNodeRules) {
      if (r.required && r.parent == level.node && (seen_ & sample_bit(r.node)) == 0) {
        builder_.errors().add(level.line,
                              fmt::format("{} without '{}'", sample_name(level.node), r.key));
      }
    }
  }

  /// An empty value: an empty list, map or text; never a number.
  void null(SampleNode node, int line) {
    if (sample_is_scalar(node)) return builder_.scalar(node, line, "");
    begin(node, line);
    finish();
  }

  void error(SampleNode node, int line, const std::string& message) {
    builder_.errors().add(line, fmt::format("{}: {}", sample_name(node), message));
  }

  [[nodiscard]] static const char* kind_name(SampleNode node) {
    constexpr const char* kNames[] = {"map", "list", "word or number", "word or number"};
    return kNames[static_cast<int>(sample_rule(node).kind)];
  }

  SampleBuilder builder_;
  std::vector<Sample> samples_;
  std::vector<Level> levels_;
  std::uint64_t seen_ = 0;  ///< keys read in the open maps, see sample_bit()
  SampleNode value_node_ = SampleNode::unknown;
  int key_line_ = 0;               ///< of the last key
  int skipped_ = 0;                ///< levels of something unknown
  std::size_t errors_before_ = 0;  ///< errors when this document began
  bool last_document_is_empty_ = false;
};

static_assert(YamlHandler<SampleHandler>);

}  // namespace kinecal::detail
