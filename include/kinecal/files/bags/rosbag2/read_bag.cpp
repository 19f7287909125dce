// Finds the files of a ROS 2 bag and reads them, one after the other.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/files/bags/rosbag2/read_bag.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <optional>
#include <ostream>
#include <set>
#include <string>
#include <system_error>
#include <vector>

#include "kinecal/files/bags/byte_file.ipp"
#include "kinecal/files/bags/codec/compression.hpp"
#include "kinecal/files/bags/codec/unpack.ipp"
#include "kinecal/files/bags/codec/zstd.ipp"
#include "kinecal/files/bags/formats.hpp"
#include "kinecal/files/bags/mcap/read_mcap.hpp"
#include "kinecal/files/bags/rosbag2/metadata.ipp"
#include "kinecal/files/bags/rosbag2/read_db3.hpp"
#include "kinecal/files/natural_order.hpp"
#include "kinecal/files/results/staging.hpp"

namespace kinecal {

namespace detail {

// A whole file compressed by ROS 2 in compression mode FILE: "bag_0.db3.zstd".
//
// Unpacks it into a temporary file, because readers of bags seek back and forth.

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

inline constexpr const char* kZstdEnding = ".zstd";

[[nodiscard]] inline bool is_ros2_bag_file(const std::filesystem::path& path) {
  const auto ending = path.extension();
  return ending == ".mcap" || ending == ".db3";
}

/// @throws BytesError  if it cannot be read
[[nodiscard]] inline std::vector<std::byte> first_bytes(const std::string& path) {
  std::vector<std::byte> first(16);
  std::ifstream in = open_bytes(path);
  in.read(reinterpret_cast<char*>(first.data()), static_cast<std::streamsize>(first.size()));
  first.resize(static_cast<std::size_t>(in.gcount()));
  return first;
}

void read_ros2_bag_file(const std::string& path, const BagReader& reader,
                        Diagnostics& diagnostics) {
  std::vector<std::byte> first;
  std::optional<UnpackedFile> unpacked;
  try {
    first = first_bytes(path);
    if (begins_with(first, kZstdMagic)) {
      unpacked.emplace(path);
      first = first_bytes(unpacked->path());
    }
  } catch (const BytesError& e) {
    return diagnostics.error({path, 0}, e.what());
  }
  const std::string plain = unpacked ? unpacked->path() : path;
  if (is_mcap(first)) return read_mcap(plain, path, reader, diagnostics);
  if (is_sqlite(first)) return read_db3(plain, path, reader, diagnostics);
  diagnostics.error({path, 0}, first.empty() ? "is empty"
                                             : "is neither an MCAP file nor an SQLite database: "
                                               "it begins like neither");
}

/// Path of a listed file: in the folder, or relative to its parent folder, as old versions of ROS 2
/// list it.  Prefers a decompressed file to a compressed one.
/// @return  empty if it does not exist
[[nodiscard]] inline std::string find_ros2_bag_file(const std::filesystem::path& folder,
                                                    const std::string& listed) {
  namespace fs = std::filesystem;
  std::vector<std::string> names{listed};
  if (listed.ends_with(kZstdEnding)) {
    names.insert(names.begin(), listed.substr(0, listed.size() - std::strlen(kZstdEnding)));
  }
  const fs::path above = fs::absolute(folder / "").parent_path().parent_path();
  for (const std::string& name : names) {
    for (const fs::path& path : {folder / name, above / name, folder / fs::path(name).filename()}) {
      std::error_code ignored;
      if (fs::is_regular_file(path, ignored)) return path.string();
    }
  }
  return "";
}

/// The files of a folder without metadata.yaml, in natural order.  A compressed file and its
/// decompressed copy count as one.
[[nodiscard]] inline std::vector<std::string> list_ros2_bag_files(
    const std::filesystem::path& folder) {
  std::set<std::string, decltype(&naturally_before)> files(&naturally_before);
  std::error_code ignored;
  for (const auto& entry : std::filesystem::directory_iterator(folder, ignored)) {
    if (!entry.is_regular_file(ignored)) continue;
    const std::filesystem::path name = entry.path().filename();
    const bool packed = name.extension() == kZstdEnding;
    if (!is_ros2_bag_file(packed ? name.stem() : name)) continue;
    if (packed && std::filesystem::exists(folder / name.stem(), ignored)) continue;
    files.insert(name.string());
  }
  return {files.begin(), files.end()};
}

/// The files of a bag as listed in metadata.yaml or, without it, those in the folder.
/// @throws InputError  if there is a metadata.yaml but it is unusable
[[nodiscard]] inline std::vector<std::string> ros2_bag_files(const std::string& folder,
                                                             Diagnostics& diagnostics) {
  const std::string metadata_path = (std::filesystem::path(folder) / "metadata.yaml").string();
  std::error_code ignored;
  if (std::filesystem::exists(metadata_path, ignored)) {
    const Ros2Metadata metadata = read_ros2_metadata(metadata_path);
    if (!metadata.compression.empty() && metadata.compression != "zstd") {
      throw InputError(metadata_path + ": compression_format '" + metadata.compression +
                       "' is not known; write the bag again with zstd or uncompressed: ros2 "
                       "bag convert");
    }
    if (metadata.files.empty()) throw InputError(metadata_path + ": lists no files");
    return metadata.files;
  }
  std::vector<std::string> files = list_ros2_bag_files(folder);
  if (files.empty()) {
    throw InputError(folder + ": is not a ROS 2 bag: there is no metadata.yaml, no .mcap, no .db3");
  }
  diagnostics.warning({folder, 0},
                      "there is no metadata.yaml, as when a recording is interrupted; all bag "
                      "files of the folder are read, in the order of their names");
  return files;
}

}  // namespace detail

void read_ros2_bag(const std::string& folder, const BagReader& reader, Diagnostics& diagnostics) {
  std::vector<std::string> paths;
  try {
    for (const std::string& listed : detail::ros2_bag_files(folder, diagnostics)) {
      paths.push_back(detail::find_ros2_bag_file(folder, listed));
      if (!paths.back().empty()) continue;
      diagnostics.error({folder, 0}, "file '" + listed +
                                         "' is missing, but metadata.yaml lists it; copy all "
                                         "files of the bag");
    }
  } catch (const InputError& e) {
    diagnostics.errors.push_back(e.what());
    return;
  }
  if (std::count(paths.begin(), paths.end(), "") > 0) return;
  for (const std::string& path : paths) detail::read_ros2_bag_file(path, reader, diagnostics);
}

}  // namespace kinecal
