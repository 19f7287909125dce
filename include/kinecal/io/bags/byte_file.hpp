// A seekable stream that nobody trusts, read piece by piece.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <istream>
#include <string>
#include <system_error>
#include <vector>

#include "kinecal/io/bags/bytes.hpp"

namespace kinecal {

/// @throws BytesError  if it is not there, is a folder or may not be read
[[nodiscard]] inline std::ifstream open_bytes(const std::string& path) {
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored)) throw BytesError("is a folder, not a file");
  errno = 0;
  std::ifstream in(path, std::ios::binary);
  if (!in) throw BytesError(std::string("cannot be opened: ") + std::strerror(errno));
  return in;
}

class ByteFile {
 public:
  /// @throws BytesError  if the stream has no end that can be gone to, as a pipe
  explicit ByteFile(std::istream& in) : in_(in) {
    in_.seekg(0, std::ios::end);
    const std::streamoff end = in_.tellg();
    if (!in_ || end < 0) throw BytesError("its size is unknown; it must be a file, not a pipe");
    size_ = static_cast<std::uint64_t>(end);
    go_to(0);
  }

  [[nodiscard]] std::uint64_t size() const { return size_; }
  [[nodiscard]] std::uint64_t place() const { return place_; }
  [[nodiscard]] std::uint64_t left() const { return size_ - place_; }

  /// The next `count` bytes.
  /// @param buffer  what they are kept in; it never shrinks
  /// @throws BytesError  if there are fewer
  [[nodiscard]] Bytes read(std::uint64_t count, std::vector<std::byte>& buffer) {
    if (count > left()) fail(count);
    if (buffer.size() < count) buffer.resize(count);
    const auto wanted = static_cast<std::streamsize>(count);
    in_.read(reinterpret_cast<char*>(buffer.data()), wanted);
    if (in_.gcount() != wanted) fail(count);
    place_ += count;
    return Bytes(buffer).first(count);
  }

  void skip(std::uint64_t count) {
    // What stands in the stream's buffer costs less to drop than to read again.
    constexpr std::uint64_t kNear = 4096;
    if (count > left()) fail(count);
    if (count > kNear) return go_to(place_ + count);
    in_.ignore(static_cast<std::streamsize>(count));
    place_ += count;
  }

  /// @param place  not beyond the end
  void go_to(std::uint64_t place) {
    in_.clear();
    in_.seekg(static_cast<std::streamoff>(place));
    place_ = place;
  }

 private:
  [[noreturn]] void fail(std::uint64_t count) const {
    throw BytesError("byte " + std::to_string(place_) + ": " + std::to_string(count) +
                     " bytes are needed and cannot be read; is it cut off?");
  }

  std::istream& in_;
  std::uint64_t size_ = 0;
  std::uint64_t place_ = 0;
};

}  // namespace kinecal
