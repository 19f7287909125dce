// lz4 frames, as in ROS 1 bags and MCAP.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <new>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "kinecal/files/bags/bytes.hpp"
#include "kinecal/files/bags/codec/unpack.ipp"

#ifdef KINECAL_HAVE_LZ4
#include <lz4frame.h>

namespace kinecal::detail {

inline constexpr bool kHaveLz4 = true;

class UnpackLz4 {
 public:
  UnpackLz4() {
    if (LZ4F_isError(LZ4F_createDecompressionContext(&context_, LZ4F_VERSION))) {
      throw std::bad_alloc();
    }
  }
  UnpackLz4(const UnpackLz4&) = delete;
  UnpackLz4& operator=(const UnpackLz4&) = delete;
  ~UnpackLz4() { LZ4F_freeDecompressionContext(context_); }

  [[nodiscard]] UnpackStep step(Bytes in, std::span<std::byte> out) {
    std::size_t read = in.size(), written = out.size();
    const std::size_t status =
        LZ4F_decompress(context_, out.data(), &written, in.data(), &read, nullptr);
    if (LZ4F_isError(status)) {
      throw BytesError(std::string("is not lz4, or is damaged (") + LZ4F_getErrorName(status) +
                       ")");
    }
    return {read, written, status == 0};
  }

 private:
  LZ4F_dctx* context_ = nullptr;
};
static_assert(Unpacker<UnpackLz4>);

[[nodiscard]] inline std::vector<std::byte> pack_lz4(Bytes bytes) {
  LZ4F_preferences_t preferences = LZ4F_INIT_PREFERENCES;
  // ROS 1 reads only this kind of frame.
  preferences.frameInfo.blockMode = LZ4F_blockIndependent;
  preferences.frameInfo.contentChecksumFlag = LZ4F_contentChecksumEnabled;
  std::vector<std::byte> packed(LZ4F_compressFrameBound(bytes.size(), &preferences));
  const std::size_t size =
      LZ4F_compressFrame(packed.data(), packed.size(), bytes.data(), bytes.size(), &preferences);
  if (LZ4F_isError(size)) throw std::runtime_error(LZ4F_getErrorName(size));
  packed.resize(size);
  return packed;
}

}  // namespace kinecal::detail

#else

namespace kinecal::detail {
inline constexpr bool kHaveLz4 = false;
}

#endif
