// How blocks of bags are compressed: bz2 and lz4 in ROS 1, lz4 and zstd in MCAP, zstd in SQLite.
//
// The libraries are optional when kinecal is built: KINECAL_HAVE_BZ2, _LZ4 and _ZSTD tell which
// were there, and a block that needs another is an error that names what to install.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "kinecal/io/bags/bytes.hpp"
#include "kinecal/io/bags/codec_bz2.hpp"
#include "kinecal/io/bags/codec_lz4.hpp"
#include "kinecal/io/bags/codec_zstd.hpp"
#include "kinecal/io/bags/unpack.hpp"

namespace kinecal {

enum class Compression { none, bz2, lz4, zstd };

[[nodiscard]] constexpr std::string_view to_string(Compression compression) {
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

/// As bags name it, MCAP's "" for none included.
[[nodiscard]] constexpr std::optional<Compression> compression_named(std::string_view text) {
  using enum Compression;
  for (const Compression c : {none, bz2, lz4, zstd}) {
    if (text == to_string(c)) return c;
  }
  return text.empty() ? std::optional(none) : std::nullopt;
}

/// Whether this kinecal was built with what it needs.
[[nodiscard]] constexpr bool is_available(Compression compression) {
  return compression == Compression::none ||
         (compression == Compression::bz2 && detail::kHaveBz2) ||
         (compression == Compression::lz4 && detail::kHaveLz4) ||
         (compression == Compression::zstd && detail::kHaveZstd);
}

namespace detail {

/// "is compressed with lz4, and ...": a predicate without its subject.
[[nodiscard]] inline std::string not_available(Compression compression) {
  const std::string library = "lib" + std::string(to_string(compression));
  return "is compressed with " + std::string(to_string(compression)) +
         ", and this kinecal was built without " + library + "; install " + library +
         "-dev and build again";
}

inline void check_size(Bytes bytes, std::optional<std::uint64_t> size) {
  if (size.value_or(bytes.size()) == bytes.size()) return;
  throw BytesError("has " + std::to_string(bytes.size()) + " bytes, not the " +
                   std::to_string(*size) + " that it claims");
}

}  // namespace detail

/// @param size  bytes that must come out, where the bag tells
/// @param out   holds them, and nothing else; its memory is used again
/// @throws BytesError  "is compressed with lz4, and ...", a predicate without its subject: the
///                     library is missing, the bytes are damaged, or unpack to another size
inline void unpack([[maybe_unused]] Bytes packed, Compression compression,
                   [[maybe_unused]] std::optional<std::uint64_t> size,
                   [[maybe_unused]] std::vector<std::byte>& out) {
  switch (compression) {
#ifdef KINECAL_HAVE_BZ2
    case Compression::bz2: {
      detail::UnpackBz2 unpacker;
      return detail::unpack_with(unpacker, packed, size, out);
    }
#endif
#ifdef KINECAL_HAVE_LZ4
    case Compression::lz4: {
      detail::UnpackLz4 unpacker;
      return detail::unpack_with(unpacker, packed, size, out);
    }
#endif
#ifdef KINECAL_HAVE_ZSTD
    case Compression::zstd: {
      detail::UnpackZstd unpacker(packed.size());
      return detail::unpack_with(unpacker, packed, size, out);
    }
#endif
    case Compression::none:
      detail::check_size(packed, size);
      out.assign(packed.begin(), packed.end());
      return;
    default:
      throw BytesError(detail::not_available(compression));
  }
}

/// Unpacks the blocks of a bag, one after the other.  Many small bombs are no less than a large
/// one: what comes out of all of them is bounded by what went in.
class BlockUnpacker {
 public:
  /// @return  what it unpacks to, valid up to the next one; the same bytes if it is not compressed
  /// @throws BytesError  as unpack()
  [[nodiscard]] Bytes operator()(Bytes packed, Compression compression,
                                 std::optional<std::uint64_t> size) {
    if (compression == Compression::none) {
      detail::check_size(packed, size);
      return packed;
    }
    unpack(packed, compression, size, unpacked_);
    read_ += packed.size();
    written_ += unpacked_.size();
    if (written_ <= detail::most_unpacked_in_all(read_)) return unpacked_;
    throw BytesError("unpacks, with those before it, from " + std::to_string(read_) + " bytes to " +
                     std::to_string(written_) + ", which is not plausible");
  }

 private:
  std::vector<std::byte> unpacked_;
  std::uint64_t read_ = 0, written_ = 0;
};

/// @throws std::invalid_argument  if this kinecal was built without the library
[[nodiscard]] inline std::vector<std::byte> pack(Bytes bytes, Compression compression) {
  switch (compression) {
#ifdef KINECAL_HAVE_BZ2
    case Compression::bz2:
      return detail::pack_bz2(bytes);
#endif
#ifdef KINECAL_HAVE_LZ4
    case Compression::lz4:
      return detail::pack_lz4(bytes);
#endif
#ifdef KINECAL_HAVE_ZSTD
    case Compression::zstd:
      return detail::pack_zstd(bytes);
#endif
    case Compression::none:
      return {bytes.begin(), bytes.end()};
    default:
      throw std::invalid_argument("what is to be packed " + detail::not_available(compression));
  }
}

}  // namespace kinecal
