// Unpacks untrusted bytes in bounded memory.
//
// A few bytes may claim to hold a gigabyte, and decompression bombs really do.  So the output grows
// as it fills, up to a plausible size for the input.
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

#include "kinecal/files/bags/bytes.hpp"

namespace kinecal::detail {

/// The result of one decompression step.
struct UnpackStep {
  std::size_t read = 0, written = 0;
  bool ended = false;  ///< the compressed stream; another may follow
};

/// @throws BytesError  from step(), if the bytes are invalid
template <class U>
concept Unpacker = requires(U u, Bytes in, std::span<std::byte> out) {
  { u.step(in, out) } -> std::same_as<UnpackStep>;
};

inline constexpr std::uint64_t kMostOfABlock = std::uint64_t{1} << 30;  ///< bytes

inline constexpr std::uint64_t kMostOfAMessage = kMostOfABlock / 2;  ///< bytes, when writing

inline constexpr std::uint64_t kMostRatio = 256;  ///< of lz4; sensor data reach a tenth of it

/// Largest plausible output of a block: black images pack well, but not without limit.
[[nodiscard]] constexpr std::uint64_t most_unpacked(std::uint64_t packed) {
  constexpr std::uint64_t kAlways = std::uint64_t{1} << 25;
  return std::min(kMostOfABlock, std::max(kAlways, kMostRatio * std::min(packed, kMostOfABlock)));
}

/// Largest plausible output of all blocks of a file.
[[nodiscard]] constexpr std::uint64_t most_unpacked_in_all(std::uint64_t packed) {
  constexpr std::uint64_t kMost = ~std::uint64_t{0} / kMostRatio;
  return std::max(kMostOfABlock, kMostRatio * std::min(packed, kMost));
}

/// @throws BytesError  "has 3 bytes, ...": a predicate without its subject
inline void check_size(Bytes bytes, std::optional<std::uint64_t> size) {
  if (size.value_or(bytes.size()) == bytes.size()) return;
  throw BytesError("has " + byte_count(bytes.size()) + ", not the " + std::to_string(*size) +
                   " that it claims");
}

/// @param size  expected number of output bytes, if known
/// @param out   receives only the output; reuses its memory
/// @throws BytesError  "does not unpack to ...": a predicate without its subject
template <Unpacker U>
void unpack_with(U& unpacker, Bytes packed, std::optional<std::uint64_t> size,
                 std::vector<std::byte>& out) {
  const std::uint64_t most = most_unpacked(packed.size());
  if (size.value_or(0) > most) {
    throw BytesError("claims to unpack from " + byte_count(packed.size()) + " to " +
                     std::to_string(*size) + "; at most " + std::to_string(most) +
                     " are plausible");
  }
  const auto target = static_cast<std::size_t>(size.value_or(most));
  const auto grow = [&](std::size_t wanted) {
    const std::size_t next =
        std::min(wanted, target + 1);  // one extra byte shows that there are more
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
      throw BytesError("does not unpack to " + byte_count(target) + ", but to more");
    }
    if (step.read == 0 && step.written == 0 && !(ended && packed.empty())) {
      throw BytesError("does not unpack to its end; is it cut off?");
    }
  }
  if (size && filled < target) {
    throw BytesError("does not unpack to " + byte_count(target) + ", but to " +
                     std::to_string(filled));
  }
  out.resize(filled);
}

}  // namespace kinecal::detail
