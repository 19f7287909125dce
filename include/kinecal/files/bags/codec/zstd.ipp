// zstd, as in MCAP and ROS 2.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <memory>
#include <new>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "kinecal/files/bags/bytes.hpp"
#include "kinecal/files/bags/codec/unpack.ipp"

#ifdef KINECAL_HAVE_ZSTD
#include <zstd.h>

namespace kinecal::detail {

inline constexpr bool kHaveZstd = true;

class UnpackZstd {
 public:
  /// @param packed  total bytes.  They bound the window, zstd's memory; so does zstd's default
  ///                limit.
  explicit UnpackZstd(std::size_t packed) : context_(ZSTD_createDCtx()) {
    if (!context_) throw std::bad_alloc();
    constexpr int kMostLog = 27;
    const int log = std::min(kMostLog, static_cast<int>(std::bit_width(most_unpacked(packed) - 1)));
    ZSTD_DCtx_setParameter(context_.get(), ZSTD_d_windowLogMax, log);
  }

  [[nodiscard]] UnpackStep step(Bytes in, std::span<std::byte> out) {
    ZSTD_inBuffer source{in.data(), in.size(), 0};
    ZSTD_outBuffer target{out.data(), out.size(), 0};
    const std::size_t status = ZSTD_decompressStream(context_.get(), &target, &source);
    if (ZSTD_isError(status) != 0) {
      throw BytesError(std::string("is not zstd, or is damaged (") + ZSTD_getErrorName(status) +
                       ")");
    }
    return {source.pos, target.pos, status == 0};
  }

 private:
  struct Free {
    void operator()(ZSTD_DCtx* context) const { ZSTD_freeDCtx(context); }
  };
  std::unique_ptr<ZSTD_DCtx, Free> context_;
};
static_assert(Unpacker<UnpackZstd>);

[[nodiscard]] inline std::vector<std::byte> pack_zstd(Bytes bytes) {
  std::vector<std::byte> packed(ZSTD_compressBound(bytes.size()));
  const std::size_t size =
      ZSTD_compress(packed.data(), packed.size(), bytes.data(), bytes.size(), ZSTD_CLEVEL_DEFAULT);
  if (ZSTD_isError(size) != 0) throw std::runtime_error(ZSTD_getErrorName(size));
  packed.resize(size);
  return packed;
}

}  // namespace kinecal::detail

#else

namespace kinecal::detail {
inline constexpr bool kHaveZstd = false;
}

#endif
