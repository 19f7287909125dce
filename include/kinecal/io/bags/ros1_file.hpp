// The file of a ROS 1 bag: from record to record, with the data unread until they are asked for.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <istream>
#include <string>
#include <vector>

#include "kinecal/io/bags/bytes.hpp"
#include "kinecal/io/bags/ros1_record.hpp"
#include "kinecal/io/bags/unpack.hpp"

namespace kinecal::detail {

/// A record that begins in the file does not end in it.
struct CutOffError : BytesError {
  using BytesError::BytesError;
};

class Ros1File {
 public:
  /// The beginning of a record.
  struct Head {
    std::uint64_t place = 0;
    Ros1Fields fields;  ///< valid up to the next head
    std::uint64_t data_place = 0;
    std::uint32_t data_size = 0;
  };

  /// @param in  can be sought in; known() tells whether it could
  explicit Ros1File(std::istream& in) : in_(in) {
    in_.seekg(0, std::ios::end);
    const auto end = in_.tellg();
    in_.seekg(0);
    known_ = in_.good() && end >= 0;
    if (known_) size_ = static_cast<std::uint64_t>(end);
  }

  [[nodiscard]] bool known() const { return known_; }
  [[nodiscard]] std::uint64_t size() const { return size_; }
  [[nodiscard]] std::uint64_t place() const { return place_; }
  [[nodiscard]] std::uint64_t left() const { return size_ - place_; }

  /// @param place  not beyond size()
  void go_to(std::uint64_t place) {
    // A seek throws away what the stream has read ahead.
    constexpr std::uint64_t kNear = 4096;
    if (place >= place_ && place - place_ <= kNear) {
      in_.ignore(static_cast<std::streamsize>(place - place_));
    } else {
      in_.seekg(static_cast<std::streamoff>(place));
    }
    place_ = place;
  }

  /// The next `count` bytes; their memory is that of the file, which bounds them.
  /// @throws CutOffError  if there are fewer; nothing is read then
  void read(std::uint64_t count, std::vector<std::byte>& bytes) {
    if (count > left()) {
      throw CutOffError("byte " + std::to_string(place_) + ": " + std::to_string(count) +
                        " bytes are needed and " + std::to_string(left()) + " are left");
    }
    bytes.resize(static_cast<std::size_t>(count));
    in_.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(count));
    if (!in_) {
      throw CutOffError("byte " + std::to_string(place_) + ": the file cannot be read on");
    }
    place_ += count;
  }

  /// The record that begins here, without its data.
  /// @throws CutOffError  if it does not end in the file
  /// @throws BytesError   if there is none
  [[nodiscard]] Head head() {
    Head head;
    head.place = place_;
    const auto header_size = number();
    if (header_size > kMostOfAHeader) {
      throw BytesError("byte " + std::to_string(head.place) + ": no record begins here");
    }
    const std::uint64_t header_place = place_;
    read(header_size, header_);
    head.fields = Ros1Fields(header_, header_place);
    head.data_size = number();
    head.data_place = place_;
    return head;
  }

  /// @throws CutOffError  if they do not end in the file
  /// @throws BytesError   if there are more than a block may have
  void read_data(const Head& head, std::vector<std::byte>& data) {
    if (head.data_size > kMostOfABlock) {
      throw BytesError("byte " + std::to_string(head.place) + ": a record of " +
                       std::to_string(head.data_size) + " bytes; the most that is read is " +
                       std::to_string(kMostOfABlock));
    }
    go_to(head.data_place);
    read(head.data_size, data);
  }

  /// To the record that follows, if there is one.
  /// @throws CutOffError  if the data do not end in the file
  void skip_data(const Head& head) {
    if (head.data_size > size_ - head.data_place) {
      throw CutOffError("byte " + std::to_string(head.place) + ": a record of " +
                        std::to_string(head.data_size) + " bytes begins here");
    }
    go_to(head.data_place + head.data_size);
  }

 private:
  static constexpr std::uint32_t kMostOfAHeader = 1 << 20;  ///< real ones have some 100 bytes

  [[nodiscard]] std::uint32_t number() {
    read(sizeof(std::uint32_t), number_);
    return ByteReader(number_).number<std::uint32_t>();
  }

  std::istream& in_;
  bool known_ = false;
  std::uint64_t size_ = 0, place_ = 0;
  std::vector<std::byte> header_, number_;
};

}  // namespace kinecal::detail
