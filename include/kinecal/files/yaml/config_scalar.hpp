// Numbers, counts, flags and texts from the scalars of a configuration; nullopt for other scalars.
//
// Independent of the locale.  A tag that is not YAML's, as in `!degrees 90`, changes the meaning of
// a scalar, so such a scalar is rejected.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "kinecal/files/yaml/yaml_node.hpp"
#include "kinecal/files/yaml/yaml_text.hpp"
#include "kinecal/text/printable.hpp"

namespace kinecal::detail {

/// A plain or quoted scalar without a tag, or with one of YAML's.
[[nodiscard]] bool is_config_scalar(const YamlNode& node);

/// A node's description in messages: 'abc', a list, a map, empty.
[[nodiscard]] std::string describe_config(const YamlNode& node);

/// Why a file is of another kind: "this is a URDF, not a configuration", "the file is 'abc', not a map".
/// @param wanted  what its content must be
[[nodiscard]] std::string describe_wrong_file(const YamlNode& content, const std::string& kind,
                                              const std::string& wanted = "a map");

/// A nonempty text without control characters: texts are names, and are printed.
[[nodiscard]] std::optional<std::string> config_text(const YamlNode& node);

/// A number, .inf or -.inf; .nan is not a number.
[[nodiscard]] std::optional<double> config_number(const YamlNode& node);

/// An integer greater than zero.
[[nodiscard]] std::optional<int> config_count(const YamlNode& node);

/// true, false and YAML's other words for them in lower, upper or title case, also quoted; 1 and 0.
[[nodiscard]] std::optional<bool> config_flag(const YamlNode& node);

}  // namespace kinecal::detail
