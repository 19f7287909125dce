// Compression of bag blocks: bz2 and lz4 in ROS 1, lz4 and zstd in MCAP, zstd in SQLite.
//
// The libraries are optional at build time: KINECAL_HAVE_BZ2, _LZ4 and _ZSTD tell which were found.
// For a block that needs another one, the error names the package to install.
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

/// Compressions of the chunks of a bag.
enum class Compression { none, bz2, lz4, zstd };

/// The name of a compression in bags: "none", "bz2", "lz4" or "zstd".
[[nodiscard]] std::string_view to_string(Compression compression);

/// True if this build has the library for it.
[[nodiscard]] bool is_available(Compression compression);

namespace detail {

/// The compression with this name in bags; "", as in MCAP, stands for Compression::none.
[[nodiscard]] std::optional<Compression> compression_named(std::string_view text);

/// @param size  expected number of output bytes, if the bag gives it
/// @param out   receives only the output; reuses its memory
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
