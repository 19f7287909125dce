// Definitions of encode.hpp.  decode.cpp describes the format of the bytes.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/files/messages/encode.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace kinecal::detail {

/// Numbers and texts in the form of ROS 1, or in CDR, little endian.
class WireWriter {
 public:
  explicit WireWriter(Encoding encoding) : cdr_(encoding == Encoding::cdr) {
    if (cdr_) bytes_ = {std::byte{0}, std::byte{1}, std::byte{0}, std::byte{0}};
  }

  [[nodiscard]] std::vector<std::byte> take() { return std::move(bytes_); }

  template <class T>
  void number(T value) {
    if (cdr_) {
      const std::size_t misfit = (bytes_.size() - kCdrHeader) % sizeof(T);
      if (misfit > 0) bytes_.resize(bytes_.size() + sizeof(T) - misfit);
    }
    auto raw_bytes = std::bit_cast<std::array<std::byte, sizeof(T)>>(value);
    if (std::endian::native == std::endian::big) std::reverse(raw_bytes.begin(), raw_bytes.end());
    raw(raw_bytes);
  }
  void text(std::string_view text) {
    count(text.size() + (cdr_ ? 1 : 0));
    raw(as_bytes(text));
    if (cdr_) bytes_.push_back(std::byte{0});
  }
  void count(std::size_t n) {
    constexpr auto kMost = std::numeric_limits<std::uint32_t>::max();
    if (n > kMost) {
      throw BytesError("a list or text has " + std::to_string(n) +
                       " items; a message holds at most " + std::to_string(kMost));
    }
    number(static_cast<std::uint32_t>(n));
  }
  void raw(Bytes bytes) { bytes_.insert(bytes_.end(), bytes.begin(), bytes.end()); }
  void empty_message() {
    if (cdr_) bytes_.push_back(std::byte{0});
  }

 private:
  static constexpr std::size_t kCdrHeader = 4;

  bool cdr_;
  std::vector<std::byte> bytes_;
};

class Encoder {
 public:
  Encoder(const MessageDefinition& definition, Encoding encoding)
      : definition_(definition), wire_(encoding) {}

  void message(const MessageFields* value, std::size_t type = 0) {
    const MessageType& message = definition_[type];
    if (message.fields.empty()) wire_.empty_message();
    for (const MessageField& f : message.fields) {
      field(f, value == nullptr ? nullptr : value->find(f.name));
    }
  }

  [[nodiscard]] std::vector<std::byte> take() { return wire_.take(); }

 private:
  void field(const MessageField& f, const MessageValue* value) {
    if (f.count == MessageField::Count::one) return one(f, value);
    const auto* list = value == nullptr ? nullptr : value->as<MessageValue::List>();
    const auto* bytes = value == nullptr ? nullptr : value->as<Bytes>();
    std::size_t size = list != nullptr ? list->size() : bytes != nullptr ? bytes->size() : 0;
    if (f.count == MessageField::Count::any) {
      wire_.count(size);
    } else {
      size = f.size;
    }
    if (bytes != nullptr && bytes->size() == size && is_byte(f)) return wire_.raw(*bytes);
    for (std::size_t i = 0; i < size; ++i) {
      one(f, list != nullptr && i < list->size() ? &(*list)[i] : nullptr);
    }
  }

  [[nodiscard]] static bool is_byte(const MessageField& f) {
    return f.type == FieldType::uint8 || f.type == FieldType::int8;
  }

  void one(const MessageField& f, const MessageValue* value) {
    switch (f.type) {
      case FieldType::boolean:
      case FieldType::uint8:
        return number<std::uint8_t>(value);
      case FieldType::int8:
        return number<std::int8_t>(value);
      case FieldType::int16:
        return number<std::int16_t>(value);
      case FieldType::uint16:
        return number<std::uint16_t>(value);
      case FieldType::int32:
        return number<std::int32_t>(value);
      case FieldType::uint32:
        return number<std::uint32_t>(value);
      case FieldType::int64:
        return number<std::int64_t>(value);
      case FieldType::uint64:
        return number<std::uint64_t>(value);
      case FieldType::float32:
        return number<float>(value);
      case FieldType::float64:
        return number<double>(value);
      case FieldType::text: {
        const auto* text = value == nullptr ? nullptr : value->as<std::string_view>();
        return wire_.text(text == nullptr ? std::string_view() : *text);
      }
      case FieldType::message:
        break;
    }
    message(value == nullptr ? nullptr : value->as<MessageFields>(), f.message);
  }

  template <class T>
  void number(const MessageValue* value) {
    T result{};
    if (value != nullptr) {
      value->visit_number([&](auto x) { result = converted<T>(x); });
    }
    wire_.number(result);
  }

  /// Zero if the definition wants a whole number and the value is out of range.
  template <class T, class X>
  [[nodiscard]] static T converted(X x) {
    if constexpr (std::floating_point<X> && std::integral<T>) {
      constexpr double kLimit = 4503599627370496.0;  // 2^52: all doubles beyond are whole numbers
      if (!(x >= -kLimit && x <= kLimit)) return T{0};
      return static_cast<T>(static_cast<std::int64_t>(x));
    } else {
      return static_cast<T>(x);
    }
  }

  const MessageDefinition& definition_;
  WireWriter wire_;
};

std::vector<std::byte> encode(const MessageFields& value, const MessageDefinition& definition,
                              Encoding encoding) {
  Encoder encoder(definition, encoding);
  encoder.message(&value);
  return encoder.take();
}

}  // namespace kinecal::detail
