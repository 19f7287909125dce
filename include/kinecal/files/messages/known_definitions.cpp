// Definitions of known_definitions.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/files/messages/known_definitions.hpp"

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

#include "kinecal/files/messages/known_messages.ipp"

namespace kinecal::detail {

/// Adds the types that the fields of a message use, in the order of the fields.
inline void add_dependencies(const std::string& fields, std::string_view owner,
                             std::vector<std::string>& all) {
  for (std::size_t first = 0; first < fields.size();) {
    std::string type = fields.substr(first, fields.find_first_of("[ ", first) - first);
    first = fields.find('\n', first) + 1;
    if (type.find('/') == std::string::npos) {
      type.insert(0, owner.substr(0, owner.find('/') + 1));
    }
    if (known_message(type) == nullptr) continue;  // a number or a text
    if (std::find(all.begin(), all.end(), type) == all.end()) all.push_back(type);
  }
}

std::string known_definition(const std::string& type, Encoding encoding) {
  if (known_message(type) == nullptr) return {};
  std::vector<std::string> all = {type};
  std::string text;
  for (std::size_t i = 0; i < all.size(); ++i) {  // grows
    const KnownMessage& known = *known_message(all[i]);
    const std::string fields = known_fields(known, encoding);
    if (i > 0) text += "\n" + std::string(80, '=') + "\nMSG: " + all[i] + "\n";
    text += fields;
    add_dependencies(fields, known.type, all);
  }
  return text;
}

std::string known_md5(const std::string& type) {
  const KnownMessage* known = known_message(type);
  return known == nullptr ? std::string() : std::string(known->md5);
}

}  // namespace kinecal::detail
