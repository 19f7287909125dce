// Content of an MCAP record while it is being written; see mcap_records.hpp.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "kinecal/io/bags/bytes.hpp"
#include "kinecal/io/bags/mcap_records.hpp"

namespace kinecal::detail {

class McapContent {
 public:
  template <std::unsigned_integral T>
  McapContent& number(T value) {
    append_number(content_, value);
    return *this;
  }

  McapContent& raw(std::string_view bytes) {
    content_ += bytes;
    return *this;
  }

  /// A text, map or array, with the count of its bytes before it.
  McapContent& text(std::string_view bytes) {
    return number(static_cast<std::uint32_t>(bytes.size())).raw(bytes);
  }

  [[nodiscard]] const std::string& str() const { return content_; }

  /// A record that begins with this content.
  /// @param more  bytes that follow it
  [[nodiscard]] std::string record(McapOp op, std::uint64_t more = 0) const {
    return McapContent()
        .number(static_cast<std::uint8_t>(op))
        .number(std::uint64_t{content_.size()} + more)
        .raw(content_)
        .str();
  }

 private:
  std::string content_;
};

}  // namespace kinecal::detail
