// Finds probable mistakes in the keys of samples.
//
// Only kinecal has some of the keys: a typo would silently ignore a sigma, an id,
// the conditions or the poses.
// And {x: 0,03} is the number 0 and a key 03.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <array>
#include <string>
#include <string_view>

#include "kinecal/files/samples/sample_camera.ipp"
#include "kinecal/files/samples/sample_schema.ipp"
#include "kinecal/files/yaml/deciding_keys.ipp"
#include "kinecal/text/nearest_name.hpp"

namespace kinecal::detail {

/// The probably intended key; empty if none is within two letters.
/// @param parent  the map with the key
[[nodiscard]] inline std::string_view meant_sample_key(SampleNode parent, std::string_view key) {
  constexpr std::size_t kMostLetters = 2;
  for (const SampleNode own : {SampleNode::poses, SampleNode::conditions, SampleNode::orientation,
                               SampleNode::sigma, SampleNode::id}) {
    const SampleNodeRule& rule = sample_rule(own);
    if (rule.parent != parent) continue;
    const NearestName near = NearestName::none(key).or_nearer(rule.key, key);
    if (!near.name.empty() && near.distance <= kMostLetters) return rule.key;
  }
  return {};
}

/// Warns of an unknown key that resembles one of kinecal's own, once per file.  A key of digits
/// among numbers is an error.
inline void doubt_sample_key(SampleErrors& errors, SampleNode parent, int line,
                             std::string_view key) {
  const bool digits = key.find_first_not_of("0123456789") == std::string_view::npos;
  if (digits && !key.empty() &&
      (parent == SampleNode::point || parent == SampleNode::orientation)) {
    const std::string_view part = key.substr(0, 20);
    return errors.add(line, fmt::format("{}: unknown key '{}'; decimal comma? write a dot: 0.{}",
                                        sample_name(parent), part, part));
  }
  const KeyMeaning meaning = meaning_of_key(key);
  const bool is_lens = parent == SampleNode::camera_info && meaning == KeyMeaning::distortion;
  const bool is_unit = meaning == KeyMeaning::unit &&
                       (parent == SampleNode::feature || parent == SampleNode::point ||
                        parent == SampleNode::observation || parent == SampleNode::joint_states);
  if (is_lens || is_unit) {
    return errors.add(line, fmt::format("{}: unknown key {} looks like {}, which would be lost; {}",
                                        sample_name(parent), shown(key), text_of(meaning),
                                        is_lens ? "the distortion is called D (ROS 2: d)"
                                                : "samples are in metres, radians and pixels"));
  }
  const std::string_view meant = meant_sample_key(parent, key);
  if (meant.empty()) return;
  errors.warn_once(line, fmt::format("{}: unknown key {} is skipped; did you mean '{}'?",
                                     sample_name(parent), shown(key), meant));
}

}  // namespace kinecal::detail
