// Checks that a file is a database, and reads it if SQLite is available.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/files/bags/rosbag2/read_db3.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <system_error>
#include <vector>

#include "kinecal/files/bags/byte_file.ipp"
#include "kinecal/files/bags/formats.hpp"
#include "kinecal/files/bags/rosbag2/db3_messages.ipp"

namespace kinecal {

namespace detail {

/// @throws BytesError  if the file cannot be opened or is not a database
inline void check_is_sqlite(const std::string& path) {
  std::ifstream in = open_bytes(path);
  ByteFile file(in);
  std::vector<std::byte> buffer;
  if (file.size() == 0) throw BytesError("is empty");
  const Bytes first = file.read(std::min<std::uint64_t>(file.size(), kSqliteMagic.size()), buffer);
  if (!is_sqlite(first)) throw BytesError("is not an SQLite database: it does not begin as one");
}

/// SQLite keeps unfinished changes in files beside the database.
inline void warn_of_journals(const std::string& path, Diagnostics& diagnostics) {
  std::error_code missing;
  if (std::filesystem::file_size(path + "-wal", missing) > 0 && !missing) {
    diagnostics.warning({path, 0},
                        "the recording was interrupted: its last messages are in the file \"-wal\" "
                        "beside it and are read, too; keep both files together");
  }
  if (std::filesystem::file_size(path + "-journal", missing) > 0 && !missing) {
    diagnostics.warning({path, 0},
                        "the recording was interrupted while it was written: there is a file "
                        "\"-journal\" beside it; if the bag cannot be read, open it once in "
                        "sqlite3, which repairs it");
  }
}

}  // namespace detail

void read_db3(const std::string& path, const std::string& name,
              [[maybe_unused]] const BagReader& reader, Diagnostics& diagnostics) {
  try {
    detail::check_is_sqlite(path);
  } catch (const detail::BytesError& e) {
    diagnostics.error({name, 0}, e.what());
    return;
  }
#ifdef KINECAL_HAVE_SQLITE
  detail::warn_of_journals(path, diagnostics);
  detail::read_db3_database([&] { return detail::SqliteDatabase::open(path); }, name, reader,
                            diagnostics);
#else
  diagnostics.error({name, 0},
                    "is an SQLite database, and this kinecal was built without libsqlite3; install "
                    "libsqlite3-dev and build again");
#endif
}

void read_db3(const std::string& path, const BagReader& reader, Diagnostics& diagnostics) {
  read_db3(path, path, reader, diagnostics);
}

}  // namespace kinecal
