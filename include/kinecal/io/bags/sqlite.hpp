// SQLite databases that nobody trusts, for reading; only with KINECAL_HAVE_SQLITE.
//
// The file is opened read-only and as one that nobody changes, so that nothing is locked or created
// beside it; except where a write-ahead log lies beside it, as of a recording that was interrupted:
// the newest messages are in it.
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

#include "kinecal/io/bags/bytes.hpp"
#include "kinecal/io/bags/compression.hpp"

namespace kinecal::detail {

class SqliteDatabase {
 public:
  /// @throws BytesError  if it cannot be opened; whether it is a database shows later
  [[nodiscard]] static SqliteDatabase open(const std::string& path) {
    const std::uint64_t log = size_of(path + "-wal");
    return SqliteDatabase("file:" + escaped(path) + "?mode=ro" + (log > 0 ? "" : "&immutable=1"),
                          size_of(path) + log);
  }

  /// @param uri   as SQLite's, "file:..."
  /// @param size  bytes of it: what is read, and how long it takes, is bounded by them
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
    // What is not in the file is computed: only somebody who means harm does that.
    constexpr std::uint64_t kLeast = 1 << 20;
    sqlite3_limit(made, SQLITE_LIMIT_LENGTH,
                  static_cast<int>(std::min(kMostOfABlock, size + kLeast)));
    // A tree that branches into itself has rows without end.
    constexpr int kSteps = 10'000;
    steps_ = std::make_unique<std::uint64_t>((10 * kLeast + 64 * size) / kSteps);
    sqlite3_progress_handler(
        made, kSteps,
        [](void* left) { return (*static_cast<std::uint64_t*>(left))-- == 0 ? 1 : 0; },
        steps_.get());
  }

  [[nodiscard]] std::uint64_t size() const { return size_; }
  [[nodiscard]] sqlite3* handle() const { return handle_.get(); }

  /// @throws BytesError  with what SQLite says
  [[noreturn]] void fail(int code) const {
    const char* text = handle_ ? sqlite3_errmsg(handle_.get()) : sqlite3_errstr(code);
    switch (code & 0xFF) {
      case SQLITE_NOTADB:
        throw BytesError("is no SQLite database, or it is damaged at its beginning");
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

  /// Bytes of a file; 0 if it is not there.
  [[nodiscard]] static std::uint64_t size_of(const std::string& path) {
    std::error_code missing;
    const std::uintmax_t size = std::filesystem::file_size(path, missing);
    return missing ? 0 : size;
  }

  /// A path as part of an URI.
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
  std::unique_ptr<std::uint64_t> steps_;  ///< that are left, in SQLite's own measure
  std::unique_ptr<sqlite3, Close> handle_;
};

/// A question to a database, and its rows.
class SqliteRows {
 public:
  /// @throws BytesError  if it cannot be asked, for instance since there is no such column
  SqliteRows(const SqliteDatabase& database, const std::string& question) : database_(database) {
    sqlite3_stmt* made = nullptr;
    const int code = sqlite3_prepare_v2(database.handle(), question.c_str(), -1, &made, nullptr);
    handle_.reset(made);
    if (code != SQLITE_OK) database_.fail(code);
  }

  /// Asks again, with another value for its '?'.
  void bind(std::int64_t value) {
    sqlite3_reset(handle_.get());
    sqlite3_bind_int64(handle_.get(), 1, value);
  }

  /// Moves to the next row, at first to the first.
  /// @return  whether there is one
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
    const Bytes of_text = bytes(column);
    return {reinterpret_cast<const char*>(of_text.data()), of_text.size()};
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
