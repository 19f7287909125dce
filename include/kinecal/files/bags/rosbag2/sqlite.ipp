// Reads untrusted SQLite databases; only with KINECAL_HAVE_SQLITE.
//
// Opens the file read-only and immutable, so that nothing is locked or created beside it.
// Exception: a write-ahead log beside it, as after an interrupted recording, holds the newest
// messages; then it is not immutable.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#ifdef KINECAL_HAVE_SQLITE

#include <sqlite3.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <system_error>

#include "kinecal/files/bags/bytes.hpp"
#include "kinecal/files/bags/codec/unpack.ipp"

namespace kinecal::detail {

class SqliteDatabase {
 public:
  /// @throws BytesError  if it cannot be opened; does not yet check that it is a database
  [[nodiscard]] static SqliteDatabase open(const std::string& path) {
    const std::uint64_t log = size_of(path + "-wal");
    return SqliteDatabase("file:" + escaped(path) + "?mode=ro" + (log > 0 ? "" : "&immutable=1"),
                          size_of(path) + log);
  }

  /// @param uri   "file:...", as SQLite defines it
  /// @param size  of it, bytes: limits what is read, and how long that takes
  SqliteDatabase(const std::string& uri, std::uint64_t size) : size_(size) {
    sqlite3* made = nullptr;
    const int flags = SQLITE_OPEN_READONLY | SQLITE_OPEN_URI | SQLITE_OPEN_NOMUTEX;
    const int code = sqlite3_open_v2(uri.c_str(), &made, flags, nullptr);
    handle_.reset(made);
    if (code != SQLITE_OK) fail(code);
    sqlite3_db_config(made, SQLITE_DBCONFIG_DEFENSIVE, 1, nullptr);
    sqlite3_db_config(made, SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0, nullptr);
    sqlite3_db_config(made, SQLITE_DBCONFIG_ENABLE_VIEW, 0, nullptr);
    sqlite3_db_config(made, SQLITE_DBCONFIG_ENABLE_TRIGGER, 0, nullptr);
    // Only a malicious file has a computed value larger than the file.
    constexpr std::uint64_t kLeast = 1 << 20;
    sqlite3_limit(made, SQLITE_LIMIT_LENGTH,
                  static_cast<int>(std::min(kMostOfABlock, size + kLeast)));
    // A damaged tree with a cycle has endless rows.
    constexpr int kSteps = 10'000;
    steps_ = std::make_unique<std::uint64_t>((10 * kLeast + 64 * size) / kSteps);
    sqlite3_progress_handler(
        made, kSteps,
        [](void* left) { return (*static_cast<std::uint64_t*>(left))-- == 0 ? 1 : 0; },
        steps_.get());
  }

  [[nodiscard]] std::uint64_t size() const { return size_; }
  [[nodiscard]] sqlite3* handle() const { return handle_.get(); }

  /// @throws BytesError  with SQLite's message
  [[noreturn]] void fail(int code) const {
    const char* text = handle_ ? sqlite3_errmsg(handle_.get()) : sqlite3_errstr(code);
    switch (code & 0xFF) {
      case SQLITE_NOTADB:
        throw BytesError("is not an SQLite database, or is damaged at its beginning");
      case SQLITE_CORRUPT:
        throw BytesError("the database is damaged or cut off: " + std::string(text) +
                         "; \"sqlite3 <file> .recover\" may save what is left");
      case SQLITE_INTERRUPT:
        throw BytesError("the database is damaged: it has more rows than its size allows");
      default:
        throw BytesError("SQLite cannot read it: " + std::string(text));
    }
  }

 private:
  struct Close {
    void operator()(sqlite3* handle) const { sqlite3_close_v2(handle); }
  };

  /// Bytes of a file; 0 if it does not exist.
  [[nodiscard]] static std::uint64_t size_of(const std::string& path) {
    std::error_code missing;
    const std::uintmax_t size = std::filesystem::file_size(path, missing);
    return missing ? 0 : size;
  }

  /// A path as part of a URI.
  [[nodiscard]] static std::string escaped(const std::string& path) {
    std::string text;
    for (const char c : path) {
      if (c == '%') {
        text += "%25";
      } else if (c == '?') {
        text += "%3f";
      } else if (c == '#') {
        text += "%23";
      } else {
        text += c;
      }
    }
    return text;
  }

  std::uint64_t size_;
  std::unique_ptr<std::uint64_t> steps_;  ///< left, in units of kSteps instructions
  std::unique_ptr<sqlite3, Close> handle_;
};

/// A query to a database, and its rows.
class SqliteRows {
 public:
  /// @throws BytesError  if the query fails, for instance because there is no such column
  SqliteRows(const SqliteDatabase& database, const std::string& query) : database_(database) {
    sqlite3_stmt* made = nullptr;
    const int code = sqlite3_prepare_v2(database.handle(), query.c_str(), -1, &made, nullptr);
    handle_.reset(made);
    if (code != SQLITE_OK) database_.fail(code);
  }

  /// Runs the query again with another value for its '?'.
  void bind(std::int64_t value) {
    sqlite3_reset(handle_.get());
    sqlite3_bind_int64(handle_.get(), 1, value);
  }

  /// Goes to the next row, at first to the first one.
  /// @return  false if absent
  [[nodiscard]] bool next() {
    const int code = sqlite3_step(handle_.get());
    if (code == SQLITE_ROW) return true;
    if (code == SQLITE_DONE) return false;
    database_.fail(code);
  }

  [[nodiscard]] std::int64_t number(int column) const {
    return sqlite3_column_int64(handle_.get(), column);
  }

  /// Valid until the next row.
  [[nodiscard]] Bytes bytes(int column) const {
    const void* data = sqlite3_column_blob(handle_.get(), column);
    const int size = sqlite3_column_bytes(handle_.get(), column);
    if (!data) return {};
    return {static_cast<const std::byte*>(data), static_cast<std::size_t>(size)};
  }

  [[nodiscard]] std::string text(int column) const {
    const Bytes raw = bytes(column);
    return {reinterpret_cast<const char*>(raw.data()), raw.size()};
  }

 private:
  struct Finalize {
    void operator()(sqlite3_stmt* handle) const { sqlite3_finalize(handle); }
  };

  const SqliteDatabase& database_;
  std::unique_ptr<sqlite3_stmt, Finalize> handle_;
};

}  // namespace kinecal::detail

#endif
