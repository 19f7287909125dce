// Loads samples from memory while others are evaluated.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <span>

#include "kinecal/problem/batch.hpp"

namespace kinecal::detail {

/// Loads batches from memory while others are evaluated, if all of them do not fit into a cache; part
/// by part, as a processor waits for ten lines of memory or so, and stops where it is to wait for more.
template <class S>
class Prefetch {
 public:
  /// What is left of a batch.
  struct Rest {
    const char *next, *end;
    std::ptrdiff_t part;

    /// Inline: g++ takes a function that only prefetches for one without effect.
    [[gnu::always_inline]] void load_part() {
      const char* last = next + std::min(part, end - next);
      for (; next < last; next += kLine) __builtin_prefetch(next);
    }
  };

  /// @param parts  in how many parts a batch is loaded
  Prefetch(const Batches<S>& batches, std::ptrdiff_t parts) : batches_(batches) {
    const auto bytes = static_cast<std::ptrdiff_t>(batches.numbers(0).size_bytes());
    const auto size = static_cast<std::ptrdiff_t>(batches.size());
    if (size * bytes > kCache) part_ = (bytes / kLine / parts + 1) * kLine;
  }
  /// To load a batch, if there is one.
  [[nodiscard]] Rest of(std::size_t batch) const {
    if (part_ == 0) return {nullptr, nullptr, 0};
    const auto bytes = std::as_bytes(batches_.numbers(batch));
    const char* first = reinterpret_cast<const char*>(bytes.data());
    return {first, first + bytes.size(), part_};
  }

 private:
  static constexpr std::ptrdiff_t kLine = 64, kCache = 1 << 20;  // bytes
  const Batches<S>& batches_;
  std::ptrdiff_t part_ = 0;  ///< bytes of a part; zero: nothing is loaded
};

}  // namespace kinecal::detail
