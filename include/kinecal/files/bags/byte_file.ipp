// A seekable, untrusted stream, read piece by piece.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <istream>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "kinecal/files/bags/bytes.hpp"
#include "kinecal/files/text_file.hpp"
#include "kinecal/samples/progress_meter.hpp"

namespace kinecal::detail {

/// An item begins in the file but ends beyond it.
struct CutOffError : BytesError {
  using BytesError::BytesError;
};

/// @throws BytesError  if the file does not exist, is a folder or may not be read
[[nodiscard]] inline std::ifstream open_bytes(const std::string& path) {
  if (const std::string why = why_no_file(path); !why.empty()) throw BytesError(why);
  errno = 0;
  std::ifstream in(path, std::ios::binary);
  if (!in) throw BytesError(std::string("cannot be opened: ") + std::strerror(errno));
  return in;
}

class ByteFile {
 public:
  /// @throws BytesError  if the stream cannot be sought to its end, like a pipe
  explicit ByteFile(std::istream& in) : in_(in) {
    in_.seekg(0, std::ios::end);
    const std::streamoff end = in_.tellg();
    if (!in_ || end < 0) throw BytesError("its size is unknown; it must be a file, not a pipe");
    size_ = static_cast<std::uint64_t>(end);
    in_.seekg(0);
  }

  /// Reports progress after each megabyte.
  /// @param what  the current activity
  void show_progress(const ProgressMeter& meter, std::string what) {
    meter_ = meter;
    what_ = std::move(what);
  }

  [[nodiscard]] std::uint64_t size() const { return size_; }
  [[nodiscard]] std::uint64_t place() const { return place_; }
  [[nodiscard]] std::uint64_t left() const { return size_ - place_; }

  /// The next `count` bytes.
  /// @param buffer  holds them; it never shrinks
  /// @throws CutOffError  if there are fewer; then reads nothing
  [[nodiscard]] Bytes read(std::uint64_t count, std::vector<std::byte>& buffer) {
    if (count > left()) fail_short_of(count);
    if (buffer.size() < count) buffer.resize(count);
    read(std::span(buffer).first(count));
    return Bytes(buffer).first(count);
  }

  /// @throws CutOffError  if there are fewer bytes; then reads nothing
  void read(std::span<std::byte> bytes) {
    if (bytes.size() > left()) fail_short_of(bytes.size());
    const auto wanted = static_cast<std::streamsize>(bytes.size());
    in_.read(reinterpret_cast<char*>(bytes.data()), wanted);
    if (in_.gcount() != wanted) {
      throw CutOffError(at_byte(place_) + "reading the file fails here");
    }
    place_ += bytes.size();
    if (meter_ && place_ / kReported != reported_) {
      reported_ = place_ / kReported;
      meter_(double(place_) / double(size_), what_);
    }
  }

  /// @throws CutOffError  if there are fewer bytes
  void skip(std::uint64_t count) {
    if (count > left()) fail_short_of(count);
    go_to(place_ + count);
  }

  /// @param place  not beyond the end
  void go_to(std::uint64_t place) {
    // A seek discards the stream's read-ahead.
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
  [[noreturn]] void fail_short_of(std::uint64_t count) const {
    throw CutOffError(at_byte(place_) + "expected " + byte_count(count) + ", " +
                      std::to_string(left()) + " left");
  }

  static constexpr std::uint64_t kReported = 1'000'000;

  std::istream& in_;
  std::uint64_t size_ = 0;
  std::uint64_t place_ = 0;
  ProgressMeter meter_;
  std::string what_;
  std::uint64_t reported_ = 0;  ///< megabyte of the last report
};

}  // namespace kinecal::detail
