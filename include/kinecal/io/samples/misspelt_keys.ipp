// Keys of samples that only kinecal reads, and that are probably misspelt: no message has them, so
// a wrong letter would silently leave out a sigma, an id or the conditions.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <array>
#include <string>
#include <string_view>

#include "kinecal/io/samples/sample_camera.ipp"
#include "kinecal/io/samples/sample_schema.ipp"
#include "kinecal/kinematics/nearest_name.hpp"

namespace kinecal::detail {

/// The key that was probably meant; empty if none is within two letters.
/// @param parent  the map in which the key stands
[[nodiscard]] inline std::string_view meant_sample_key(SampleNode parent, std::string_view key) {
  constexpr std::size_t kMostLetters = 2;
  for (const SampleNode own :
       {SampleNode::conditions, SampleNode::orientation, SampleNode::sigma, SampleNode::id}) {
    const SampleNodeRule& rule = sample_rule(own);
    if (rule.parent != parent) continue;
    const NearestName near = NearestName::none(key).or_nearer(rule.key, key);
    if (!near.name.empty() && near.distance <= kMostLetters) return rule.key;
  }
  return {};
}

/// Warns of an unknown key that resembles one of kinecal's own, once in a file.
inline void doubt_sample_key(SampleErrors& errors, SampleNode parent, int line,
                             std::string_view key) {
  const std::string_view meant = meant_sample_key(parent, key);
  if (meant.empty()) return;
  errors.warn_once(line, fmt::format("{}: unknown key {} is skipped; did you mean '{}'?",
                                     sample_name(parent), shown(key), meant));
}

}  // namespace kinecal::detail
