// Unpacks what bags compress their blocks with: LZ4 frames and zstd, where the libraries are there.
//
// Who wrote the block also says how large it is unpacked; neither is believed.  The output grows
// while it is being filled, so a bomb costs no more memory than what it says it holds, and one that
// lies about that costs hardly any.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#ifdef KINECAL_HAVE_LZ4
#include <lz4frame.h>
#endif
#ifdef KINECAL_HAVE_ZSTD
#include <zstd.h>
#endif

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "kinecal/io/bags/bytes.hpp"

namespace kinecal {

/// No block of a bag is larger than this, packed or not.
inline constexpr std::uint64_t kMaxBlockBytes = std::uint64_t{1} << 30;

namespace detail {

[[noreturn]] inline void throw_without_library(const std::string& format, const std::string& lib) {
  throw BytesError("compressed with " + format + ", and this kinecal was built without " + lib +
                   "; install " + lib + "-dev and build again");
}

/// Bytes that grow while they are filled, up to a size that is told beforehand.
class UnpackedBytes {
 public:
  UnpackedBytes(std::size_t packed, std::uint64_t declared) : declared_(declared) {
    if (declared > kMaxBlockBytes) {
      throw BytesError("a block of " + std::to_string(declared) +
                       " bytes, more than the 1 GiB that a block may have");
    }
    bytes_.resize(std::min<std::uint64_t>(declared, 4096 + std::uint64_t{8} * packed));
  }

  /// Where to unpack to: never empty.
  [[nodiscard]] std::span<std::byte> room() {
    if (filled_ == declared_) return excess_;
    if (filled_ == bytes_.size()) {
      bytes_.resize(std::min<std::uint64_t>(declared_, 2 * std::uint64_t{bytes_.size()}));
    }
    return std::span(bytes_).subspan(filled_);
  }

  void filled(std::size_t count) {
    if (filled_ == declared_ && count > 0) {
      throw BytesError("unpacks to more than the " + std::to_string(declared_) +
                       " bytes that are declared");
    }
    filled_ += count;
  }

  [[nodiscard]] std::vector<std::byte> take() {
    if (filled_ != declared_) {
      throw BytesError("unpacks to " + std::to_string(filled_) + " bytes, and " +
                       std::to_string(declared_) + " are declared; is it cut off?");
    }
    return std::move(bytes_);
  }

 private:
  std::uint64_t declared_;
  std::uint64_t filled_ = 0;
  std::vector<std::byte> bytes_;
  std::array<std::byte, 1> excess_{};  ///< shows whether there is more
};

}  // namespace detail

/// Unpacks LZ4 frames.
/// @param declared_size  bytes that come out, as the bag says
/// @throws BytesError    if it is damaged, of another size or larger than 1 GiB; or if this kinecal
///                       was built without liblz4
[[nodiscard]] inline std::vector<std::byte> decompress_lz4(
    [[maybe_unused]] Bytes packed, [[maybe_unused]] std::uint64_t declared_size) {
#ifdef KINECAL_HAVE_LZ4
  detail::UnpackedBytes out(packed.size(), declared_size);
  LZ4F_dctx* made = nullptr;
  if (LZ4F_isError(LZ4F_createDecompressionContext(&made, LZ4F_VERSION))) throw std::bad_alloc();
  const auto free = [](LZ4F_dctx* c) { LZ4F_freeDecompressionContext(c); };
  const std::unique_ptr<LZ4F_dctx, decltype(free)> context(made, free);
  std::size_t wanted = 1;  // bytes that the frame still needs; 0 at its end
  while (!packed.empty() || wanted != 0) {
    const std::span<std::byte> room = out.room();
    std::size_t written = room.size(), read = packed.size();
    wanted = LZ4F_decompress(context.get(), room.data(), &written, packed.data(), &read, nullptr);
    if (LZ4F_isError(wanted)) {
      throw BytesError(std::string("not LZ4: ") + LZ4F_getErrorName(wanted));
    }
    out.filled(written);
    packed = packed.subspan(read);
    if (written == 0 && read == 0) {
      if (wanted != 0) throw BytesError("the LZ4 frame has no end; is it cut off?");
      break;
    }
  }
  return out.take();
#else
  detail::throw_without_library("lz4", "liblz4");
#endif
}

/// Unpacks zstd frames.
/// @param declared_size  bytes that come out, as the bag says
/// @throws BytesError    if it is damaged, of another size or larger than 1 GiB; or if this kinecal
///                       was built without libzstd
[[nodiscard]] inline std::vector<std::byte> decompress_zstd(
    [[maybe_unused]] Bytes packed, [[maybe_unused]] std::uint64_t declared_size) {
#ifdef KINECAL_HAVE_ZSTD
  detail::UnpackedBytes out(packed.size(), declared_size);
  const auto free = [](ZSTD_DCtx* c) { ZSTD_freeDCtx(c); };
  const std::unique_ptr<ZSTD_DCtx, decltype(free)> context(ZSTD_createDCtx(), free);
  if (!context) throw std::bad_alloc();
  ZSTD_inBuffer in{packed.data(), packed.size(), 0};
  std::size_t wanted = 1;  // bytes that the frame still needs; 0 at its end
  while (in.pos < in.size || wanted != 0) {
    const std::span<std::byte> room = out.room();
    ZSTD_outBuffer written{room.data(), room.size(), 0};
    const std::size_t before = in.pos;
    wanted = ZSTD_decompressStream(context.get(), &written, &in);
    if (ZSTD_isError(wanted)) {
      throw BytesError(std::string("not zstd: ") + ZSTD_getErrorName(wanted));
    }
    out.filled(written.pos);
    if (written.pos == 0 && in.pos == before && wanted != 0) {
      throw BytesError("the zstd frame has no end; is it cut off?");
    }
  }
  return out.take();
#else
  detail::throw_without_library("zstd", "libzstd");
#endif
}

}  // namespace kinecal
