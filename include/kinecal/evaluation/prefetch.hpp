// Loading the next batch into the cache while the current one is evaluated.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <span>

namespace kinecal::detail {

inline constexpr std::size_t kCacheLine = 64;  ///< bytes

/// Bytes to prefetch per step; 0 if everything fits in cache.
/// @param bytes  of a batch
/// @param parts  of a batch
[[nodiscard]] inline std::size_t prefetched_at_once(std::size_t batches, std::size_t bytes,
                                                    std::size_t parts) {
  constexpr std::size_t kCache = 1 << 20;
  return batches * bytes > kCache ? (bytes / kCacheLine / parts + 1) * kCacheLine : 0;
}
/// Prefetches some bytes.  Inline: g++ drops calls of a function that only prefetches.
[[gnu::always_inline]] inline void prefetch(std::span<const std::byte>& left, std::size_t count) {
  const auto now = left.first(std::min(count, left.size()));
  for (std::size_t i = 0; i < now.size(); i += kCacheLine) __builtin_prefetch(&now[i]);
  left = left.subspan(now.size());
}

}  // namespace kinecal::detail
