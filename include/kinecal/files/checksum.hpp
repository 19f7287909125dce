// SHA-256, with which a report names its inputs and the browser checks its script; base64.  By libcrypto.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace kinecal {

/// The SHA-256 of some bytes.
/// Source: FIPS 180-4
[[nodiscard]] std::array<std::uint8_t, 32> sha256(std::string_view bytes);

/// The same as `sha256sum` prints it: 64 hexadecimal digits.
[[nodiscard]] std::string sha256_text(std::string_view bytes);

/// The same of the bytes of files, one after another, which need not fit into memory.
/// @throws InputError  naming a file that cannot be read
[[nodiscard]] std::string sha256_of_files(std::span<const std::string> files);

/// Bytes as base64, padded.
/// Source: RFC 4648, 4
[[nodiscard]] std::string base64(std::string_view bytes);

/// The bytes of base64, of which line ends and padding may be left out; nullopt if a character is not of
/// base64.
[[nodiscard]] std::optional<std::string> from_base64(std::string text);

}  // namespace kinecal
