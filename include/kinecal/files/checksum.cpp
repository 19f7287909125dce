// Definitions of checksum.hpp, by OpenSSL's libcrypto.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/files/checksum.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <openssl/evp.h>

#include <algorithm>
#include <fstream>
#include <memory>
#include <stdexcept>
#include <vector>

#include "kinecal/files/diagnostics.hpp"

namespace kinecal {

namespace detail {
namespace {

/// Characters as libcrypto takes them.
[[nodiscard]] const unsigned char* octets(const char* text) {
  return reinterpret_cast<const unsigned char*>(text);  // NOLINT: bytes
}
[[nodiscard]] unsigned char* octets(char* text) {
  return reinterpret_cast<unsigned char*>(text);  // NOLINT: bytes
}

// libcrypto counts in int, and base64 is larger than its bytes: longer texts are taken in parts, of 3 bytes
// or 4 characters each.
constexpr std::size_t kBase64Parts = std::size_t{1} << 28U;

}  // namespace
}  // namespace detail

std::array<std::uint8_t, 32> sha256(std::string_view bytes) {
  std::array<std::uint8_t, 32> digest{};
  if (EVP_Digest(bytes.data(), bytes.size(), digest.data(), nullptr, EVP_sha256(), nullptr) != 1) {
    throw std::runtime_error("libcrypto has no SHA-256: its configuration excludes it");
  }
  return digest;
}

std::string sha256_text(std::string_view bytes) {
  return fmt::format("{:02x}", fmt::join(sha256(bytes), ""));
}

std::string sha256_of_files(std::span<const std::string> files) {
  const std::unique_ptr<EVP_MD_CTX, void (*)(EVP_MD_CTX*)> sum(EVP_MD_CTX_new(), EVP_MD_CTX_free);
  bool works = sum && EVP_DigestInit_ex(sum.get(), EVP_sha256(), nullptr) == 1;
  std::vector<char> part(std::size_t{1} << 20U);
  for (const std::string& file : files) {
    std::ifstream in(file, std::ios::binary);
    while (in.read(part.data(), static_cast<std::streamsize>(part.size())) || in.gcount() > 0) {
      const auto size = static_cast<std::size_t>(in.gcount());
      works = works && EVP_DigestUpdate(sum.get(), part.data(), size) == 1;
    }
    if (!in.eof()) throw InputError(file + ": cannot be read");
  }
  std::array<std::uint8_t, 32> digest{};
  if (!works || EVP_DigestFinal_ex(sum.get(), digest.data(), nullptr) != 1) {
    throw std::runtime_error("libcrypto has no SHA-256: its configuration excludes it");
  }
  return fmt::format("{:02x}", fmt::join(digest, ""));
}

std::string base64(std::string_view bytes) {
  constexpr std::size_t kMost = 3 * detail::kBase64Parts;
  std::string text((bytes.size() + 2) / 3 * 4 + 1, '\0');  // libcrypto writes a zero behind it
  char* to = text.data();
  for (std::size_t at = 0; at < bytes.size(); at += kMost) {
    const std::size_t size = std::min(kMost, bytes.size() - at);
    to += EVP_EncodeBlock(detail::octets(to), detail::octets(bytes.data() + at),
                          static_cast<int>(size));
  }
  text.pop_back();
  return text;
}

std::optional<std::string> from_base64(std::string text) {
  std::erase_if(text, [](char c) { return c == '=' || c == '\n' || c == '\r'; });
  if (text.size() % 4 == 1) return std::nullopt;  // six bits are no byte
  const std::size_t size = text.size() * 3 / 4;
  text.resize((text.size() + 3) / 4 * 4, '=');
  std::string bytes(text.size() / 4 * 3, '\0');
  constexpr std::size_t kMost = 4 * detail::kBase64Parts;
  for (std::size_t at = 0; at < text.size(); at += kMost) {
    const auto part = static_cast<int>(std::min(kMost, text.size() - at));
    char* to = bytes.data() + at / 4 * 3;
    // It ignores blanks at both ends and takes '-' for the end.
    if (EVP_DecodeBlock(detail::octets(to), detail::octets(text.data() + at), part) !=
        part / 4 * 3) {
      return std::nullopt;
    }
  }
  bytes.resize(size);
  return bytes;
}

}  // namespace kinecal
