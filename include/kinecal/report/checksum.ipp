// Computing SHA-256 and base64.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <bit>
#include <cmath>
#include <span>

#include "kinecal/report/checksum.hpp"

namespace kinecal {

namespace detail {

/// The first 32 bits of the fractional parts of roots of the first 64 primes: square roots of eight of
/// them are where the sum starts, cube roots of all are its constants.
struct Sha256Constants {
  std::array<std::uint32_t, 8> start{};
  std::array<std::uint32_t, 64> rounds{};

  Sha256Constants() {
    std::size_t primes = 0;
    for (std::uint32_t n = 2; primes < rounds.size(); ++n) {
      bool is_prime = true;
      for (std::uint32_t d = 2; d * d <= n; ++d) is_prime = is_prime && n % d != 0;
      if (!is_prime) continue;
      const auto fraction = [](long double root) {
        return static_cast<std::uint32_t>((root - std::floor(root)) * 4294967296.0L);
      };
      if (primes < start.size()) start[primes] = fraction(std::sqrt(static_cast<long double>(n)));
      rounds[primes++] = fraction(std::cbrt(static_cast<long double>(n)));
    }
  }
};

/// Adds a block of 64 bytes to the sum.
inline void add_sha256_block(const unsigned char* block, const Sha256Constants& constants,
                             std::array<std::uint32_t, 8>& sum) {
  using std::rotr;
  std::array<std::uint32_t, 64> w{};
  for (std::size_t i = 0; i < 16; ++i) {
    for (std::size_t b = 0; b < 4; ++b) w[i] = (w[i] << 8U) | block[4 * i + b];
  }
  for (std::size_t i = 16; i < w.size(); ++i) {
    const std::uint32_t a = w[i - 15], b = w[i - 2];
    w[i] = w[i - 16] + w[i - 7] + (rotr(a, 7) ^ rotr(a, 18) ^ (a >> 3U)) +
           (rotr(b, 17) ^ rotr(b, 19) ^ (b >> 10U));
  }
  std::array<std::uint32_t, 8> s = sum;
  for (std::size_t i = 0; i < w.size(); ++i) {
    const std::uint32_t a = s[0], e = s[4];
    const std::uint32_t t1 = s[7] + (rotr(e, 6) ^ rotr(e, 11) ^ rotr(e, 25)) +
                             ((e & s[5]) ^ (~e & s[6])) + constants.rounds[i] + w[i];
    const std::uint32_t t2 =
        (rotr(a, 2) ^ rotr(a, 13) ^ rotr(a, 22)) + ((a & s[1]) ^ (a & s[2]) ^ (s[1] & s[2]));
    s = {t1 + t2, s[0], s[1], s[2], s[3] + t1, s[4], s[5], s[6]};
  }
  for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += s[i];
}

}  // namespace detail

KINECAL_INLINE std::array<std::uint8_t, 32> sha256(std::string_view bytes) {
  static const detail::Sha256Constants constants;
  std::array<std::uint32_t, 8> sum = constants.start;
  const auto* data = reinterpret_cast<const unsigned char*>(bytes.data());  // NOLINT: bytes
  const std::size_t whole = bytes.size() / 64 * 64;
  for (std::size_t at = 0; at < whole; at += 64) {
    detail::add_sha256_block(data + at, constants, sum);
  }
  // The rest, a one, zeros, and the number of bits.
  std::string rest(bytes.substr(whole));
  rest += '\x80';
  rest.resize(rest.size() + (120 - rest.size()) % 64, '\0');
  for (unsigned shift = 64; shift > 0; shift -= 8) {
    rest += static_cast<char>((std::uint64_t{bytes.size()} * 8) >> (shift - 8) & 0xFFU);
  }
  for (std::size_t at = 0; at < rest.size(); at += 64) {
    detail::add_sha256_block(reinterpret_cast<const unsigned char*>(rest.data()) + at,  // NOLINT
                             constants, sum);
  }
  std::array<std::uint8_t, 32> digest{};
  for (std::size_t i = 0; i < digest.size(); ++i) {
    digest[i] = static_cast<std::uint8_t>(sum[i / 4] >> (24 - 8 * (i % 4)));
  }
  return digest;
}

KINECAL_INLINE std::string sha256_text(std::string_view bytes) {
  std::string text;
  for (const std::uint8_t byte : sha256(bytes)) text += fmt::format("{:02x}", byte);
  return text;
}

KINECAL_INLINE std::string base64(std::string_view bytes) {
  constexpr std::string_view kDigits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t three = 0;
    for (std::size_t b = 0; b < 3; ++b) {
      three =
          (three << 8U) | (i + b < bytes.size() ? static_cast<unsigned char>(bytes[i + b]) : 0U);
    }
    for (std::size_t d = 0; d < 4; ++d) {
      const bool is_padding = i + d > bytes.size();
      text += is_padding ? '=' : kDigits[three >> (18 - 6 * d) & 63U];
    }
  }
  return text;
}

}  // namespace kinecal
