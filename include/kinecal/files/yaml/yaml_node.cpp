// Builds trees from the events of libyaml.
//
// Files may be hostile.  Memory is counted before it is used, and aliases count like copies, so
// `&b [*a, *a]`, `&c [*b, *b]` and so on end in an error.  An alias inside the node that it names
// is a copy of an empty list or map: no tree contains itself.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/files/yaml/yaml_node.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <functional>
#include <map>
#include <system_error>
#include <utility>

#include "kinecal/files/diagnostics.hpp"
#include "kinecal/files/text_file.hpp"
#include "kinecal/files/yaml/yaml_events.ipp"

namespace kinecal::detail {

/// A YamlHandler that builds the trees of all documents.
class YamlTrees {
 public:
  explicit YamlTrees(const YamlEvents& events) : events_(events) {}

  [[nodiscard]] std::vector<YamlNode> take() { return std::move(documents_); }

  void document_starts() {
    documents_.emplace_back();
    named_.clear();
    anchors_.clear();
  }
  void null(int line) { add(begin(YamlNode::Kind::null, line, {}).node); }
  void scalar(int line, std::string_view text) {
    add(begin(YamlNode::Kind::scalar, line, text).node);
  }
  void list_starts(int line) { open_.push_back(begin(YamlNode::Kind::list, line, {})); }
  void map_starts(int line) { open_.push_back(begin(YamlNode::Kind::map, line, {})); }
  void ends() {
    Open done = std::move(open_.back());
    open_.pop_back();
    if (done.name != kNoName) {
      charge(done.node, done.node.line, 0);
      named_[done.name] = done.node;
    }
    add(std::move(done.node));
  }
  void alias(int line) {
    const YamlNode& node = named_[anchors_.find(events_.anchor())->second];
    charge(node, line, static_cast<int>(open_.size()));
    add(node);
  }

 private:
  static constexpr std::size_t kNoName = static_cast<std::size_t>(-1);
  struct Open {
    YamlNode node;
    std::size_t name = kNoName;  ///< index in named_ of a node with an anchor
  };

  /// A node without its content, which aliases may refer to from now on.
  Open begin(YamlNode::Kind kind, int line, std::string_view text) {
    Open open{{kind, line, std::string(text), std::string(events_.tag()), {}, {}}};
    charge(open.node, line, 0);
    if (!events_.anchor().empty()) {
      charge(open.node, line, 0);
      open.name = named_.size();
      anchors_.insert_or_assign(std::string(events_.anchor()), open.name);
      named_.push_back(open.node);
    }
    return open;
  }

  void add(YamlNode node) {
    if (open_.empty()) {
      documents_.back() = std::move(node);
      return;
    }
    YamlNode& parent = open_.back().node;
    const bool is_key = parent.is_map() && parent.keys.size() == parent.items.size();
    (is_key ? parent.keys : parent.items).push_back(std::move(node));
  }

  /// Counts the bytes of a node before it is made.
  /// @param depth  of the lists and maps around it
  void charge(const YamlNode& node, int line, int depth) {
    if (depth > YamlEvents::kDeepest) {
      throw YamlError(line, "lists and maps are nested too deeply");
    }
    bytes_ += sizeof(YamlNode) + node.text.size() + node.tag.size();
    if (bytes_ > kMostYamlBytes) {
      throw YamlError(line, fmt::format("the file's values, with what its aliases repeat, need "
                                        "more than {} MiB of memory",
                                        kMostYamlBytes >> 20));
    }
    for (const YamlNode& key : node.keys) charge(key, line, depth + 1);
    for (const YamlNode& item : node.items) charge(item, line, depth + 1);
  }

  const YamlEvents& events_;
  std::vector<YamlNode> documents_;
  std::vector<Open> open_;       ///< lists and maps around the next event
  std::vector<YamlNode> named_;  ///< copies of nodes with anchors
  std::map<std::string, std::size_t, std::less<>> anchors_;  ///< name -> index in named_
  std::size_t bytes_ = 0;
};
static_assert(YamlHandler<YamlTrees>);

[[nodiscard]] inline InputError too_large(const std::string& path, std::uintmax_t bytes) {
  return InputError(fmt::format("{}: has {} bytes; at most {} MiB can be read", path, bytes,
                                kMostYamlBytes >> 20));
}

const YamlNode* YamlNode::find(std::string_view key) const {
  for (std::size_t i = 0; i < keys.size(); ++i) {
    if (keys[i].is_scalar() && keys[i].text == key) return &items[i];
  }
  return nullptr;
}

std::string read_yaml_text(const std::string& path) {
  std::error_code unknown;  // of a pipe, for example
  const std::uintmax_t bytes = std::filesystem::file_size(path, unknown);
  if (!unknown && bytes > kMostYamlBytes) throw too_large(path, bytes);
  return read_text_file(path);
}

std::vector<YamlNode> parse_yaml(std::string_view text, const std::string& path) {
  if (text.size() > kMostYamlBytes) throw too_large(path, text.size());
  try {
    YamlEvents events(text);
    YamlTrees trees(events);
    while (events.next_document(trees)) {
    }
    return trees.take();
  } catch (const YamlError& error) {
    throw InputError(SourceLocation{path, error.line}.str() + ": " + error.what());
  }
}

}  // namespace kinecal::detail
