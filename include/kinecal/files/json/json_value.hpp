// JSON from untrusted sources: fields of the expected type, or an error that names the field.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace kinecal::detail {

/// An error in a JSON text or one of its fields.
struct JsonError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// A value of a JSON text.  Only json_value.cpp sees the library that parses it.
class JsonValue {
 public:
  /// @throws JsonError  if the text is not JSON
  [[nodiscard]] static JsonValue parse(std::string_view text);

  /// A field of an object; nullopt if it is missing or null, or this is not an object.
  [[nodiscard]] std::optional<JsonValue> find(const std::string& field) const;

  /// Fields of an object that must be there.
  /// @throws JsonError  naming a field that is missing or of another type
  [[nodiscard]] JsonValue at(const std::string& field) const;
  [[nodiscard]] std::string text(const std::string& field) const;
  [[nodiscard]] bool flag(const std::string& field) const;
  [[nodiscard]] double number(const std::string& field) const;
  [[nodiscard]] std::uint32_t id(const std::string& field) const;
  [[nodiscard]] std::int64_t integer(const std::string& field) const;
  [[nodiscard]] std::vector<JsonValue> list(const std::string& field) const;
  [[nodiscard]] std::vector<double> numbers(const std::string& field) const;
  [[nodiscard]] std::vector<std::string> texts(const std::string& field) const;

  /// An optional text.
  /// @throws JsonError  if it has the wrong type
  [[nodiscard]] std::string text_or(const std::string& field, const std::string& otherwise) const;

  /// This value itself.
  /// @throws JsonError  naming its position if it has the wrong type
  [[nodiscard]] std::string as_text() const;
  [[nodiscard]] double as_number() const;
  [[nodiscard]] std::int64_t as_integer() const;  ///< also of 3.0; not of 0.5
  [[nodiscard]] std::uint32_t as_id() const;      ///< 0 to 2^32 - 1
  [[nodiscard]] bool is_text() const;
  [[nodiscard]] std::vector<JsonValue> as_list() const;
  [[nodiscard]] std::vector<double> as_numbers() const;
  [[nodiscard]] std::vector<std::string> as_texts() const;
  /// Fields of an object with their names, in their order.
  [[nodiscard]] std::vector<std::pair<std::string, JsonValue>> fields() const;

 private:
  struct Tree;
  JsonValue(std::shared_ptr<const Tree> tree, const void* node, std::string place)
      : tree_(std::move(tree)), node_(node), place_(std::move(place)) {}

  [[nodiscard]] JsonValue inside(const void* node, const std::string& field) const;
  [[noreturn]] void fail(const std::string& expected) const;

  std::shared_ptr<const Tree> tree_;  ///< the whole text
  const void* node_;                  ///< this value in it
  std::string place_;                 ///< "channels[0].id"
};

}  // namespace kinecal::detail
