// Definitions of definition.hpp.  The text is split into the parts of its types; the parser starts
// with the first part and adds each type at its first use in a field.
//
// The texts are untrusted.  A type that contains itself would never end when a message is read, and
// a deep one would overflow the stack, so both are rejected.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/files/messages/definition.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "kinecal/files/bags/bag.hpp"

namespace kinecal::detail {

/// The lines that define one type.
struct DefinitionPart {
  std::string name;
  std::vector<std::pair<int, std::string_view>> lines;  ///< with line numbers, from 1
};

[[nodiscard]] inline std::string_view trimmed(std::string_view text) {
  constexpr std::string_view kBlank = " \t\r";
  const std::size_t first = text.find_first_not_of(kBlank);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kBlank) - first + 1);
}

[[nodiscard]] inline std::vector<DefinitionPart> definition_parts(const std::string& type,
                                                                  std::string_view text) {
  std::vector<DefinitionPart> parts = {{plain_type(type), {}}};
  for (int number = 1; !text.empty(); ++number) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    const std::string_view line = trimmed(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
    constexpr std::string_view kBegins = "MSG:";
    if (line.starts_with("===")) continue;
    if (line.starts_with(kBegins)) {
      parts.push_back({plain_type(trimmed(line.substr(kBegins.size()))), {}});
    } else if (!line.empty() && line.front() != '#') {
      parts.back().lines.emplace_back(number, line);
    }
  }
  return parts;
}

class DefinitionParser {
 public:
  explicit DefinitionParser(std::vector<DefinitionPart> parts) : parts_(std::move(parts)) {
    for (std::size_t i = 0; i < parts_.size(); ++i) by_name_.try_emplace(parts_[i].name, i);
  }

  [[nodiscard]] MessageDefinition parse() {
    (void)add(parts_.front().name, 0);
    return std::move(types_);
  }

 private:
  static constexpr int kMaxDepth = 32;

  /// @return  index of the type in the definition
  std::size_t add(const std::string& name, int depth) {
    const std::size_t here = types_.size();
    if (const auto [at, is_new] = added_.try_emplace(name, here); !is_new) return at->second;
    check_depth(name, depth);
    types_.push_back({name, {}});
    heights_.push_back(kUnfinished);
    int height = 1;
    const auto part = by_name_.find(name);
    if (part == by_name_.end()) {
      types_[here].fields = built_in(name);
      heights_[here] = height;
      return here;
    }
    for (const auto& [line, text] : parts_[part->second].lines) {
      auto field = parse_field(name, line, text, depth);
      if (!field) continue;
      if (field->type == FieldType::message) {
        height = std::max(height, heights_[field->message] + 1);
      }
      types_[here].fields.push_back(std::move(*field));
    }
    check_depth(name, height);
    heights_[here] = height;
    return here;
  }

  /// The times of ROS 1, and those of ROS 2, which some writers of bags omit.
  [[nodiscard]] static std::vector<MessageField> built_in(const std::string& name) {
    if (name == kTime) return {{"secs", FieldType::uint32}, {"nsecs", FieldType::uint32}};
    if (name == kDuration) return {{"secs", FieldType::int32}, {"nsecs", FieldType::int32}};
    if (name == "builtin_interfaces/Time" || name == "builtin_interfaces/Duration") {
      return {{"sec", FieldType::int32}, {"nanosec", FieldType::uint32}};
    }
    throw DefinitionError(fmt::format("type '{}' is used but not defined", name));
  }

  static void check_depth(const std::string& name, int depth) {
    if (depth > kMaxDepth) throw DefinitionError(fmt::format("'{}' is nested too deeply", name));
  }

