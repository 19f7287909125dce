// Takes bytes out of a decompressor that nobody trusts with memory.
//
// A few bytes may claim to hold a gigabyte, and bombs really do.  So what comes out grows while it
// is being filled, never beyond what is plausible for what went in.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "kinecal/io/bags/bytes.hpp"

namespace kinecal::detail {

/// What a decompressor did in one step.
struct UnpackStep {
  std::size_t read = 0, written = 0;
  bool ended = false;  ///< the compressed stream; another may follow
};

/// @throws BytesError  from step(), if the bytes are not what it decompresses
template <class U>
concept Unpacker = requires(U u, Bytes in, std::span<std::byte> out) {
  { u.step(in, out) } -> std::same_as<UnpackStep>;
};

inline constexpr std::uint64_t kMostOfABlock = std::uint64_t{1} << 30;

inline constexpr std::uint64_t kMostOfAMessage = kMostOfABlock / 2;  ///< that is written

inline constexpr std::uint64_t kMostRatio = 256;  ///< of lz4; sensors' data have a tenth of it

/// Bytes that a block may unpack to: black images are small, yet not without bounds.
[[nodiscard]] constexpr std::uint64_t most_unpacked(std::uint64_t packed) {
  constexpr std::uint64_t kAlways = std::uint64_t{1} << 25;
  return std::min(kMostOfABlock, std::max(kAlways, kMostRatio * std::min(packed, kMostOfABlock)));
}

/// Bytes that all blocks of a file may unpack to.
[[nodiscard]] constexpr std::uint64_t most_unpacked_in_all(std::uint64_t packed) {
  constexpr std::uint64_t kMost = ~std::uint64_t{0} / kMostRatio;
  return std::max(kMostOfABlock, kMostRatio * std::min(packed, kMost));
}

/// @param size  bytes that must come out, where it is known
/// @param out   holds them, and nothing else; its memory is used again
/// @throws BytesError  "does not unpack to ...": a predicate without its subject
template <Unpacker U>
void unpack_with(U& unpacker, Bytes packed, std::optional<std::uint64_t> size,
                 std::vector<std::byte>& out) {
  const std::uint64_t most = most_unpacked(packed.size());
  if (size.value_or(0) > most) {
    throw BytesError("claims to unpack from " + std::to_string(packed.size()) + " bytes to " +
                     std::to_string(*size) + "; " + std::to_string(most) + " are plausible");
  }
  const auto target = static_cast<std::size_t>(size.value_or(most));
  const auto grow = [&](std::size_t wanted) {
    const std::size_t next = std::min(wanted, target + 1);  // one more shows that there are more
    out.reserve(next);
    out.resize(next);
  };
  grow(std::max(std::size_t{1} << 16, 16 * packed.size()));
  std::size_t filled = 0;
  for (bool ended = false; !ended || !packed.empty();) {
    if (filled == out.size()) grow(2 * out.size());
    const UnpackStep step = unpacker.step(packed, std::span(out).subspan(filled));
    packed = packed.subspan(step.read);
    filled += step.written;
    ended = step.ended;
    if (filled > target) {
      throw BytesError("does not unpack to " + std::to_string(target) + " bytes, but to more");
    }
    if (step.read == 0 && step.written == 0 && !(ended && packed.empty())) {
      throw BytesError("does not unpack to its end; is it cut off?");
    }
  }
  if (size && filled < target) {
    throw BytesError("does not unpack to " + std::to_string(target) + " bytes, but to " +
                     std::to_string(filled));
  }
  out.resize(filled);
}

}  // namespace kinecal::detail
