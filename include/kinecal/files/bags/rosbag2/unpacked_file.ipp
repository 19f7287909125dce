// A whole file compressed by ROS 2 in compression mode FILE: "bag_0.db3.zstd".
//
// Unpacks it into a temporary file, because readers of bags seek back and forth.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <ostream>
#include <string>
#include <vector>

#include "kinecal/files/bags/byte_file.ipp"
#include "kinecal/files/bags/codec/compression.hpp"
#include "kinecal/files/bags/codec/unpack.ipp"
#include "kinecal/files/bags/codec/zstd.ipp"
#include "kinecal/files/results/staging.ipp"

namespace kinecal::detail {

#ifdef KINECAL_HAVE_ZSTD

/// @param out  not good() afterwards if it cannot take everything
/// @throws BytesError  a predicate without its subject: the file is damaged, or is a bomb
inline void unpack_zstd(ByteFile& file, std::ostream& out) {
  constexpr std::uint64_t kPiece = 1 << 20;
  const std::uint64_t most = most_unpacked_in_all(file.size());
  UnpackZstd unpacker(file.size());
  std::vector<std::byte> buffer, unpacked(kPiece);
  std::uint64_t written = 0;
  UnpackStep step;
  while (file.left() > 0) {
    Bytes packed = file.read(std::min(file.left(), kPiece), buffer);
    do {
      step = unpacker.step(packed, unpacked);
      packed = packed.subspan(step.read);
      written += step.written;
      if (written > most) throw BytesError("unpacks to more bytes than are plausible");
      out.write(reinterpret_cast<const char*>(unpacked.data()),
                static_cast<std::streamsize>(step.written));
      if (!out) return;  // the caller checks `out`
    } while (!packed.empty() || (step.written == unpacked.size() && !step.ended));
  }
  if (!step.ended) throw BytesError("does not unpack to its end; is it cut off?");
}

#endif

class UnpackedFile {
 public:
  /// @param path  of a file that is compressed with zstd
  /// @throws BytesError  a predicate without its subject: the file is damaged, the disk is full, or
  ///                     this kinecal was built without zstd
  explicit UnpackedFile([[maybe_unused]] const std::string& path) try
      : folder_(std::filesystem::temp_directory_path()) {
#ifdef KINECAL_HAVE_ZSTD
    std::ifstream in = open_bytes(path);
    ByteFile file(in);
    std::ofstream out(this->path(), std::ios::binary);
    unpack_zstd(file, out);
    out.close();
    if (!out) {
      throw BytesError("cannot be unpacked into " + folder_.path().string() +
                       "; is the disk full? Set TMPDIR to use another folder");
    }
#else
    throw BytesError(not_available(Compression::zstd));
#endif
  } catch (const OutputError& e) {
    throw BytesError(std::string("cannot be unpacked: ") + e.what());
  } catch (const std::filesystem::filesystem_error&) {
    throw BytesError("cannot be unpacked: TMPDIR is not a folder");
  }

  [[nodiscard]] std::string path() const {
    return (folder_.path() / "bag").string();
  }

 private:
  StagingFolder folder_;
};

}  // namespace kinecal::detail
