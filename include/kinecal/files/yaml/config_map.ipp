// A map of a configuration: values by key, errors with source locations.
//
// A key becomes known when the reader asks for it.  At the end, unknown keys are reported: as an
// error if the key is near a known one, because a misspelt `free_parms` must not silently free
// nothing, or if its name says that it decides the result (deciding_keys.ipp); otherwise as a
// warning.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <initializer_list>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "kinecal/files/diagnostics.hpp"
#include "kinecal/files/yaml/config_scalar.ipp"
#include "kinecal/files/yaml/deciding_keys.ipp"
#include "kinecal/text/nearest_name.hpp"

namespace kinecal::detail {

/// `key: value`, or an element of a list, whose key is empty.
struct ConfigEntry {
  std::string key;
  const YamlNode& value;
  SourceLocation place;
};

class ConfigMap {
 public:
  /// @param map      a map; must outlive this
  /// @param subject  the map's meaning, for messages: "model 'arm'"; may be empty
  ConfigMap(const YamlNode& map, SourceLocation place, std::string subject,
            Diagnostics& diagnostics)
      : place_(std::move(place)), subject_(std::move(subject)), diagnostics_(&diagnostics) {
    for (std::size_t i = 0; i < map.keys.size(); ++i) {
      if (!is_merge(map.keys[i])) add(map.keys[i], map.items[i]);
    }
    for (std::size_t i = 0; i < map.keys.size(); ++i) {
      if (is_merge(map.keys[i])) merge(map.items[i], map.keys[i].line);
    }
  }
  ConfigMap(YamlNode&&, SourceLocation, std::string, Diagnostics&) = delete;

  [[nodiscard]] const SourceLocation& place() const { return place_; }
  [[nodiscard]] const std::vector<ConfigEntry>& entries() const { return entries_; }
  [[nodiscard]] Diagnostics& diagnostics() const { return *diagnostics_; }
  void set_subject(std::string subject) { subject_ = std::move(subject); }

  void error(const SourceLocation& place, const std::string& message) const {
    diagnostics_->error(place, subject_.empty() ? message : subject_ + ": " + message);
  }
  void warning(const SourceLocation& place, const std::string& message) const {
    diagnostics_->warning(place, subject_.empty() ? message : subject_ + ": " + message);
  }
  void note(const SourceLocation& place, const std::string& message) const {
    diagnostics_->note(place, subject_.empty() ? message : subject_ + ": " + message);
  }

  /// "; did you mean ...?"; nothing after many errors, because hostile files have thousands of
  /// names.
  template <class Names>
  [[nodiscard]] std::string did_you_mean(const std::string& name, const Names& names) const {
    constexpr std::size_t kMostErrors = 50;
    return diagnostics_->errors.size() < kMostErrors ? kinecal::did_you_mean(name, names) : "";
  }

  /// The entry of a key, or nullptr.  The key becomes known.
  const ConfigEntry* find(const std::string& key) {
    words_.insert(key);
    return use(key);
  }

  /// The entry of a user-defined name, or nullptr.  Other names may be near it.
  const ConfigEntry* use(const std::string& name) {
    used_.insert(name);
    return peek(name);
  }

  [[nodiscard]] const ConfigEntry* peek(const std::string& key) const {
    const auto found = indices_.find(key);
    return found == indices_.end() ? nullptr : &entries_[found->second];
  }

  /// Ignores keys of other programs.
  void ignore(std::initializer_list<const char*> keys) {
    for (const char* key : keys) find(key);
  }

  /// A required text; an error and nullopt if it is missing or not a text.
  std::optional<std::string> required_text(const std::string& key) {
    if (find(key) != nullptr) return text(key);
    error(place_, key + " is missing");
    return std::nullopt;
  }

  /// An optional text.
  std::optional<std::string> text(const std::string& key) {
    return read<std::string>(key, config_text, "a text");
  }

  double number(const std::string& key, double fallback) {
    const auto finite = [](const YamlNode& node) {
      const std::optional<double> value = config_number(node);
      return value && std::isfinite(*value) ? value : std::nullopt;
    };
    return read<double>(key, finite, "a finite number").value_or(fallback);
  }

  double positive(const std::string& key, double fallback) {
    const auto positive = [](const YamlNode& node) {
      const std::optional<double> value = config_number(node);
      return value && std::isfinite(*value) && *value > 0.0 ? value : std::nullopt;
    };
    return read<double>(key, positive, "a finite number greater than zero").value_or(fallback);
  }

  int count(const std::string& key, int fallback) {
    return read<int>(key, config_count, "an integer greater than zero").value_or(fallback);
  }

  bool flag(const std::string& key, bool fallback) {
    return read<bool>(key, config_flag, "true or false").value_or(fallback);
  }

  /// The elements of a list; none if it is missing or empty.
  std::vector<ConfigEntry> list(const std::string& key) {
    std::vector<ConfigEntry> elements;
    const ConfigEntry* entry = find(key);
    if (entry == nullptr || entry->value.is_null()) return elements;
    if (!entry->value.is_list()) {
      error(entry->place, key + " is " + describe_config(entry->value) + ", not a list");
      return elements;
    }
    for (const YamlNode& element : entry->value.items) {
      elements.push_back({"", element, place_of(element)});
    }
    return elements;
  }

