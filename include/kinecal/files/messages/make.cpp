// Definitions of make.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/files/messages/make.hpp"

namespace kinecal::detail {

MessageValue::List texts(const std::vector<std::string>& all) {
  return list_of(all, [](const std::string& s) { return std::string_view(s); });
}

}  // namespace kinecal::detail