  /// @return  nullopt for a constant
  [[nodiscard]] std::optional<MessageField> parse_field(const std::string& owner, int line,
                                                        std::string_view text, int depth) {
    const std::size_t type_end = text.find_first_of(" \t");
    if (type_end == std::string_view::npos) {
      throw DefinitionError(fmt::format("line {}: '{}' has no name", line, text));
    }
    std::string_view rest = trimmed(text.substr(type_end));
    const std::size_t name_end = std::min(rest.find_first_of(" \t=#"), rest.size());
    MessageField field;
    field.name = rest.substr(0, name_end);
    if (field.name.empty()) {
      throw DefinitionError(fmt::format("line {}: '{}' has no name", line, text));
    }
    if (trimmed(rest.substr(name_end)).starts_with('=')) return std::nullopt;
    std::string_view type = text.substr(0, type_end);
    if (const std::size_t bracket = type.find('['); bracket != std::string_view::npos) {
      set_count(field, type.substr(bracket), line);
      type = type.substr(0, bracket);
    }
    set_type(field, type.substr(0, type.find("<=")), owner, line, depth);
    return field;
  }

  static void set_count(MessageField& field, std::string_view brackets, int line) {
    if (!brackets.ends_with(']')) {
      throw DefinitionError(fmt::format("line {}: '{}' is not the size of a list", line, brackets));
    }
    const std::string_view size = brackets.substr(1, brackets.size() - 2);
    field.count = MessageField::Count::any;
    if (size.empty() || size.starts_with("<=")) return;
    field.count = MessageField::Count::fixed;
    const auto [end, error] = std::from_chars(size.data(), size.data() + size.size(), field.size);
    if (error != std::errc() || end != size.data() + size.size() || field.size == 0) {
      throw DefinitionError(fmt::format("line {}: '{}' is not the size of a list", line, brackets));
    }
  }

  void set_type(MessageField& field, std::string_view type, const std::string& owner, int line,
                int depth) {
    constexpr std::array<std::pair<std::string_view, FieldType>, 14> kPrimitives = {{
        {"bool", FieldType::boolean},
        {"int8", FieldType::int8},
        {"byte", FieldType::uint8},
        {"char", FieldType::uint8},
        {"uint8", FieldType::uint8},
        {"int16", FieldType::int16},
        {"uint16", FieldType::uint16},
        {"int32", FieldType::int32},
        {"uint32", FieldType::uint32},
        {"int64", FieldType::int64},
        {"uint64", FieldType::uint64},
        {"float32", FieldType::float32},
        {"float64", FieldType::float64},
        {"string", FieldType::text},
    }};
    for (const auto& [name, primitive] : kPrimitives) {
      if (type == name) {
        field.type = primitive;
        return;
      }
    }
    if (type == "wstring") {
      throw DefinitionError(fmt::format("line {}: wide strings are not supported", line));
    }
    field.message = add(full_name(type, owner), depth + 1);
    if (heights_[field.message] == kUnfinished) {
      throw DefinitionError(
          fmt::format("line {}: '{}' contains itself", line, types_[field.message].name));
    }
  }

  [[nodiscard]] std::string full_name(std::string_view type, const std::string& owner) const {
    if (type == kTime || type == kDuration) return std::string(type);
    if (type.find('/') != std::string_view::npos) return plain_type(type);
    std::string name = owner.substr(0, owner.find('/') + 1) + std::string(type);
    return type == "Header" && !by_name_.contains(name) ? "std_msgs/Header" : name;
  }

  static constexpr std::string_view kTime = "time", kDuration = "duration";
  static constexpr int kUnfinished = 0;

  std::vector<DefinitionPart> parts_;
  std::map<std::string, std::size_t> by_name_;
  MessageDefinition types_;
  std::map<std::string, std::size_t> added_;  ///< index in types_, by name
  std::vector<int> heights_;                  ///< of each type: levels of messages in it
};

MessageDefinition parse_definition(const std::string& type, std::string_view text) {
  if (text.size() > kMostOfADefinition) {
    throw DefinitionError(
        fmt::format("it has {} bytes; at most {} are read", text.size(), kMostOfADefinition));
  }
  return DefinitionParser(definition_parts(type, text)).parse();
}

}  // namespace kinecal::detail
