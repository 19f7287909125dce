// Names of frames, with and without a leading slash: /tool and tool are the same frame.
//
// ROS 1 wrote frames with a slash and tf2 takes one off, so URDFs, samples and configurations of one
// robot mix both.  Names are shown and written as they were read; only comparisons ignore the slash.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace kinecal {

/// The name without its leading slash; "/" alone stays.
[[nodiscard]] constexpr std::string_view plain_frame(std::string_view name) {
  return name.size() > 1 && name.front() == '/' ? name.substr(1) : name;
}

/// True if two names mean the same frame.
[[nodiscard]] constexpr bool same_frame(std::string_view a, std::string_view b) {
  return plain_frame(a) == plain_frame(b);
}

/// The one of some names that means this frame; nullptr if none does.
/// @tparam Names  a set of names
template <class Names>
[[nodiscard]] const std::string* frame_among(const Names& names, const std::string& name) {
  for (const std::string& spelling :
       {name, std::string(plain_frame(name)), "/" + std::string(plain_frame(name))}) {
    if (const auto found = names.find(spelling); found != names.end()) return &*found;
  }
  return nullptr;
}

}  // namespace kinecal
