// Definitions of json_value.hpp, with nlohmann-json.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/files/json/json_value.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "kinecal/files/json/json_text.hpp"
#include "kinecal/text/printable.hpp"

namespace kinecal::detail {

struct JsonValue::Tree {  // NOLINT(bugprone-exception-escape): moving JSON throws nothing
  Json json;
};

[[nodiscard]] inline const Json& json_at(const void* node) {
  return *static_cast<const Json*>(node);
}

JsonValue JsonValue::parse(std::string_view text) {
  auto tree = std::make_shared<Tree>();
  try {
    tree->json = Json::parse(text);
  } catch (const Json::parse_error& error) {
    constexpr std::size_t kShown = 60;
    if (text.empty()) throw JsonError("it is an empty line");
    const std::size_t end =
        std::min(std::max(error.byte, kShown), text.size());  // of what is shown
    const std::size_t begin = end > kShown ? end - kShown : 0;
    const std::string shown = (begin > 0 ? "'..." : "'") +
                              printable(text.substr(begin, end - begin)) +
                              (end < text.size() ? "...' is not JSON" : "' is not JSON");
    throw JsonError(shown + (error.byte > text.size()
                                 ? ": it ends too early"
                                 : ", from character " + std::to_string(error.byte) + " on"));
  } catch (const Json::exception&) {  // 1e999
    throw JsonError("it has a number that is too large");
  }
  const void* root = &tree->json;
  return {std::move(tree), root, {}};
}

std::optional<JsonValue> JsonValue::find(const std::string& field) const {
  const Json& json = json_at(node_);
  if (!json.is_object()) return std::nullopt;
  const auto found = json.find(field);
  if (found == json.end() || found->is_null()) return std::nullopt;
  return inside(&*found, field);
}

JsonValue JsonValue::inside(const void* node, const std::string& field) const {
  return {tree_, node, place_.empty() ? field : place_ + "." + field};
}

std::vector<std::pair<std::string, JsonValue>> JsonValue::fields() const {
  const Json& json = json_at(node_);
  if (!json.is_object()) fail("an object");
  std::vector<std::pair<std::string, JsonValue>> all;
  for (const auto& [name, value] : json.items()) all.emplace_back(name, inside(&value, name));
  return all;
}

bool JsonValue::is_text() const {
  return json_at(node_).is_string();
}

std::string JsonValue::as_text() const {
  if (!is_text()) fail("a text");
  return json_at(node_).get<std::string>();
}

double JsonValue::as_number() const {
  if (!json_at(node_).is_number()) fail("a number");
  return json_at(node_).get<double>();
}

std::int64_t JsonValue::as_integer() const {
  const Json& json = json_at(node_);
  if (json.is_number_unsigned() &&
      json.get<std::uint64_t>() > std::uint64_t{std::numeric_limits<std::int64_t>::max()}) {
    fail("a number below 2^63");
  }
  if (json.is_number_integer()) return json.get<std::int64_t>();
  const double number = as_number();
  constexpr double kLimit = 9.0e18;
  if (!(std::abs(number) < kLimit) || number != std::floor(number)) fail("a whole number");
  return static_cast<std::int64_t>(number);
}

std::vector<JsonValue> JsonValue::as_list() const {
  if (!json_at(node_).is_array()) fail("a list");
  std::vector<JsonValue> items;
  for (const Json& item : json_at(node_)) {
    items.push_back({tree_, &item, place_ + "[" + std::to_string(items.size()) + "]"});
  }
  return items;
}

void JsonValue::fail(const std::string& expected) const {
  throw JsonError(
      (place_.empty() ? "it" : "field '" + printable(place_) + "'") + " is " +
      (json_at(node_).is_number() ? json_at(node_).dump() : json_at(node_).type_name()) +
      "; expected " + expected);
}

std::uint32_t JsonValue::as_id() const {
  const std::int64_t number = as_integer();
  if (number < 0 || number > std::int64_t{std::numeric_limits<std::uint32_t>::max()}) {
    fail("a number from 0 to 2^32 - 1");
  }
  return static_cast<std::uint32_t>(number);
}

JsonValue JsonValue::at(const std::string& field) const {
  if (auto found = find(field)) return *found;
  throw JsonError((place_.empty() ? "it" : "'" + printable(place_) + "'") + " has no field '" +
                  field + "'");
}

std::string JsonValue::text(const std::string& name) const {
  return at(name).as_text();
}
double JsonValue::number(const std::string& name) const {
  return at(name).as_number();
}
std::uint32_t JsonValue::id(const std::string& name) const {
  return at(name).as_id();
}
std::int64_t JsonValue::integer(const std::string& name) const {
  return at(name).as_integer();
}
std::vector<JsonValue> JsonValue::list(const std::string& name) const {
  return at(name).as_list();
}
bool JsonValue::flag(const std::string& name) const {
  const JsonValue value = at(name);
  if (!json_at(value.node_).is_boolean()) value.fail("true or false");
  return json_at(value.node_).get<bool>();
}
std::vector<double> JsonValue::as_numbers() const {
  std::vector<double> numbers;
  for (const JsonValue& item : as_list()) numbers.push_back(item.as_number());
  return numbers;
}
std::vector<std::string> JsonValue::as_texts() const {
  std::vector<std::string> texts;
  for (const JsonValue& item : as_list()) texts.push_back(item.as_text());
  return texts;
}
std::vector<double> JsonValue::numbers(const std::string& name) const {
  return at(name).as_numbers();
}
std::vector<std::string> JsonValue::texts(const std::string& name) const {
  return at(name).as_texts();
}
std::string JsonValue::text_or(const std::string& name, const std::string& otherwise) const {
  const auto found = find(name);
  return found ? found->as_text() : otherwise;
}

}  // namespace kinecal::detail
