// Content of an MCAP record while it is being written; see mcap_records.hpp.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <bit>
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
    auto raw = std::bit_cast<std::array<char, sizeof(T)>>(value);
    if constexpr (std::endian::native == std::endian::big) std::reverse(raw.begin(), raw.end());
    content_.append(raw.data(), raw.size());
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

[[nodiscard]] inline Bytes as_bytes(std::string_view text) {
  return std::as_bytes(std::span(text.data(), text.size()));
}

}  // namespace kinecal::detail
