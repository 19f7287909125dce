// The items of a configuration's lists: models, free frames, initial values, error blocks.
//
// The two dialects of robot_calibration differ only in the place of an item:
//
//   ROS 1   models:            ROS 2   models:
//           - name: arm                - arm
//             type: chain              arm:
//                                        type: chain3d
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "kinecal/files/yaml/config_map.hpp"

namespace kinecal::detail {

/// One item; without a map if the map could not be read, which has been reported.
struct ConfigItem {
  std::string name;
  std::optional<ConfigMap> map;
  SourceLocation place;
};

/// A list of a step, and the names of its items.
struct ConfigItemKind {
  std::string list;    ///< key of the list
  std::string noun;    ///< "model", for messages
  std::string suffix;  ///< ROS 2: the item's key is its name plus this

  [[nodiscard]] std::string subject(const std::string& name) const {
    return noun + " '" + name + "'";
  }
};

inline const ConfigItemKind kModelItems{"models", "model", ""};
inline const ConfigItemKind kFreeFrameItems{"free_frames", "free frame", ""};
inline const ConfigItemKind kFixedFrameItems{"fixed_frames", "fixed frame", ""};
inline const ConfigItemKind kErrorBlockItems{"error_blocks", "error block", ""};
inline const ConfigItemKind kInitialValueItems{"free_frames_initial_values",
                                               "initial value of free frame", "_initial_values"};

/// Reports a list that is missing or empty.
inline void require_items(const ConfigMap& map, const ConfigItemKind& kind) {
  const ConfigEntry* entry = map.peek(kind.list);
  const bool missing = entry == nullptr || entry->value.is_null();
  if (!missing && !(entry->value.is_list() && entry->value.items.empty())) return;
  map.error(entry == nullptr ? map.place() : entry->place,
            "no " + kind.noun + " is given; list at least one under '" + kind.list + "'");
}

using FindConfigItems =
    std::function<std::vector<ConfigItem>(ConfigMap& step, const ConfigItemKind& kind)>;

/// The elements of a list of items; none, and an error, if there are too many to solve for.
[[nodiscard]] inline std::vector<ConfigEntry> item_elements(ConfigMap& step,
                                                            const ConfigItemKind& kind) {
  constexpr std::size_t kMost = 500;
  std::vector<ConfigEntry> elements = step.list(kind.list);
  if (elements.size() <= kMost) return elements;
  step.error(elements[kMost].place, kind.list + " has " + std::to_string(elements.size()) +
                                        " items, and at most " + std::to_string(kMost) +
                                        " are read");
  return {};
}

/// Reports an item with the name of an earlier one in the list, or one that is too long for the files that
/// are named after it.
[[nodiscard]] inline bool is_refused(const std::vector<ConfigItem>& items, const std::string& name,
                                     const ConfigItemKind& kind, const SourceLocation& place,
                                     const ConfigMap& step) {
  constexpr std::size_t kLongestName = 200;
  if (name.size() > kLongestName) {
    step.error(place, kind.subject(name.substr(0, kLongestName) + "...") + " has a name of " +
                          std::to_string(name.size()) + " characters; at most " +
                          std::to_string(kLongestName) + " are possible");
    return true;
  }
  for (const ConfigItem& first : items) {
    if (first.name != name) continue;
    step.error(place, kind.subject(name) + " occurs twice; the first is in line " +
                          std::to_string(first.place.line));
    return true;
  }
  return false;
}

/// ROS 1: a list of maps with `name`.
[[nodiscard]] inline std::vector<ConfigItem> find_ros1_items(ConfigMap& step,
                                                             const ConfigItemKind& kind) {
  std::vector<ConfigItem> items;
  for (const ConfigEntry& element : item_elements(step, kind)) {
    if (!element.value.is_map()) {
      step.error(element.place, kind.list + ": " + describe_config(element.value) +
                                    " is not a map with a name; lists of names are read under "
                                    "ros__parameters only");
      continue;
    }
    ConfigMap map(element.value, element.place, kind.noun, step.diagnostics());
    const auto name = map.required_text("name");
    if (!name || is_refused(items, *name, kind, element.place, step)) continue;
    map.set_subject(kind.subject(*name));
    items.push_back({*name, std::move(map), element.place});
  }
  return items;
}

/// ROS 2: a list of names, with a map for each of them beside the list.
class FindRos2Items {
 public:
  std::vector<ConfigItem> operator()(ConfigMap& step, const ConfigItemKind& kind) {
    const std::vector<ConfigEntry> elements = item_elements(step, kind);
    for (const ConfigEntry& element : elements) {
      if (const auto name = config_text(element.value)) listed_.insert(*name + kind.suffix);
    }
    std::vector<ConfigItem> items;
    for (const ConfigEntry& element : elements) {
      const auto name = config_text(element.value);
      if (!name) {
        step.error(element.place, kind.list + ": " + describe_config(element.value) +
                                      " is not a name; under ros__parameters a list holds names, "
                                      "and the map of each stands beside the list");
      } else if (!is_refused(items, *name, kind, element.place, step)) {
        items.push_back(item(step, kind, *name, element.place));
      }
    }
    if (!kind.suffix.empty()) report_unlisted(step, kind);
    return items;
  }

 private:
  ConfigItem item(ConfigMap& step, const ConfigItemKind& kind, const std::string& name,
                  const SourceLocation& listed) {
    const std::string key = name + kind.suffix;
    const ConfigEntry* entry = step.use(key);
    if (entry == nullptr) {
      report_missing(step, kind, name, listed);
      return {name, std::nullopt, listed};
    }
    const auto [owner, is_new] = owners_.emplace(key, kind.subject(name));
    if (!is_new) {
      step.error(entry->place, owner->second + " and " + kind.subject(name) +
                                   " are the same key '" + key + "'; rename one of them");
      return {name, std::nullopt, entry->place};
    }
    return {name, step.map(*entry, kind.subject(name)), entry->place};
  }

  /// Suggests a map that belongs to no other item, and marks it as known.
  void report_missing(ConfigMap& step, const ConfigItemKind& kind, const std::string& name,
                      const SourceLocation& listed) {
    const std::string key = name + kind.suffix;
    std::vector<std::string> maps;
    for (const ConfigEntry& entry : step.entries()) {
      if (entry.value.is_map() && !listed_.contains(entry.key)) maps.push_back(entry.key);
    }
    const std::string meant = step.did_you_mean(key, maps);
    step.error(listed, kind.subject(name) + " has no map '" + key + "' beside the list '" +
                           kind.list + "'" + meant);
    if (meant.empty()) return;
    step.use(*nearest_name(key, maps));
    listed_.insert(*nearest_name(key, maps));
  }

  /// Reports the map of a name that this list lacks.
  void report_unlisted(ConfigMap& step, const ConfigItemKind& kind) const {
    for (const ConfigEntry& entry : step.entries()) {
      if (!entry.key.ends_with(kind.suffix) || listed_.contains(entry.key)) continue;
      const std::string name = entry.key.substr(0, entry.key.size() - kind.suffix.size());
      if (!listed_.contains(name)) continue;
      step.error(entry.place, "'" + entry.key + "' is not used: add '" + name + "' to the list '" +
                                  kind.list + "'");
      step.use(entry.key);
    }
  }

  std::set<std::string> listed_;               ///< keys of the items of all lists so far
  std::map<std::string, std::string> owners_;  ///< key -> subject of its item
};

}  // namespace kinecal::detail
