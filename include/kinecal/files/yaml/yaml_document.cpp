// Definitions of yaml_document.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/files/yaml/yaml_document.hpp"

#include <utility>

namespace kinecal::detail {

YamlNode load_config(const std::string& path, Diagnostics& diagnostics) {
  return parse_config_text(read_yaml_text(path), path, diagnostics);
}

YamlNode parse_config_text(const std::string& text, const std::string& path,
                           Diagnostics& diagnostics) {
  YamlNode content;
  for (YamlNode& document : parse_yaml(text, path)) {
    if (document.is_null()) continue;
    if (content.is_null()) {
      content = std::move(document);
    } else {
      diagnostics.error({path, document.line},
                        "a second document begins here; a configuration is a single one");
    }
  }
  return content;
}

}  // namespace kinecal::detail