  /// A map; nullopt if it is missing or empty.
  std::optional<ConfigMap> map(const std::string& key, const std::string& subject) {
    const ConfigEntry* entry = find(key);
    if (entry == nullptr || entry->value.is_null()) return std::nullopt;
    return map(*entry, subject);
  }

  /// An entry as a map; an error and nullopt if it is not a map.
  std::optional<ConfigMap> map(const ConfigEntry& entry, const std::string& subject) const {
    if (entry.value.is_map()) return ConfigMap(entry.value, entry.place, subject, *diagnostics_);
    const std::string what = entry.key.empty() ? subject : entry.key;
    error(entry.place, what + " is " + describe_config(entry.value) + ", not a map");
    return std::nullopt;
  }

  /// Inherits the entries of these keys that only the other map has.
  void inherit(ConfigMap& other, std::initializer_list<const char*> keys) {
    for (const char* key : keys) {
      const ConfigEntry* entry = other.find(key);
      if (entry != nullptr && peek(key) == nullptr) append(*entry);
    }
  }

  /// @param strict  an error for every unknown key; else only for those that resemble a known one
  ///                or decide the result
  void report_unknown(bool strict = false) const {
    for (const ConfigEntry& entry : entries_) {
      if (used_.contains(entry.key)) continue;
      const std::string unknown = "unknown key '" + entry.key + "'";
      const std::string meant = kinecal::did_you_mean(entry.key, words_);
      if (meant.empty() && meaning_of_key(entry.key) != KeyMeaning::other) {
        report_lost(entry);
      } else if (strict || !meant.empty()) {
        error(entry.place, unknown + meant);
      } else {
        warning(entry.place, unknown + " is ignored");
      }
    }
  }

  /// Reports an unknown key that decides the result.
  void report_lost(const ConfigEntry& entry) const {
    error(entry.place, "unknown key '" + entry.key + "' looks like " +
                           text_of(meaning_of_key(entry.key)) + ", which would be lost" +
                           meant_by_key(entry.key, words_));
  }

  /// True if the reader has asked for a key.
  [[nodiscard]] bool is_used(const std::string& key) const { return used_.contains(key); }

 private:
  [[nodiscard]] SourceLocation place_of(const YamlNode& node) const {
    return {place_.file, node.line};
  }

  void append(ConfigEntry entry) {
    indices_.emplace(entry.key, entries_.size());
    entries_.push_back(std::move(entry));
  }

  [[nodiscard]] static bool is_merge(const YamlNode& key) {
    return key.is_scalar() && key.text == "<<";
  }

  /// `<<: *map` or `<<: [*map, ...]`: adds what the map itself lacks; earlier maps take precedence.
  /// Source: Merge Key Language-Independent Type for YAML 1.1
  void merge(const YamlNode& merged, int line) {
    if (merged.is_list()) {
      for (const YamlNode& map : merged.items) merge(map, line);
      return;
    }
    if (!merged.is_map()) {
      error({place_.file, line}, "merge key '<<' is " + describe_config(merged) + ", not a map");
    }
    const ConfigMap others(merged, place_, subject_, *diagnostics_);
    for (const ConfigEntry& entry : others.entries()) {
      if (peek(entry.key) == nullptr) append(entry);
    }
  }

  void add(const YamlNode& key, const YamlNode& value) {
    const SourceLocation place = place_of(key);
    const auto name = config_text(key);
    if (!name) {
      error(place, "a key is " + describe_config(key) + ", not a text");
    } else if (const ConfigEntry* first = peek(*name)) {
      error(place, "key '" + *name + "' occurs twice; the first is in line " +
                       std::to_string(first->place.line));
    } else {
      append({*name, value, place});
    }
  }

  template <class Value, class Read>
  std::optional<Value> read(const std::string& key, const Read& read_value, const char* expected) {
    const ConfigEntry* entry = find(key);
    if (entry == nullptr) return std::nullopt;
    std::optional<Value> value = read_value(entry->value);
    if (value) return value;
    error(entry->place, key + " is " + describe_config(entry->value) + ", not " + expected);
    return std::nullopt;
  }

  SourceLocation place_;
  std::string subject_;
  Diagnostics* diagnostics_;
  std::vector<ConfigEntry> entries_;
  std::map<std::string, std::size_t> indices_;  ///< key -> index in entries_
  std::set<std::string> words_;                 ///< known keys
  std::set<std::string> used_;                  ///< known keys and user-defined names
};

/// One of a few words; the fallback, and an error, for any other.
inline std::string read_choice(ConfigMap& map, const std::string& key, const std::string& fallback,
                               const std::vector<std::string>& choices) {
  std::string word = map.text(key).value_or(fallback);
  std::string all;
  for (const std::string& choice : choices) {
    if (choice == word) return word;
    all += (all.empty() ? "" : ", ") + choice;
  }
  map.error(map.find(key)->place,
            key + " '" + word + "' is not one of " + all + did_you_mean(word, choices));
  return fallback;
}

}  // namespace kinecal::detail
