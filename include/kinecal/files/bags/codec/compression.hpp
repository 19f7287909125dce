// How blocks of bags are compressed: bz2 and lz4 in ROS 1, lz4 and zstd in MCAP, zstd in SQLite.
//
// The libraries are optional when kinecal is built: KINECAL_HAVE_BZ2, _LZ4 and _ZSTD say which were
// found.  A block that needs another one is an error that names what to install.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "kinecal/files/bags/bytes.hpp"

namespace kinecal {

/// How the chunks of a bag are compressed.
enum class Compression { none, bz2, lz4, zstd };

/// The name of a compression in bags: "none", "bz2", "lz4" or "zstd".
[[nodiscard]] std::string_view to_string(Compression compression);

/// Whether this kinecal was built with the library that it needs.
[[nodiscard]] bool is_available(Compression compression);

namespace detail {

/// The compression with this name in bags; "", as in MCAP, stands for Compression::none.
[[nodiscard]] std::optional<Compression> compression_named(std::string_view text);

/// @param size  bytes that must come out, if the bag says how many
/// @param out   holds them, and nothing else; its memory is used again
/// @throws BytesError  "is compressed with lz4, and ...", a predicate without its subject: the
///                     library is missing, the bytes are damaged, or unpack to another size
void unpack(Bytes packed, Compression compression, std::optional<std::uint64_t> size,
            std::vector<std::byte>& out);

/// @throws std::invalid_argument  if this kinecal was built without the library
[[nodiscard]] std::vector<std::byte> pack(Bytes bytes, Compression compression);

/// "is compressed with lz4, and ...": a predicate without its subject.
[[nodiscard]] std::string not_available(Compression compression);

}  // namespace detail

}  // namespace kinecal

#ifdef KINECAL_HEADER_ONLY
#include "kinecal/files/bags/codec/compression.ipp"
#endif
