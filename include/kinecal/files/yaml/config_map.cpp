// Definitions of config_map.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/files/yaml/config_map.hpp"

#include <cmath>

namespace kinecal::detail {

ConfigMap::ConfigMap(const YamlNode& map, SourceLocation place, std::string subject,
                     Diagnostics& diagnostics)
    : place_(std::move(place)), subject_(std::move(subject)), diagnostics_(&diagnostics) {
  for (std::size_t i = 0; i < map.keys.size(); ++i) {
    if (!is_merge(map.keys[i])) add(map.keys[i], map.items[i]);
  }
  for (std::size_t i = 0; i < map.keys.size(); ++i) {
    if (is_merge(map.keys[i])) merge(map.items[i], map.keys[i].line);
  }
}

void ConfigMap::error(const SourceLocation& place, const std::string& message) const {
  diagnostics_->error(place, subject_.empty() ? message : subject_ + ": " + message);
}

void ConfigMap::warning(const SourceLocation& place, const std::string& message) const {
  diagnostics_->warning(place, subject_.empty() ? message : subject_ + ": " + message);
}

void ConfigMap::note(const SourceLocation& place, const std::string& message) const {
  diagnostics_->note(place, subject_.empty() ? message : subject_ + ": " + message);
}

const ConfigEntry* ConfigMap::find(const std::string& key) {
  words_.insert(key);
  return use(key);
}

const ConfigEntry* ConfigMap::use(const std::string& name) {
  used_.insert(name);
  return peek(name);
}

const ConfigEntry* ConfigMap::peek(const std::string& key) const {
  const auto found = indices_.find(key);
  return found == indices_.end() ? nullptr : &entries_[found->second];
}

void ConfigMap::ignore(std::initializer_list<const char*> keys) {
  for (const char* key : keys) find(key);
}

std::optional<std::string> ConfigMap::required_text(const std::string& key) {
  if (find(key) != nullptr) return text(key);
  error(place_, key + " is missing");
  return std::nullopt;
}

std::optional<std::string> ConfigMap::text(const std::string& key) {
  return read<std::string>(key, config_text, "a text");
}

double ConfigMap::number(const std::string& key, double fallback) {
  const auto finite = [](const YamlNode& node) {
    const std::optional<double> value = config_number(node);
    return value && std::isfinite(*value) ? value : std::nullopt;
  };
  return read<double>(key, finite, "a finite number").value_or(fallback);
}

double ConfigMap::positive(const std::string& key, double fallback) {
  const auto positive = [](const YamlNode& node) {
    const std::optional<double> value = config_number(node);
    return value && std::isfinite(*value) && *value > 0.0 ? value : std::nullopt;
  };
  return read<double>(key, positive, "a finite number greater than zero").value_or(fallback);
}

int ConfigMap::count(const std::string& key, int fallback) {
  return read<int>(key, config_count, "an integer greater than zero").value_or(fallback);
}

bool ConfigMap::flag(const std::string& key, bool fallback) {
  return read<bool>(key, config_flag, "true or false").value_or(fallback);
}

std::vector<ConfigEntry> ConfigMap::list(const std::string& key) {
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

std::optional<ConfigMap> ConfigMap::map(const std::string& key, const std::string& subject) {
  const ConfigEntry* entry = find(key);
  if (entry == nullptr || entry->value.is_null()) return std::nullopt;
  return map(*entry, subject);
}

std::optional<ConfigMap> ConfigMap::map(const ConfigEntry& entry,
                                        const std::string& subject) const {
  if (entry.value.is_map()) return ConfigMap(entry.value, entry.place, subject, *diagnostics_);
  const std::string what = entry.key.empty() ? subject : entry.key;
  error(entry.place, what + " is " + describe_config(entry.value) + ", not a map");
  return std::nullopt;
}

void ConfigMap::inherit(ConfigMap& other, std::initializer_list<const char*> keys) {
  for (const char* key : keys) {
    const ConfigEntry* entry = other.find(key);
    if (entry != nullptr && peek(key) == nullptr) append(*entry);
  }
}

void ConfigMap::report_unknown(bool strict) const {
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

void ConfigMap::report_lost(const ConfigEntry& entry) const {
  error(entry.place, "unknown key '" + entry.key + "' looks like " +
                         text_of(meaning_of_key(entry.key)) + ", which would be lost" +
                         meant_by_key(entry.key, words_));
}

SourceLocation ConfigMap::place_of(const YamlNode& node) const {
  return {place_.file, node.line};
}

void ConfigMap::append(ConfigEntry entry) {
  indices_.emplace(entry.key, entries_.size());
  entries_.push_back(std::move(entry));
}

bool ConfigMap::is_merge(const YamlNode& key) {
  return key.is_scalar() && key.text == "<<";
}

void ConfigMap::merge(const YamlNode& merged, int line) {
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

void ConfigMap::add(const YamlNode& key, const YamlNode& value) {
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

std::string read_choice(ConfigMap& map, const std::string& key, const std::string& fallback,
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
