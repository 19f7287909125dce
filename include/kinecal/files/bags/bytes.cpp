// Messages about bytes.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/files/bags/bytes.hpp"

#include <cstdint>
#include <string>

namespace kinecal::detail {

std::string at_byte(std::uint64_t place) {
  return "byte " + std::to_string(place) + ": ";
}

std::string byte_count(std::uint64_t count) {
  return std::to_string(count) + (count == 1 ? " byte" : " bytes");
}

void ByteReader::fail(const std::string& what) const {
  throw BytesError(at_byte(place()) + what);
}

void ByteReader::fail_short_of(std::uint64_t count) const {
  fail("expected " + byte_count(count) + ", " + std::to_string(left()) + " left; is it cut off?");
}

}  // namespace kinecal::detail
