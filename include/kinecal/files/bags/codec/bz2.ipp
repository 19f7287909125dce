// bz2, the compression of Fetch's bags.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "kinecal/files/bags/bytes.hpp"
#include "kinecal/files/bags/codec/unpack.ipp"

#ifdef KINECAL_HAVE_BZ2
#include <bzlib.h>

#include <algorithm>
#include <limits>

namespace kinecal::detail {

inline constexpr bool kHaveBz2 = true;

class UnpackBz2 {
 public:
  UnpackBz2() = default;
  UnpackBz2(const UnpackBz2&) = delete;
  UnpackBz2& operator=(const UnpackBz2&) = delete;
  ~UnpackBz2() { end(); }

  [[nodiscard]] UnpackStep step(Bytes in, std::span<std::byte> out) {
    if (!begun_) begin();
    constexpr std::size_t kMost = std::numeric_limits<int>::max();
    in = in.first(std::min(in.size(), kMost));
    out = out.first(std::min(out.size(), kMost));
    // bzlib only reads here, but its declaration lacks the const.
    stream_.next_in = const_cast<char*>(reinterpret_cast<const char*>(in.data()));
    stream_.avail_in = static_cast<unsigned>(in.size());
    stream_.next_out = reinterpret_cast<char*>(out.data());
    stream_.avail_out = static_cast<unsigned>(out.size());
    const int status = BZ2_bzDecompress(&stream_);
    if (status != BZ_OK && status != BZ_STREAM_END) {
      throw BytesError("is not bz2, or is damaged (bzlib error " + std::to_string(status) + ")");
    }
    if (status == BZ_STREAM_END) end();
    return {in.size() - stream_.avail_in, out.size() - stream_.avail_out, status == BZ_STREAM_END};
  }

 private:
  void begin() {
    stream_ = {};
    if (BZ2_bzDecompressInit(&stream_, 0, 0) != BZ_OK) throw std::bad_alloc();
    begun_ = true;
  }
  void end() {
    if (begun_) BZ2_bzDecompressEnd(&stream_);
    begun_ = false;
  }

  bz_stream stream_{};
  bool begun_ = false;
};
static_assert(Unpacker<UnpackBz2>);

[[nodiscard]] inline std::vector<std::byte> pack_bz2(Bytes bytes) {
  std::vector<std::byte> packed(bytes.size() + bytes.size() / 100 + 600);  // bzlib's bound
  auto size = static_cast<unsigned>(packed.size());
  // bzlib only reads its source, but its declaration lacks the const.  It rejects a null pointer.
  char nothing = 0;
  char* source =
      bytes.empty() ? &nothing : const_cast<char*>(reinterpret_cast<const char*>(bytes.data()));
  // A decompressor allocates whole blocks, however little they hold.
  const int block = static_cast<int>(std::clamp<std::size_t>(bytes.size() / 100'000 + 1, 1, 9));
  const int status = BZ2_bzBuffToBuffCompress(reinterpret_cast<char*>(packed.data()), &size, source,
                                              static_cast<unsigned>(bytes.size()), block, 0, 0);
  if (status != BZ_OK) throw std::runtime_error("bzlib error " + std::to_string(status));
  packed.resize(size);
  return packed;
}

}  // namespace kinecal::detail

#else

namespace kinecal::detail {
inline constexpr bool kHaveBz2 = false;
}

#endif
