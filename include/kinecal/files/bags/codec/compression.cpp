// Chooses the library that packs or unpacks.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/files/bags/codec/compression.hpp"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "kinecal/files/bags/codec/bz2.ipp"
#include "kinecal/files/bags/codec/lz4.ipp"
#include "kinecal/files/bags/codec/unpack.ipp"
#include "kinecal/files/bags/codec/zstd.ipp"

namespace kinecal {

std::string_view to_string(Compression compression) {
  switch (compression) {
    case Compression::bz2:
      return "bz2";
    case Compression::lz4:
      return "lz4";
    case Compression::zstd:
      return "zstd";
    case Compression::none:
      break;
  }
  return "none";
}

bool is_available(Compression compression) {
  switch (compression) {
    case Compression::bz2:
      return detail::kHaveBz2;
    case Compression::lz4:
      return detail::kHaveLz4;
    case Compression::zstd:
      return detail::kHaveZstd;
    case Compression::none:
      break;
  }
  return true;
}

namespace detail {

std::optional<Compression> compression_named(std::string_view text) {
  using enum Compression;
  for (const Compression c : {none, bz2, lz4, zstd}) {
    if (text == to_string(c)) return c;
  }
  return text.empty() ? std::optional(none) : std::nullopt;
}

void unpack([[maybe_unused]] Bytes packed, Compression compression,
            [[maybe_unused]] std::optional<std::uint64_t> size,
            [[maybe_unused]] std::vector<std::byte>& out) {
  switch (compression) {
#ifdef KINECAL_HAVE_BZ2
    case Compression::bz2: {
      UnpackBz2 unpacker;
      return unpack_with(unpacker, packed, size, out);
    }
#endif
#ifdef KINECAL_HAVE_LZ4
    case Compression::lz4: {
      UnpackLz4 unpacker;
      return unpack_with(unpacker, packed, size, out);
    }
#endif
#ifdef KINECAL_HAVE_ZSTD
    case Compression::zstd: {
      UnpackZstd unpacker(packed.size());
      return unpack_with(unpacker, packed, size, out);
    }
#endif
    case Compression::none:
      check_size(packed, size);
      out.assign(packed.begin(), packed.end());
      return;
    default:
      throw BytesError(not_available(compression));
  }
}

std::vector<std::byte> pack(Bytes bytes, Compression compression) {
  switch (compression) {
#ifdef KINECAL_HAVE_BZ2
    case Compression::bz2:
      return pack_bz2(bytes);
#endif
#ifdef KINECAL_HAVE_LZ4
    case Compression::lz4:
      return pack_lz4(bytes);
#endif
#ifdef KINECAL_HAVE_ZSTD
    case Compression::zstd:
      return pack_zstd(bytes);
#endif
    case Compression::none:
      return {bytes.begin(), bytes.end()};
    default:
      throw std::invalid_argument("what is to be packed " + not_available(compression));
  }
}

std::string not_available(Compression compression) {
  const std::string library = "lib" + std::string(to_string(compression));
  return "is compressed with " + std::string(to_string(compression)) +
         ", and this kinecal was built without " + library + "; install " + library +
         "-dev and build again";
}

}  // namespace detail

}  // namespace kinecal
