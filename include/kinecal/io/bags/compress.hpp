// Packs blocks of bags: LZ4 frames and zstd, where the libraries are there.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#ifdef KINECAL_HAVE_LZ4
#include <lz4frame.h>
#endif
#ifdef KINECAL_HAVE_ZSTD
#include <zstd.h>
#endif

#include <cstddef>
#include <string>
#include <vector>

#include "kinecal/io/bags/bytes.hpp"
#include "kinecal/io/bags/compression.hpp"

namespace kinecal {

/// One LZ4 frame that decompress_lz4() unpacks.
/// @throws BytesError  if this kinecal was built without liblz4
[[nodiscard]] inline std::vector<std::byte> compress_lz4([[maybe_unused]] Bytes bytes) {
#ifdef KINECAL_HAVE_LZ4
  std::vector<std::byte> packed(LZ4F_compressFrameBound(bytes.size(), nullptr));
  const std::size_t size =
      LZ4F_compressFrame(packed.data(), packed.size(), bytes.data(), bytes.size(), nullptr);
  if (LZ4F_isError(size)) throw BytesError(std::string("LZ4: ") + LZ4F_getErrorName(size));
  packed.resize(size);
  return packed;
#else
  detail::throw_without_library("lz4", "liblz4");
#endif
}

/// One zstd frame that decompress_zstd() unpacks.
/// @throws BytesError  if this kinecal was built without libzstd
[[nodiscard]] inline std::vector<std::byte> compress_zstd([[maybe_unused]] Bytes bytes) {
#ifdef KINECAL_HAVE_ZSTD
  std::vector<std::byte> packed(ZSTD_compressBound(bytes.size()));
  const std::size_t size =
      ZSTD_compress(packed.data(), packed.size(), bytes.data(), bytes.size(), ZSTD_CLEVEL_DEFAULT);
  if (ZSTD_isError(size)) throw BytesError(std::string("zstd: ") + ZSTD_getErrorName(size));
  packed.resize(size);
  return packed;
#else
  detail::throw_without_library("zstd", "libzstd");
#endif
}

}  // namespace kinecal
