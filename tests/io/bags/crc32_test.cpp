#include "kinecal/io/bags/crc32.hpp"

#include <gtest/gtest.h>

#include <string>

namespace kinecal {
namespace {

std::uint32_t sum(std::string_view text, std::uint32_t before = 0) {
  return crc32(std::as_bytes(std::span(text.data(), text.size())), before);
}

TEST(Crc32, IsThatOfTheCatalogues) {
  EXPECT_EQ(sum("123456789"), 0xCBF43926u);  // the check value of CRC-32/ISO-HDLC
  EXPECT_EQ(sum(""), 0u);
}

TEST(Crc32, GoesOnWhereItStopped) {
  const std::string text = "bytes that are summed in two goes, each of any length";
  for (std::size_t size = 0; size <= text.size(); ++size) {
    EXPECT_EQ(sum(text.substr(size), sum(text.substr(0, size))), sum(text)) << size;
  }
}

}  // namespace
}  // namespace kinecal
