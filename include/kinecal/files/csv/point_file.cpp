// Definitions of point_file.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/files/csv/point_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <sstream>
#include <stdexcept>
#include <vector>

#include "kinecal/files/bags/bytes.hpp"
#include "kinecal/files/diagnostics.hpp"
#include "kinecal/text/printable.hpp"

namespace kinecal::detail {
namespace {

/// Numbers of each point.
struct PointProperty {
  std::string name;
  char kind = 'f';        ///< i, u or f
  std::size_t bytes = 4;  ///< of a number
  std::size_t count = 1;  ///< numbers; only single ones are read
};

/// What the header of a file says.
struct PointHeader {
  std::vector<PointProperty> properties;
  std::size_t points = 0;
  bool is_text = true;
  std::endian order = std::endian::little;
  std::size_t size = 0;  ///< bytes of the header
};

[[nodiscard]] PointProperty ply_property(const std::string& type, const std::string& name) {
  for (const auto& [names, property] :
       {std::pair{" char int8 ", PointProperty{name, 'i', 1}},
        std::pair{" uchar uint8 ", PointProperty{name, 'u', 1}},
        std::pair{" short int16 ", PointProperty{name, 'i', 2}},
        std::pair{" ushort uint16 ", PointProperty{name, 'u', 2}},
        std::pair{" int int32 ", PointProperty{name, 'i', 4}},
        std::pair{" uint uint32 ", PointProperty{name, 'u', 4}},
        std::pair{" float float32 ", PointProperty{name, 'f', 4}},
        std::pair{" double float64 ", PointProperty{name, 'f', 8}}}) {
    if (std::string(names).find(" " + type + " ") != std::string::npos) return property;
  }
  throw std::runtime_error("property '" + printable(name) + "' of vertex has the type '" +
                           printable(type) + "', which is not read");
}

/// Of PCD: I, U or F.
[[nodiscard]] char pcd_kind(const std::string& type) {
  if (type == "F" || type == "I" || type == "U") return type == "F" ? 'f' : type == "I" ? 'i' : 'u';
  throw std::runtime_error("its header has the TYPE '" + printable(type) +
                           "'; that of a field is I, U or F");
}

/// Checks that there is something to read, and that numbers have sizes that exist.
void check_properties(const PointHeader& header) {
  bool has_numbers = false;
  for (const PointProperty& property : header.properties) {
    const std::size_t bytes = property.bytes;
    const bool is_size =
        bytes == 4 || bytes == 8 || (property.kind != 'f' && (bytes == 1 || bytes == 2));
    if (!is_size) {
      throw std::runtime_error(fmt::format(
          "its field '{}' has {} of {}, which is not read", printable(property.name),
          property.kind == 'f' ? "floating-point numbers" : "numbers", byte_count(bytes)));
    }
    has_numbers = has_numbers || property.count == 1;
  }
  if (!has_numbers) throw std::runtime_error("its points have no field of one number, such as x");
}

/// The lines of a header, each with the size of the file up to its end.
class HeaderLines {
 public:
  explicit HeaderLines(std::string_view content) : content_(content) {}

  /// The words of the next line.
  /// @throws std::runtime_error  if the header does not end
  [[nodiscard]] std::vector<std::string> next() {
    const std::size_t end = content_.find('\n', size_);
    if (end == std::string_view::npos || size_ > 100'000) {
      throw std::runtime_error("its header does not end");
    }
    std::istringstream line(std::string(content_.substr(size_, end - size_)));
    size_ = end + 1;
    return {std::istream_iterator<std::string>(line), std::istream_iterator<std::string>()};
  }
  [[nodiscard]] std::size_t size() const { return size_; }

