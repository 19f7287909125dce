// Writes the records of a ROS 1 bag.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "kinecal/files/bags/bytes.hpp"
#include "kinecal/files/bags/ros1/records.ipp"

namespace kinecal::detail {

/// Fields of a header, or the data of a connection.  Add them alphabetically, as rosbag does.
class Ros1Text {
 public:
  Ros1Text& field(std::string_view name, std::string_view value) {
    append_number(text_, static_cast<std::uint32_t>(name.size() + 1 + value.size()));
    text_.append(name).append("=").append(value);
    return *this;
  }

  template <std::integral T>
  Ros1Text& number(std::string_view name, T value) {
    std::string raw;
    append_number(raw, value);
    return field(name, raw);
  }

  Ros1Text& op(Ros1Op op) { return number("op", static_cast<std::uint8_t>(op)); }

  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  std::string text_;
};

/// @param data  of less than 4 GB
[[nodiscard]] inline std::string ros1_record(const Ros1Text& header, Bytes data) {
  std::string record;
  record.reserve(8 + header.text().size() + data.size());
  append_number(record, static_cast<std::uint32_t>(header.text().size()));
  record += header.text();
  append_number(record, static_cast<std::uint32_t>(data.size()));
  return record.append(reinterpret_cast<const char*>(data.data()), data.size());
}

[[nodiscard]] inline std::string ros1_record(const Ros1Text& header, std::string_view data) {
  return ros1_record(header, as_bytes(data));
}

}  // namespace kinecal::detail
