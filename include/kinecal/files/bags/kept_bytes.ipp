// Limits the memory kept while a bag is read: topics and their definitions.
//
// A few compressed bytes may hold a million connections, or a definition of a gigabyte.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "kinecal/files/bags/bytes.hpp"

namespace kinecal::detail {

class KeptBytes {
 public:
  static constexpr std::uint64_t kMost = std::uint64_t{1} << 26;  ///< 6000 long definitions

  /// Call it before keeping a topic or definition.
  /// @param bytes  of its texts
  /// @throws BytesError  if that is more than any real bag has
  void add(std::uint64_t bytes) {
    constexpr std::uint64_t kEach = 128;  // of memory, besides the texts
    if (bytes > kMost || (kept_ += kEach + bytes) > kMost) {
      throw BytesError("it has more topics and definitions than are plausible: at most " +
                       std::to_string(kMost) + " bytes of them are read");
    }
  }

 private:
  std::uint64_t kept_ = 0;
};

}  // namespace kinecal::detail
