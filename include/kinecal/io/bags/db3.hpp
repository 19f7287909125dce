// Reads .db3 files, the SQLite databases into which ROS 2 recorded by default before MCAP.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <system_error>
#include <vector>

#include "kinecal/io/bags/bag.hpp"
#include "kinecal/io/bags/byte_file.hpp"
#include "kinecal/io/bags/db3_messages.hpp"
#include "kinecal/io/bags/ros2_formats.hpp"
#include "kinecal/io/diagnostics.hpp"

namespace kinecal {

namespace detail {

/// @throws BytesError  if the file cannot be opened or begins like no database
inline void check_is_sqlite(const std::string& path) {
  std::ifstream in = open_bytes(path);
  ByteFile file(in);
  std::vector<std::byte> buffer;
  if (file.size() == 0) throw BytesError("is empty");
  const Bytes first = file.read(std::min<std::uint64_t>(file.size(), kSqliteMagic.size()), buffer);
  if (!is_sqlite(first)) throw BytesError("is no SQLite database: it does not begin as one");
}

/// SQLite keeps beside a database what it has not put into it yet.
inline void warn_of_journals(const std::string& path, Diagnostics& diagnostics) {
  std::error_code missing;
  if (std::filesystem::file_size(path + "-wal", missing) > 0 && !missing) {
    diagnostics.warning({path, 0},
                        "the recording was interrupted: its last messages are in the file \"-wal\" "
                        "beside it and are read too; do not take one without the other");
  }
  if (std::filesystem::file_size(path + "-journal", missing) > 0 && !missing) {
    diagnostics.warning({path, 0},
                        "the recording was interrupted while it was written, as the file "
                        "\"-journal\" beside it tells; if it cannot be read, open it once in "
                        "sqlite3, which repairs it");
  }
}

#ifdef KINECAL_HAVE_SQLITE

/// @param open  makes the database
template <class Open>
void read_db3_database(const Open& open, const std::string& name, const BagReader& reader,
                       Diagnostics& diagnostics) {
  std::optional<SqliteDatabase> database;
  std::optional<Db3Messages> messages;
  const auto advance = [&]() -> std::optional<BagMessage> {
    try {
      if (!messages) {
        database.emplace(open());
        messages.emplace(*database, reader, Place{name, 0}, diagnostics);
      }
      return messages->next();
    } catch (const BytesError& e) {
      diagnostics.error({name, 0}, e.what());
      return std::nullopt;
    }
  };
  // What the reader throws is no mistake of the file.
  while (const std::optional<BagMessage> message = advance()) reader.handle(*message);
}

#endif

}  // namespace detail

/// All wanted messages of a file, in the order of time.
/// @param path         of a .db3 file
/// @param name         as messages name the file
/// @param diagnostics  receives what is wrong with it, at most one error, after which nothing is
///                     read; also that this kinecal was built without SQLite.  Only what the
///                     handler throws is thrown.
inline void read_db3(const std::string& path, const std::string& name,
                     [[maybe_unused]] const BagReader& reader, Diagnostics& diagnostics) {
  try {
    detail::check_is_sqlite(path);
  } catch (const BytesError& e) {
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

inline void read_db3(const std::string& path, const BagReader& reader, Diagnostics& diagnostics) {
  read_db3(path, path, reader, diagnostics);
}

}  // namespace kinecal