 private:
  std::string_view content_;
  std::size_t size_ = 0;
};

[[nodiscard]] std::size_t count_of(const std::string& word) {
  if (word.empty() || word.size() > 12 ||
      word.find_first_not_of("0123456789") != std::string::npos) {
    throw std::runtime_error("its header has '" + printable(word) + "' in place of a number");
  }
  return static_cast<std::size_t>(std::stoull(word));
}

[[nodiscard]] PointHeader ply_header(HeaderLines& lines) {
  PointHeader header;
  std::string element;
  while (true) {
    const std::vector<std::string> words = lines.next();
    if (words.empty()) continue;
    if (words[0] == "end_header") break;
    if (words[0] == "format" && words.size() > 1) {
      header.is_text = words[1] == "ascii";
      if (words[1] == "binary_big_endian") {
        header.order = std::endian::big;
      } else if (!header.is_text && words[1] != "binary_little_endian") {
        throw std::runtime_error("its format is '" + printable(words[1]) +
                                 "', which is not read; save it as binary_little_endian or ascii");
      }
    } else if (words[0] == "element" && words.size() > 2) {
      if (element.empty() && words[1] != "vertex") {
        throw std::runtime_error("its first element is '" + printable(words[1]) +
                                 "'; the points, 'vertex', must be first");
      }
      element = words[1];
      if (element == "vertex") header.points = count_of(words[2]);
    } else if (words[0] == "property" && element == "vertex" && words.size() > 2) {
      if (words[1] == "list") {
        throw std::runtime_error("property '" + printable(words.back()) +
                                 "' of vertex is a list, which is not read; save it without");
      }
      header.properties.push_back(ply_property(words[1], words[2]));
    }
  }
  header.size = lines.size();
  return header;
}

[[nodiscard]] PointHeader pcd_header(HeaderLines& lines) {
  PointHeader header;
  while (true) {
    const std::vector<std::string> words = lines.next();
    if (words.empty() || words[0].starts_with('#')) continue;
    const auto each = [&](const auto& set) {
      if (words.size() != header.properties.size() + 1) {
        throw std::runtime_error(fmt::format("its header has {} fields, but {} of {}",
                                             header.properties.size(), words.size() - 1,
                                             printable(words[0])));
      }
      for (std::size_t i = 1; i < words.size(); ++i) set(header.properties[i - 1], words[i]);
    };
    if (words[0] == "FIELDS") {
      for (std::size_t i = 1; i < words.size(); ++i) header.properties.push_back({words[i]});
    } else if (words[0] == "SIZE") {
      each([](PointProperty& p, const std::string& word) { p.bytes = count_of(word); });
    } else if (words[0] == "COUNT") {
      each([](PointProperty& p, const std::string& word) { p.count = count_of(word); });
    } else if (words[0] == "TYPE") {
      each([](PointProperty& p, const std::string& word) { p.kind = pcd_kind(word); });
    } else if (words[0] == "POINTS" && words.size() > 1) {
      header.points = count_of(words[1]);
    } else if (words[0] == "DATA" && words.size() > 1) {
      header.is_text = words[1] == "ascii";
      if (!header.is_text && words[1] != "binary") {
        throw std::runtime_error("its data are '" + printable(words[1]) +
                                 "', which is not read; save it as binary or ascii");
      }
      break;
    }
  }
  header.size = lines.size();
  return header;
}

template <class I>
[[nodiscard]] std::string text_of(ByteReader& bytes) {
  return fmt::format("{}", bytes.number<I>());
}

[[nodiscard]] std::string number_text(ByteReader& bytes, const PointProperty& property) {
  const bool is_signed = property.kind == 'i';
  switch (property.bytes) {
    case 1:
      return is_signed ? text_of<std::int8_t>(bytes) : text_of<std::uint8_t>(bytes);
    case 2:
      return is_signed ? text_of<std::int16_t>(bytes) : text_of<std::uint16_t>(bytes);
    case 4:
      return property.kind == 'f' ? text_of<float>(bytes)
             : is_signed          ? text_of<std::int32_t>(bytes)
                                  : text_of<std::uint32_t>(bytes);
    default:  // 8, see check_properties()
      return property.kind == 'f' ? text_of<double>(bytes)
             : is_signed          ? text_of<std::int64_t>(bytes)
                                  : text_of<std::uint64_t>(bytes);
  }
}

/// The rows of points.
/// @param data  of the file behind the header
void add_rows(const PointHeader& header, std::string_view data, std::string& table) {
  std::istringstream words{header.is_text ? std::string(data) : std::string()};
  ByteReader bytes(as_bytes(data), header.order, header.size);
  for (std::size_t i = 0; i < header.points; ++i) {
    bool is_first = true;
    for (const PointProperty& property : header.properties) {
      std::string cell;
      for (std::size_t k = 0; k < property.count; ++k) {
        if (!header.is_text) {
          cell = number_text(bytes, property);
        } else if (!(words >> cell)) {
          throw std::runtime_error(fmt::format("it ends at point {} of {}", i + 1, header.points));
        }
      }
      if (property.count != 1) continue;
      if (!is_first) table += ',';
      is_first = false;
      table += cell;
    }
    table += '\n';
  }
}

}  // namespace

std::optional<std::string> point_file_table(std::string_view content, const std::string& file) {
  const bool is_ply = content.starts_with("ply\n") || content.starts_with("ply\r\n");
  const std::string_view begin = content.substr(0, std::min<std::size_t>(content.size(), 200));
  const bool is_pcd =
      begin.find("# .PCD") != std::string_view::npos ||
      (begin.starts_with("VERSION") && begin.find("FIELDS") != std::string_view::npos);
  if (!is_ply && !is_pcd) return std::nullopt;
  try {
    HeaderLines lines(content);
    const PointHeader header = is_ply ? ply_header(lines) : pcd_header(lines);
    check_properties(header);
    std::string table;
    for (const PointProperty& property : header.properties) {
      if (property.count == 1) table += (table.empty() ? "" : ",") + property.name;
    }
    table += '\n';
    add_rows(header, content.substr(header.size), table);
    return table;
  } catch (const std::runtime_error& error) {
    throw InputError(file + ": " + error.what());
  }
}

}  // namespace kinecal::detail
