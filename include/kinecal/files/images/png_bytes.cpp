// Definitions of png_bytes.hpp.
// Source: Portable Network Graphics Specification (W3C, 2003), 5 and 11.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/files/images/png_bytes.hpp"

#include <zlib.h>

#include <stdexcept>
#include <string>

namespace kinecal::detail {

/// The lowest bytes of a number, most significant first.
inline void append_big_endian(std::string& out, std::uint32_t number, int bytes) {
  for (int i = bytes - 1; i >= 0; --i) out.push_back(static_cast<char>(number >> (8 * i)));
}

/// A chunk: its length, its name, its content, its checksum.
inline void append_png_chunk(std::string& out, const std::string& name,
                             const std::string& content) {
  append_big_endian(out, static_cast<std::uint32_t>(content.size()), 4);
  const std::string body = name + content;
  out += body;
  const auto* bytes = reinterpret_cast<const Bytef*>(body.data());
  append_big_endian(out, static_cast<std::uint32_t>(crc32_z(0, bytes, body.size())), 4);
}

inline void append_pixel(std::string& out, std::uint8_t gray) {
  append_big_endian(out, gray, 1);
}
inline void append_pixel(std::string& out, std::uint16_t gray) {
  append_big_endian(out, gray, 2);
}

template <class P>
[[nodiscard]] std::string png_of(const Image<P>& image) {
  if (image.empty()) throw std::invalid_argument("an image without pixels cannot be written");
  constexpr char kBits = sizeof(P) == 2 ? 16 : 8, kGray = 0, kNoFilter = 0;
  std::string header, rows;
  append_big_endian(header, static_cast<std::uint32_t>(image.width), 4);
  append_big_endian(header, static_cast<std::uint32_t>(image.height), 4);
  header += {kBits, kGray, 0, 0, 0};
  for (int v = 0; v < image.height; ++v) {
    rows.push_back(kNoFilter);
    for (int u = 0; u < image.width; ++u) append_pixel(rows, image(u, v));
  }
  uLongf size = compressBound(rows.size());
  std::string packed(size, '\0');
  constexpr int kLevel = 6;
  const int result = compress2(reinterpret_cast<Bytef*>(packed.data()), &size,
                               reinterpret_cast<const Bytef*>(rows.data()), rows.size(), kLevel);
  if (result != Z_OK) throw std::runtime_error("an image could not be compressed");
  packed.resize(size);
  std::string file = "\x89PNG\r\n\x1a\n";
  append_png_chunk(file, "IHDR", header);
  append_png_chunk(file, "IDAT", packed);
  append_png_chunk(file, "IEND", "");
  return file;
}

std::string png_bytes(const GrayImage& image) {
  return png_of(image);
}

std::string png_bytes(const Image<std::uint16_t>& image) {
  return png_of(image);
}

}  // namespace kinecal::detail
