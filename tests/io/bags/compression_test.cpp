#include "kinecal/io/bags/compression.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "kinecal/io/bags/compress.hpp"

namespace kinecal {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

struct Format {
  std::vector<std::byte> (*pack)(Bytes);
  std::vector<std::byte> (*unpack)(Bytes, std::uint64_t);
  std::string name;
};

std::vector<Format> formats() {
  std::vector<Format> all;
#ifdef KINECAL_HAVE_LZ4
  all.push_back({compress_lz4, decompress_lz4, "LZ4"});
#endif
#ifdef KINECAL_HAVE_ZSTD
  all.push_back({compress_zstd, decompress_zstd, "zstd"});
#endif
  return all;
}

/// Bytes that pack well or not at all.
std::vector<std::byte> some(std::size_t size, bool random) {
  std::vector<std::byte> bytes(size, std::byte{7});
  std::uint32_t state = 1;
  for (std::byte& byte : bytes) {
    state = state * 1664525u + 1013904223u;
    if (random) byte = static_cast<std::byte>(state >> 24);
  }
  return bytes;
}

TEST(Compression, WhatIsPackedIsUnpacked) {
  for (const Format& format : formats()) {
    for (const std::size_t size : {0, 1, 1000, 100'000, 3'000'000}) {
      for (const bool random : {false, true}) {
        const auto bytes = some(size, random);
        EXPECT_EQ(format.unpack(format.pack(bytes), size), bytes) << format.name << " " << size;
      }
    }
  }
}

TEST(Compression, SeveralFramesAreOneBlock) {
  for (const Format& format : formats()) {
    const auto bytes = some(1000, true);
    auto packed = format.pack(Bytes(bytes).first(300));
    const auto second = format.pack(Bytes(bytes).subspan(300));
    packed.insert(packed.end(), second.begin(), second.end());
    EXPECT_EQ(format.unpack(packed, 1000), bytes) << format.name;
  }
}

TEST(Compression, AnotherSizeThanTheDeclaredOneIsAnError) {
  for (const Format& format : formats()) {
    const auto packed = format.pack(some(1000, true));
    EXPECT_THAT([&] { (void)format.unpack(packed, 999); },
                ThrowsMessage<BytesError>(HasSubstr("unpacks to more than the 999")));
    EXPECT_THAT([&] { (void)format.unpack(packed, 1001); },
                ThrowsMessage<BytesError>(HasSubstr("unpacks to 1000 bytes, and 1001")));
    EXPECT_THAT([&] { (void)format.unpack(packed, 0); },
                ThrowsMessage<BytesError>(HasSubstr("unpacks to more than the 0")));
  }
}

TEST(Compression, BombsAndLiesAreErrors) {
  for (const Format& format : formats()) {
    const auto bomb = format.pack(some(50'000'000, false));
    EXPECT_LT(bomb.size(), 300'000u);
    EXPECT_THAT([&] { (void)format.unpack(bomb, 1000); },
                ThrowsMessage<BytesError>(HasSubstr("unpacks to more")));
    EXPECT_THAT([&] { (void)format.unpack(bomb, kMaxBlockBytes + 1); },
                ThrowsMessage<BytesError>(HasSubstr("1 GiB")));
    EXPECT_THAT([&] { (void)format.unpack(bomb, kMaxBlockBytes); },
                ThrowsMessage<BytesError>(HasSubstr("are declared")));
  }
}

TEST(Compression, WhatIsCutOffOrDamagedIsAnErrorOrOfTheDeclaredSize) {
  for (const Format& format : formats()) {
    const auto packed = format.pack(some(200, true));
    for (std::size_t size = 0; size < packed.size(); ++size) {
      EXPECT_THROW((void)format.unpack(Bytes(packed).first(size), 200), BytesError)
          << format.name << " " << size;
    }
    for (std::size_t at = 0; at < packed.size(); ++at) {
      auto wrong = packed;
      wrong[at] ^= std::byte{0x55};
      try {
        EXPECT_EQ(format.unpack(wrong, 200).size(), 200u);
      } catch (const BytesError&) {
      }
    }
  }
}

#ifndef KINECAL_HAVE_LZ4
TEST(Compression, WithoutLz4SaysWhatToInstall) {
  EXPECT_THAT([] { (void)decompress_lz4({}, 1); },
              ThrowsMessage<BytesError>(
                  HasSubstr("compressed with lz4, and this kinecal was built without liblz4; "
                            "install liblz4-dev and build again")));
}
#endif

#ifndef KINECAL_HAVE_ZSTD
TEST(Compression, WithoutZstdSaysWhatToInstall) {
  EXPECT_THAT([] { (void)decompress_zstd({}, 1); },
              ThrowsMessage<BytesError>(HasSubstr("install libzstd-dev and build again")));
}
#endif

}  // namespace
}  // namespace kinecal
