// Follows the events of a YAML parser through a sample's document: no tree is built.
//
// The handler knows where in the tree of sample_schema.hpp it is; what it does not know it skips,
// however deep.  Values go to the SampleBuilder.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>
#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/exceptions.h>
#include <yaml-cpp/mark.h>

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "kinecal/io/samples/sample_builder.hpp"
#include "kinecal/io/samples/sample_schema.hpp"
#include "kinecal/io/yaml/yaml_documents.hpp"

namespace kinecal::detail {

class SampleHandler final : public YAML::EventHandler {
 public:
  SampleHandler(const std::string& file, Diagnostics& diagnostics) : builder_(file, diagnostics) {}

  [[nodiscard]] std::vector<Sample> take() { return std::move(samples_); }
  [[nodiscard]] SampleBuilder& builder() { return builder_; }
  [[nodiscard]] bool last_document_is_empty() const { return last_document_is_empty_; }

  /// @throws YAML::ParserException  where the parser does not move on: before a stray ',' or ']' it
  ///                                finds empty documents without end
  void OnDocumentStart(const YAML::Mark& mark) override {
    progress_.document_starts(mark);
    levels_.clear();
    skipped_ = 0;
    last_document_is_empty_ = false;
    errors_before_ = builder_.errors().count;
  }
  void OnDocumentEnd() override {}

  void OnNull(const YAML::Mark& mark, YAML::anchor_t) override {
    if (levels_.empty() && skipped_ == 0) {
      last_document_is_empty_ = true;
      return;
    }
    // The parser has moved on to what follows; the key is what the user looks for.
    const bool is_value = !levels_.empty() && levels_.back().is_map && !at_key();
    const int line = is_value ? key_line_ : mark.line + 1;
    const SampleNode node = next_node();
    if (node != SampleNode::unknown) null(node, line);
  }

  void OnAlias(const YAML::Mark& mark, YAML::anchor_t) override {
    if (skipped_ > 0) return;
    const SampleNode node = next_node();
    if (node == SampleNode::unknown) return;
    error(node, mark, "an alias (*) is not supported here; write the value in its place");
  }

  void OnScalar(const YAML::Mark& mark, const std::string&, YAML::anchor_t,
                const std::string& text) override {
    if (skipped_ > 0) return;
    if (at_key()) return key(mark, text);
    const SampleNode node = next_node();
    if (node == SampleNode::unknown) return;
    if (sample_rule(node).kind == SampleNodeKind::scalar) {
      builder_.scalar(node, mark.line + 1, text);
    } else {
      error(node, mark, fmt::format("{} is not a {}", shown(text), kind_name(node)));
    }
  }

  void OnSequenceStart(const YAML::Mark& mark, const std::string&, YAML::anchor_t,
                       YAML::EmitterStyle::value) override {
    start(mark, SampleNodeKind::list);
  }
  void OnSequenceEnd() override { finish(); }

  void OnMapStart(const YAML::Mark& mark, const std::string&, YAML::anchor_t,
                  YAML::EmitterStyle::value) override {
    start(mark, SampleNodeKind::map);
  }
  void OnMapEnd() override { finish(); }

 private:
  struct Level {
    SampleNode node;
    bool is_map, at_key;
    int line;  ///< where it began, from 1
  };

  [[nodiscard]] bool at_key() const { return !levels_.empty() && levels_.back().at_key; }

  /// The node of the value that comes now.
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

  void key(const YAML::Mark& mark, const std::string& text) {
    Level& level = levels_.back();
    level.at_key = false;
    key_line_ = mark.line + 1;
    value_node_ = text.empty() ? SampleNode::unknown : sample_child(level.node, text);
    if (value_node_ == SampleNode::unknown) return;
    if ((seen_ & sample_bit(value_node_)) != 0) {
      error(level.node, mark,
            fmt::format("key '{}' occurs twice; is a '---' missing between samples?", text));
    }
    seen_ |= sample_bit(value_node_);
  }

  void start(const YAML::Mark& mark, SampleNodeKind kind) {
    const SampleNode node = next_node();
    if (node == SampleNode::unknown || sample_rule(node).kind != kind) {
      ++skipped_;
      if (node != SampleNode::unknown) {
        error(node, mark,
              fmt::format("a {} stands here, not a {}",
                          kind == SampleNodeKind::map ? "map" : "list", kind_name(node)));
      }
      return;
    }
    begin(node, mark.line + 1);
  }

  void begin(SampleNode node, int line) {
    seen_ &= ~sample_children(node);
    const bool is_map = sample_rule(node).kind == SampleNodeKind::map;
    levels_.push_back({node, is_map, is_map, line});
    builder_.begin(node, line);
  }

  void finish() {
    if (skipped_ > 0) {
      --skipped_;
      return;
    }
    const Level level = levels_.back();
    levels_.pop_back();
    for (const SampleNodeRule& r : kSampleNodeRules) {
      if (r.required && r.parent == level.node && (seen_ & sample_bit(r.node)) == 0) {
        builder_.errors().add(level.line,
                              fmt::format("{} without '{}'", sample_name(level.node), r.key));
      }
    }
    builder_.end(level.node, level.line);
    if (level.node == SampleNode::sample && builder_.errors().count == errors_before_) {
      samples_.push_back(builder_.take());
    }
  }

  /// An empty value: an empty list, map or text; never a number.
  void null(SampleNode node, int line) {
    if (sample_rule(node).kind == SampleNodeKind::scalar) return builder_.scalar(node, line, "");
    begin(node, line);
    finish();
  }

  void error(SampleNode node, const YAML::Mark& mark, const std::string& message) {
    builder_.errors().add(mark.line + 1, fmt::format("{}: {}", sample_name(node), message));
  }

  [[nodiscard]] static const char* kind_name(SampleNode node) {
    constexpr const char* kNames[] = {"map", "list", "word or number"};
    return kNames[static_cast<int>(sample_rule(node).kind)];
  }

  SampleBuilder builder_;
  std::vector<Sample> samples_;
  std::vector<Level> levels_;
  std::uint64_t seen_ = 0;  ///< keys met in the maps that are open, see sample_bit()
  SampleNode value_node_ = SampleNode::unknown;
  int key_line_ = 0;  ///< of the last key
  int skipped_ = 0;   ///< how deep in something unknown
  YamlProgress progress_;
  std::size_t errors_before_ = 0;  ///< this document
  bool last_document_is_empty_ = false;
};

}  // namespace kinecal::detail
