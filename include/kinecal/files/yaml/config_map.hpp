// A map of a configuration: values by key, errors with source locations.
//
// A key becomes known when the reader asks for it.  At the end, unknown keys are reported: as an
// error if the key is near a known one, because a misspelt `free_parms` must not silently free
// nothing, or if its name says that it decides the result (deciding_keys.hpp); otherwise as a
// warning.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <initializer_list>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "kinecal/files/diagnostics.hpp"
#include "kinecal/files/yaml/config_scalar.hpp"
#include "kinecal/files/yaml/deciding_keys.hpp"
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
            Diagnostics& diagnostics);
  ConfigMap(YamlNode&&, SourceLocation, std::string, Diagnostics&) = delete;

  [[nodiscard]] const SourceLocation& place() const { return place_; }
  [[nodiscard]] const std::vector<ConfigEntry>& entries() const { return entries_; }
  [[nodiscard]] Diagnostics& diagnostics() const { return *diagnostics_; }
  void set_subject(std::string subject) { subject_ = std::move(subject); }

  void error(const SourceLocation& place, const std::string& message) const;
  void warning(const SourceLocation& place, const std::string& message) const;
  void note(const SourceLocation& place, const std::string& message) const;

  /// "; did you mean ...?"; nothing after many errors, because hostile files have thousands of
  /// names.
  template <class Names>
  [[nodiscard]] std::string did_you_mean(const std::string& name, const Names& names) const {
    constexpr std::size_t kMostErrors = 50;
    return diagnostics_->errors.size() < kMostErrors ? kinecal::did_you_mean(name, names) : "";
  }

  /// The entry of a key, or nullptr.  The key becomes known.
  const ConfigEntry* find(const std::string& key);

  /// The entry of a user-defined name, or nullptr.  Other names may be near it.
  const ConfigEntry* use(const std::string& name);

  [[nodiscard]] const ConfigEntry* peek(const std::string& key) const;

  /// Ignores keys of other programs.
  void ignore(std::initializer_list<const char*> keys);

  /// A required text; an error and nullopt if it is missing or not a text.
  std::optional<std::string> required_text(const std::string& key);

  /// An optional text.
  std::optional<std::string> text(const std::string& key);

  double number(const std::string& key, double fallback);

  double positive(const std::string& key, double fallback);

  int count(const std::string& key, int fallback);

  bool flag(const std::string& key, bool fallback);

  /// The elements of a list; empty if it is missing.
  std::vector<ConfigEntry> list(const std::string& key);

  /// A map; nullopt if it is missing or empty.
  std::optional<ConfigMap> map(const std::string& key, const std::string& subject);

  /// An entry as a map; an error and nullopt if it is not a map.
  std::optional<ConfigMap> map(const ConfigEntry& entry, const std::string& subject) const;

  /// Inherits the entries of these keys that only the other map has.
  void inherit(ConfigMap& other, std::initializer_list<const char*> keys);

  /// @param strict  an error for every unknown key; else only for those that resemble a known one
  ///                or decide the result
  void report_unknown(bool strict = false) const;

  /// Reports an unknown key that decides the result.
  void report_lost(const ConfigEntry& entry) const;

  /// True if the reader has asked for a key.
  [[nodiscard]] bool is_used(const std::string& key) const { return used_.contains(key); }

 private:
  [[nodiscard]] SourceLocation place_of(const YamlNode& node) const;

  void append(ConfigEntry entry);

  [[nodiscard]] static bool is_merge(const YamlNode& key);

  /// `<<: *map` or `<<: [*map, ...]`: adds what the map itself lacks; earlier maps take precedence.
  /// Source: Merge Key Language-Independent Type for YAML 1.1
  void merge(const YamlNode& merged, int line);

  void add(const YamlNode& key, const YamlNode& value);

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
std::string read_choice(ConfigMap& map, const std::string& key, const std::string& fallback,
                        const std::vector<std::string>& choices);

}  // namespace kinecal::detail
