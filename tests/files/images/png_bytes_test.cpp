#include "kinecal/files/images/png_bytes.hpp"

#include <gtest/gtest.h>
#include <zlib.h>

#include <stdexcept>

namespace kinecal::detail {
namespace {

std::uint32_t number_at(const std::string& text, std::size_t at) {
  std::uint32_t number = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    number = (number << 8) | static_cast<unsigned char>(text.at(at + i));
  }
  return number;
}

/// The content of the chunk after the header, unpacked; checks the checksums of both.
std::string rows_of(const std::string& file) {
  std::size_t at = 8;
  std::string packed;
  while (at < file.size()) {
    const std::uint32_t size = number_at(file, at);
    const std::string body = file.substr(at + 4, size + 4);
    EXPECT_EQ(number_at(file, at + 8 + size), crc32(0, reinterpret_cast<const Bytef*>(body.data()),
                                                    static_cast<uInt>(body.size())));
    if (body.starts_with("IDAT")) packed = body.substr(4);
    at += 12 + size;
  }
  std::string rows(1000, '\0');
  uLongf size = rows.size();
  EXPECT_EQ(uncompress(reinterpret_cast<Bytef*>(rows.data()), &size,
                       reinterpret_cast<const Bytef*>(packed.data()), packed.size()),
            Z_OK);
  rows.resize(size);
  return rows;
}

TEST(PngBytes, HoldTheImageRowByRow) {
  GrayImage image(3, 2, 7);
  image(2, 1) = 200;
  const std::string file = png_bytes(image);
  EXPECT_EQ(file.substr(0, 8), "\x89PNG\r\n\x1a\n");
  EXPECT_EQ(file.substr(12, 4), "IHDR");
  EXPECT_EQ(number_at(file, 16), 3U);
  EXPECT_EQ(number_at(file, 20), 2U);
  EXPECT_EQ(file[24], 8);
  EXPECT_EQ(rows_of(file), std::string("\0\7\7\7\0\7\7\xC8", 8));
  EXPECT_EQ(file.substr(file.size() - 8, 4), "IEND");
}

TEST(PngBytes, Of16BitsHaveTheHighByteFirst) {
  const std::string file = png_bytes(Image<std::uint16_t>(1, 1, 0x1234));
  EXPECT_EQ(file[24], 16);
  EXPECT_EQ(rows_of(file), std::string("\0\x12\x34", 3));
}

TEST(PngBytes, RefuseAnEmptyImage) {
  EXPECT_THROW(static_cast<void>(png_bytes(GrayImage())), std::invalid_argument);
}

}  // namespace
}  // namespace kinecal::detail
