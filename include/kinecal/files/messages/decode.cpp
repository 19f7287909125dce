// Definitions of decode.hpp.
//
//   ROS 1   little endian, unaligned; texts and lists follow a uint32 length
//   CDR     a header of 4 bytes, the second of which gives the byte order; a number of N bytes
//           stands at a multiple of N after the header; the length of a text counts its final NUL
//
// The bytes are untrusted.  A length is checked against the remaining bytes before memory is
// allocated.  A decoded value takes more memory than its bytes, so the number of values is limited.
// Source: ROS 1 wiki, Connection header and msg; OMG CORBA 3.0, 15.3; DDSI-RTPS 2.2, 10; DDS-XTypes
// 1.3, 7.6.3.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/files/messages/decode.hpp"

#include <bit>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace kinecal::detail {

/// Numbers and texts in the form of ROS 1.
class Ros1Wire {
 public:
  explicit Ros1Wire(Bytes data) : reader_(data) {}

  [[nodiscard]] ByteReader& reader() { return reader_; }

  template <class T>
  [[nodiscard]] T number() {
    return reader_.number<T>();
  }
  [[nodiscard]] std::string_view text() { return reader_.text(number<std::uint32_t>()); }
  void empty_message() {}

 private:
  ByteReader reader_;
};

/// Numbers and texts in CDR.
class CdrWire {
 public:
  /// @throws BytesError  if it is not plain CDR
  explicit CdrWire(Bytes data) : reader_(data) {
    const auto kind = ByteReader(data, std::endian::big).number<std::uint16_t>();
    if (kind > 1) {
      const bool lists_parameters = kind == 2 || kind == 3;
      const bool is_second = kind >= 6 && kind <= 11;
      reader_.fail("the message is " +
                   std::string(lists_parameters ? "PL_CDR"
                               : is_second      ? "XCDR version 2"
                                                : "not CDR") +
                   " (its first bytes are " + std::to_string(kind >> 8) + " " +
                   std::to_string(kind & 0xff) + "); only plain CDR can be read");
    }
    reader_.skip(kHeader);
    const auto order = kind == 1 ? std::endian::little : std::endian::big;
    reader_ = ByteReader(data.subspan(kHeader), order, kHeader);
  }

  [[nodiscard]] ByteReader& reader() { return reader_; }

  template <class T>
  [[nodiscard]] T number() {
    reader_.skip((sizeof(T) - reader_.read() % sizeof(T)) % sizeof(T));
    return reader_.number<T>();
  }
  [[nodiscard]] std::string_view text() {
    const std::string_view text = reader_.text(number<std::uint32_t>());
    return text.ends_with('\0') ? text.substr(0, text.size() - 1) : text;
  }
  /// A message without fields takes one byte.
  void empty_message() { reader_.skip(1); }

 private:
  static constexpr std::size_t kHeader = 4;

  ByteReader reader_;
};

template <class Wire>
class Decoder {
 public:
  Decoder(const MessageDefinition& definition, Bytes data) : definition_(definition), wire_(data) {}

  [[nodiscard]] MessageFields message(std::size_t type = 0) {
    MessageFields result;
    const MessageType& message = definition_[type];
    if (message.fields.empty()) {
      wire_.empty_message();
      // In ROS 1 it takes no bytes, so a few bytes could claim any number of them.
      if (++empty_ > kMostEmpty) {
        wire_.reader().fail("the message has more than " + std::to_string(kMostEmpty) +
                            " messages without fields in it");
      }
    }
    result.fields.reserve(message.fields.size());
    for (const MessageField& f : message.fields) result.fields.emplace_back(f.name, field(f));
    return result;
  }

 private:
  [[nodiscard]] MessageValue field(const MessageField& f) {
    if (f.count == MessageField::Count::one) return one(f);
    const std::uint32_t count =
        f.count == MessageField::Count::fixed ? f.size : wire_.template number<std::uint32_t>();
    if (count > wire_.reader().left()) {
      wire_.reader().fail("'" + f.name + "' has " + std::to_string(count) + " items but only " +
                          std::to_string(wire_.reader().left()) +
                          " bytes are left; is it cut off?");
    }
    if (f.type == FieldType::uint8 || f.type == FieldType::int8) return wire_.reader().take(count);
    MessageValue::List list;
    for (std::uint32_t i = 0; i < count; ++i) list.push_back(one(f));
    return list;
  }

  [[nodiscard]] MessageValue one(const MessageField& f) {
    if (++values_ > kMostValues) {
      wire_.reader().fail("the message has more than " + std::to_string(kMostValues) + " values");
    }
    switch (f.type) {
      case FieldType::boolean:
      case FieldType::uint8:
        return std::uint64_t{wire_.template number<std::uint8_t>()};
      case FieldType::int8:
        return std::int64_t{wire_.template number<std::int8_t>()};
      case FieldType::int16:
        return std::int64_t{wire_.template number<std::int16_t>()};
      case FieldType::uint16:
        return std::uint64_t{wire_.template number<std::uint16_t>()};
      case FieldType::int32:
        return std::int64_t{wire_.template number<std::int32_t>()};
      case FieldType::uint32:
        return std::uint64_t{wire_.template number<std::uint32_t>()};
      case FieldType::int64:
        return wire_.template number<std::int64_t>();
      case FieldType::uint64:
        return wire_.template number<std::uint64_t>();
      case FieldType::float32:
        return static_cast<double>(wire_.template number<float>());
      case FieldType::float64:
        return wire_.template number<double>();
      case FieldType::text:
        return wire_.text();
      case FieldType::message:
        break;
    }
    return message(f.message);
  }

  static constexpr std::size_t kMostEmpty = 1000;
  static constexpr std::size_t kMostValues = std::size_t{1} << 20;  ///< enough for 100 000 features

  const MessageDefinition& definition_;
  Wire wire_;
  std::size_t empty_ = 0, values_ = 0;
};

MessageFields decode(const MessageDefinition& definition, Encoding encoding, Bytes data) {
  if (encoding == Encoding::ros1) {
    return Decoder<Ros1Wire>(definition, data).message();
  }
  return Decoder<CdrWire>(definition, data).message();
}

}  // namespace kinecal::detail
