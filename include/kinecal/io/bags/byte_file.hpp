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
#include <span>
#include <string>
#include <system_error>
#include <vector>

#include "kinecal/io/bags/bytes.hpp"

namespace kinecal {

/// What begins in a file does not end in it.
struct CutOffError : BytesError {
  using BytesError::BytesError;
};

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
    in_.seekg(0);
  }

  [[nodiscard]] std::uint64_t size() const { return size_; }
  [[nodiscard]] std::uint64_t place() const { return place_; }
  [[nodiscard]] std::uint64_t left() const { return size_ - place_; }

  /// The next `count` bytes.
  /// @param buffer  what they are kept in; it never shrinks
  /// @throws CutOffError  if there are fewer; nothing is read then
  [[nodiscard]] Bytes read(std::uint64_t count, std::vector<std::byte>& buffer) {
    if (count > left()) fail(count);
    if (buffer.size() < count) buffer.resize(count);
    read(std::span(buffer).first(count));
    return Bytes(buffer).first(count);
  }

  /// @throws CutOffError  if there are fewer bytes; nothing is read then
  void read(std::span<std::byte> bytes) {
    if (bytes.size() > left()) fail(bytes.size());
    const auto wanted = static_cast<std::streamsize>(bytes.size());
    in_.read(reinterpret_cast<char*>(bytes.data()), wanted);
    if (in_.gcount() != wanted) {
      throw CutOffError("byte " + std::to_string(place_) + ": the file cannot be read on");
    }
    place_ += bytes.size();
  }

  /// @throws CutOffError  if there are fewer bytes
  void skip(std::uint64_t count) {
    if (count > left()) fail(count);
    go_to(place_ + count);
  }

  /// @param place  not beyond the end
  void go_to(std::uint64_t place) {
    // A seek throws away what the stream has read ahead.
    constexpr std::uint64_t kNear = 4096;
    if (place >= place_ && place - place_ <= kNear) {
      in_.ignore(static_cast<std::streamsize>(place - place_));
    } else {
      in_.clear();
      in_.seekg(static_cast<std::streamoff>(place));
    }
    place_ = place;
  }

 private:
  [[noreturn]] void fail(std::uint64_t count) const {
    throw CutOffError("byte " + std::to_string(place_) + ": " + std::to_string(count) +
                      " bytes are needed and " + std::to_string(left()) + " are left");
  }

  std::istream& in_;
  std::uint64_t size_ = 0;
  std::uint64_t place_ = 0;
};

}  // namespace kinecal
