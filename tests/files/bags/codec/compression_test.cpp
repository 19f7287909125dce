#include "kinecal/files/bags/codec/compression.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstddef>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "kinecal/files/bags/codec/block_unpacker.ipp"
#include "kinecal/files/bags/codec/unpack.ipp"
#include "support/thrown.hpp"

namespace kinecal {
namespace {

using namespace detail;

using ::testing::HasSubstr;

constexpr std::size_t kMegabyte = 1 << 20;

std::vector<Compression> available() {
  std::vector<Compression> found;
  for (const Compression c : {Compression::bz2, Compression::lz4, Compression::zstd}) {
    if (is_available(c)) found.push_back(c);
  }
  return found;
}

/// Half of it can be compressed.
std::vector<std::byte> some_bytes(std::size_t count) {
  std::mt19937 random(1);
  std::vector<std::byte> bytes(count);
  for (std::size_t i = 0; i < count; i += 2) bytes[i] = static_cast<std::byte>(random() & 0xff);
  return bytes;
}

/// What unpack() says is wrong; empty if nothing is.
std::string mistake(const std::vector<std::byte>& packed, Compression compression,
                    std::optional<std::uint64_t> size, std::vector<std::byte>& out) {
  return test::thrown<BytesError>([&] { unpack(packed, compression, size, out); }, "");
}

TEST(Compression, WhatIsPackedUnpacksToTheSame) {
  for (const Compression c : available()) {
    for (const std::size_t count : {std::size_t{0}, std::size_t{1}, std::size_t{65536},
                                    std::size_t{65537}, kMegabyte, 5 * kMegabyte + 3}) {
      const auto bytes = some_bytes(count);
      const auto packed = pack(bytes, c);
      std::vector<std::byte> out(17);
      EXPECT_EQ(mistake(packed, c, count, out), "") << to_string(c) << ", " << count;
      EXPECT_TRUE(out == bytes) << to_string(c) << ", " << count;
      EXPECT_EQ(mistake(packed, c, std::nullopt, out), "") << to_string(c) << ", " << count;
      EXPECT_TRUE(out == bytes) << to_string(c) << ", " << count << ", of unknown size";
    }
  }
}

TEST(Compression, OneStreamMayFollowAnother) {
  for (const Compression c : available()) {
    const auto bytes = some_bytes(1000);
    auto twice = pack(bytes, c);
    twice.insert(twice.end(), twice.begin(), twice.end());
    std::vector<std::byte> out;
    EXPECT_EQ(mistake(twice, c, 2000, out), "") << to_string(c);
    EXPECT_EQ(out.size(), 2000u);
  }
}

TEST(Compression, AnotherSizeThanWhatIsClaimedIsAnError) {
  for (const Compression c : available()) {
    const auto packed = pack(some_bytes(100'000), c);
    std::vector<std::byte> out;
    EXPECT_EQ(mistake(packed, c, 99'999, out), "does not unpack to 99999 bytes, but to more");
    EXPECT_EQ(mistake(packed, c, 0, out), "does not unpack to 0 bytes, but to more");
    EXPECT_EQ(mistake(packed, c, 100'001, out), "does not unpack to 100001 bytes, but to 100000");
    EXPECT_THAT(mistake(packed, c, std::uint64_t{1} << 62, out),
                HasSubstr("claims to unpack from "));
  }
}

TEST(Compression, WhatIsCutOffAnywhereIsAnError) {
  for (const Compression c : available()) {
    const auto packed = pack(some_bytes(500), c);
    std::vector<std::byte> out;
    for (std::size_t length = 0; length < packed.size(); ++length) {
      const std::vector<std::byte> cut(packed.begin(), packed.begin() + std::ptrdiff_t(length));
      EXPECT_NE(mistake(cut, c, 500, out), "") << to_string(c) << ", " << length;
      EXPECT_NE(mistake(cut, c, std::nullopt, out), "") << to_string(c);
    }
  }
}

TEST(Compression, DamageAnywhereIsAnErrorOrDoesNoHarm) {
  for (const Compression c : available()) {
    const auto packed = pack(some_bytes(500), c);
    std::vector<std::byte> out;
    for (std::size_t i = 0; i < packed.size(); ++i) {
      for (const int bits : {0x01, 0x80, 0xff}) {
        auto damaged = packed;
        damaged[i] ^= static_cast<std::byte>(bits);
        EXPECT_TRUE(!mistake(damaged, c, 500, out).empty() || out.size() == 500u);
      }
    }
  }
}

/// 64 MB of zeros are 50 bytes of bz2, 6 kB of zstd and 260 kB of lz4.
TEST(Compression, ABombTakesNoMoreMemoryThanIsPlausible) {
  const std::vector<std::byte> zeros(64 * kMegabyte);
  for (const Compression c : available()) {
    const auto packed = pack(zeros, c);
    std::vector<std::byte> out;
    const std::uint64_t most = most_unpacked(packed.size());
    if (most >= zeros.size()) continue;  // lz4 does not pack that well
    EXPECT_EQ(mistake(packed, c, most, out),
              "does not unpack to " + std::to_string(most) + " bytes, but to more");
    EXPECT_LE(out.capacity(), 33 * kMegabyte) << to_string(c);
    EXPECT_THAT(mistake(packed, c, zeros.size(), out), HasSubstr("are plausible")) << to_string(c);
  }
}

TEST(Compression, WhatIsClaimedIsNotReserved) {
  for (const Compression c : available()) {
    std::vector<std::byte> out;
    EXPECT_NE(mistake(pack(some_bytes(10), c), c, 32 * kMegabyte, out), "");
    EXPECT_LE(out.capacity(), kMegabyte) << to_string(c);
  }
}

TEST(Compression, PlausibleSizesAreBounded) {
  EXPECT_EQ(most_unpacked(0), std::uint64_t{1} << 25);
  EXPECT_EQ(most_unpacked(kMegabyte), 256 * kMegabyte);
  EXPECT_EQ(most_unpacked(~std::uint64_t{0}), kMostOfABlock);
}

TEST(Compression, ManySmallBombsAreOneLargeOne) {
  if (available().empty()) GTEST_SKIP() << "built without any";
  const auto packed = pack(std::vector<std::byte>(31 * kMegabyte), available().back());
  BlockUnpacker unpack;
  const auto block = [&] { return unpack(packed, available().back(), 31 * kMegabyte).size(); };
  for (int i = 0; i < 33; ++i) EXPECT_EQ(block(), 31 * kMegabyte);
  EXPECT_THROW((void)block(), BytesError);
}

TEST(Compression, PlausibleSizesOfAllBlocksAreBounded) {
  EXPECT_EQ(most_unpacked_in_all(0), kMostOfABlock);
  EXPECT_EQ(most_unpacked_in_all(10 * kMostOfABlock), 2560 * kMostOfABlock);
  EXPECT_GE(most_unpacked_in_all(~std::uint64_t{0}), ~std::uint64_t{0} - 255);
}

TEST(Compression, BlocksThatAreNotCompressedAreNotCopied) {
  const auto bytes = some_bytes(100);
  BlockUnpacker unpack;
  EXPECT_EQ(unpack(bytes, Compression::none, 100).data(), bytes.data());
  EXPECT_THROW((void)unpack(bytes, Compression::none, 99), BytesError);
}

TEST(Compression, NoneIsCopied) {
  const auto bytes = some_bytes(100);
  std::vector<std::byte> out;
  EXPECT_EQ(mistake(bytes, Compression::none, 100, out), "");
  EXPECT_EQ(out, bytes);
  EXPECT_EQ(pack(bytes, Compression::none), bytes);
  EXPECT_EQ(mistake(bytes, Compression::none, 99, out), "has 100 bytes, not the 99 that it claims");
}

TEST(Compression, NamesAreThoseOfBags) {
  for (const Compression c :
       {Compression::none, Compression::bz2, Compression::lz4, Compression::zstd}) {
    EXPECT_EQ(compression_named(to_string(c)), c);
  }
  EXPECT_EQ(compression_named(""), Compression::none);
  EXPECT_EQ(compression_named("gz"), std::nullopt);
}

TEST(Compression, AMissingLibraryIsNamed) {
  EXPECT_EQ(not_available(Compression::lz4),
            "is compressed with lz4, and this kinecal was built without liblz4; install liblz4-dev "
            "and build again");
  for (const Compression c : {Compression::bz2, Compression::lz4, Compression::zstd}) {
    if (is_available(c)) continue;
    std::vector<std::byte> out;
    EXPECT_EQ(mistake(some_bytes(10), c, 10, out), not_available(c));
    EXPECT_THROW((void)pack(out, c), std::invalid_argument);
  }
}

}  // namespace
}  // namespace kinecal
