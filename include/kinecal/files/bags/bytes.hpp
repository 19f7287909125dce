// Untrusted bytes: numbers and texts are read within bounds, or not at all.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>

namespace kinecal {

/// Bytes owned by someone else.
using Bytes = std::span<const std::byte>;

namespace detail {

/// Unexpected bytes: "byte 1234: what is wrong".
struct BytesError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Reads from the front of bytes.  Throws instead of reading beyond their end.
class ByteReader {
 public:
  /// @param start  position of the first byte in its file, for messages
  explicit ByteReader(Bytes bytes, std::endian order = std::endian::little, std::uint64_t start = 0)
      : bytes_(bytes), order_(order), start_(start) {}

  [[nodiscard]] std::size_t read() const { return read_; }                  ///< bytes so far
  [[nodiscard]] std::size_t left() const { return bytes_.size() - read_; }  ///< bytes to come
  [[nodiscard]] bool at_end() const { return left() == 0; }  ///< true if everything was read
  [[nodiscard]] std::uint64_t place() const { return start_ + read_; }  ///< of the next byte

  /// The next number, in the byte order of the reader.
  /// @throws BytesError  if there are not enough bytes
  template <class T>
  requires std::integral<T> || std::floating_point<T>
  [[nodiscard]] T number() {
    std::array<std::byte, sizeof(T)> raw;
    std::memcpy(raw.data(), take(sizeof(T)).data(), sizeof(T));
    if (order_ != std::endian::native) std::reverse(raw.begin(), raw.end());
    return std::bit_cast<T>(raw);
  }

  /// The next `count` bytes.
  /// @throws BytesError  if there are fewer
  [[nodiscard]] Bytes take(std::uint64_t count) {
    if (count > left()) fail_short_of(count);
    const Bytes taken = bytes_.subspan(read_, static_cast<std::size_t>(count));
    read_ += taken.size();
    return taken;
  }

  /// Skips bytes.
  /// @throws BytesError  if there are fewer
  void skip(std::uint64_t count) { (void)take(count); }

  /// The next `count` bytes as text.
  /// @throws BytesError  if there are fewer
  [[nodiscard]] std::string_view text(std::uint64_t count) {
    const Bytes taken = take(count);
    return {reinterpret_cast<const char*>(taken.data()), taken.size()};
  }

  /// @throws BytesError  "byte 1234: what"
  [[noreturn]] void fail(const std::string& what) const;

 private:
  [[noreturn]] void fail_short_of(std::uint64_t count) const;

  Bytes bytes_;
  std::endian order_;
  std::uint64_t start_;
  std::size_t read_ = 0;
};

[[nodiscard]] inline Bytes as_bytes(std::string_view text) {
  return std::as_bytes(std::span(text));
}

/// Little endian.
template <std::integral T>
void append_number(std::string& bytes, T number) {
  auto raw = std::bit_cast<std::array<char, sizeof(T)>>(number);
  if constexpr (std::endian::native != std::endian::little) std::reverse(raw.begin(), raw.end());
  bytes.append(raw.data(), raw.size());
}

/// "byte 1234: ", the beginning of messages about bytes.
[[nodiscard]] std::string at_byte(std::uint64_t place);

/// "1 byte", "2 bytes".
[[nodiscard]] std::string byte_count(std::uint64_t count);

}  // namespace detail

}  // namespace kinecal
