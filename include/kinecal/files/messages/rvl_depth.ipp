// Decodes depth images of the codec RVL: runs of pixels without and with depth, and differences of
// neighbours.
//
// Width and height come first, 32 bits each.  Then groups of four bits follow, eight in a 32-bit
// word, highest bits first.  A number consists of groups of three bits, lowest first; the fourth
// bit is set if more follow.  Differences have their sign in the lowest bit.
// Source: A. D. Wilson, "Fast Lossless Depth Image Compression", ISS 2017.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <stdexcept>
#include <string>
#include <string_view>

#include "kinecal/files/bags/bytes.hpp"
#include "kinecal/files/images/read_image.hpp"

namespace kinecal::detail {

/// The numbers of a stream.
class RvlNumbers {
 public:
  explicit RvlNumbers(ByteReader words) : words_(words) {}

  /// @throws std::runtime_error  if the stream ends early, or the number has more than 32 bits
  [[nodiscard]] std::uint32_t next() {
    std::uint32_t number = 0;
    for (unsigned shift = 0;; shift += 3) {
      const std::uint32_t four = next_four();
      if (shift > 30 || (shift == 30 && (four & 7U) > 3U)) {
        throw std::runtime_error("compressed depth has a number of more than 32 bits");
      }
      number |= (four & 7U) << shift;
      if ((four & 8U) == 0) return number;
    }
  }

 private:
  [[nodiscard]] std::uint32_t next_four() {
    if (left_ == 0) {
      word_ = words_.number<std::uint32_t>();
      left_ = 8;
    }
    --left_;
    return (word_ >> (4U * left_)) & 15U;
  }

  ByteReader words_;
  std::uint32_t word_ = 0;
  unsigned left_ = 0;  ///< unread groups of the word
};

/// @param stream  width, height and runs
/// @returns       metres from 16-bit millimetres; NaN for pixels without depth
/// @throws std::runtime_error  if it is truncated or does not match its size
[[nodiscard]] inline DepthImage decode_rvl(std::string_view stream) {
  constexpr float kMillimetre = 1e-3F;
  ByteReader bytes(as_bytes(stream));
  const auto width = bytes.number<std::uint32_t>(), height = bytes.number<std::uint32_t>();
  if (std::uint64_t{width} * height > kMostPixels) {
    throw std::runtime_error("compressed depth has " + std::to_string(width) + " x " +
                             std::to_string(height) + " pixels");
  }
  DepthImage depth(static_cast<int>(width), static_cast<int>(height));
  RvlNumbers numbers(bytes);
  std::uint32_t previous = 0;
  const std::size_t all = depth.pixels.size();
  for (std::size_t at = 0; at < all;) {
    const std::size_t without = numbers.next(), with = numbers.next();
    if (without > all - at || with > all - at - without || without + with == 0) {
      throw std::runtime_error("compressed depth does not fit its size");
    }
    for (std::size_t end = at + without; at < end; ++at) depth.pixels[at] = no_point().z();
    for (std::size_t end = at + with; at < end; ++at) {
      const std::uint32_t difference = numbers.next();
      previous += (difference >> 1U) ^ (0U - (difference & 1U));
      const auto z = static_cast<std::uint16_t>(previous);
      depth.pixels[at] = z > 0 ? static_cast<float>(z) * kMillimetre : no_point().z();
    }
  }
  return depth;
}

}  // namespace kinecal::detail
